#include "tests/validation/convergence_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace grouser::validation {
namespace {

void run(const System& base, const Assembled& rest, const Phases& phases, Rung& rung, void (*say)(const std::string&)) {
  System system = base;
  system.scenario.integrator = rung.options;
  for (int n = 0; n < rung.num_runs; ++n) {
    State start = rest.state;
    start.chassis.velocity.x() += 1e-9 * n;  // m/s
    rung.runs.push_back(measure(system, start, rest.knobs, phases));
    say(fmt::format("{}, run {}: {} steps, energy residual {:.1e}", rung.name, n + 1, rung.runs.back().accepted,
                    rung.runs.back().residual_fraction));
  }
}

}  // namespace

double Rung::mean(int quantity) const {
  double sum = 0.0;
  for (const Measures& m : runs) sum += m.value[static_cast<std::size_t>(quantity)];
  return sum / static_cast<double>(runs.size());
}

double Rung::average(double Measures::*field) const {
  double sum = 0.0;
  for (const Measures& m : runs) sum += m.*field;
  return sum / static_cast<double>(runs.size());
}

double Rung::mean_step() const { return average(&Measures::mean_step); }

double Rung::accepted() const {
  double sum = 0.0;
  for (const Measures& m : runs) sum += static_cast<double>(m.accepted);
  return sum / static_cast<double>(runs.size());
}

std::vector<const Rung*> Ladder::rungs() const {
  std::vector<const Rung*> all;
  for (const auto* some : {&tolerances, &bounds, &fixed_steps}) {
    for (const Rung& rung : *some) all.push_back(&rung);
  }
  return all;
}

const Rung& Ladder::tolerance(const std::string& name) const {
  for (const Rung& rung : tolerances) {
    if (rung.name == name) return rung;
  }
  throw std::runtime_error("the tolerance of the shipped run A, " + name + ", is no rung of the ladder");
}

double Ladder::scatter(int quantity) const {
  double squares = 0.0;
  int freedom = 0;
  for (const Rung* rung : rungs()) {
    const double mean = rung->mean(quantity);
    for (const Measures& m : rung->runs) {
      const double off = m.value[static_cast<std::size_t>(quantity)] / mean - 1.0;
      squares += off * off;
    }
    freedom += static_cast<int>(rung->runs.size()) - 1;
  }
  return std::sqrt(squares / std::max(1, freedom));
}

double Ladder::deviation(const Rung& rung, int quantity) const {
  return rung.mean(quantity) / reference().mean(quantity) - 1.0;
}

double Ladder::allowance(const Rung& rung, int quantity) const {
  const double runs = static_cast<double>(rung.runs.size()),
               reference_runs = static_cast<double>(reference().runs.size());
  const double standard_error = scatter(quantity) * std::sqrt(1.0 / runs + 1.0 / reference_runs);
  return limit_of(quantities()[static_cast<std::size_t>(quantity)].kind) + 2.0 * standard_error;
}

std::vector<std::string> Ladder::faults(const Rung& rung) const {
  std::vector<std::string> found;
  for (int q = 0; q < static_cast<int>(quantities().size()); ++q) {
    if (std::abs(deviation(rung, q)) > allowance(rung, q))
      found.push_back(
          fmt::format("{} ({:+.1f} %)", quantities()[static_cast<std::size_t>(q)].name, 100.0 * deviation(rung, q)));
  }
  const double residual = rung.average(&Measures::residual_fraction);
  if (residual > k_residual_limit) found.push_back(fmt::format("energy residual ({:.1e})", residual));
  return found;
}

double limit_of(Kind kind) { return kind == Kind::mean ? 0.005 : kind == Kind::fluctuation ? 0.05 : 0.02; }

void climb(const System& system, const Assembled& rest, Ladder& ladder, void (*say)(const std::string&)) {
  for (auto* rungs : {&ladder.tolerances, &ladder.bounds, &ladder.fixed_steps}) {
    for (Rung& rung : *rungs) run(system, rest, ladder.phases, rung, say);
  }
}

}  // namespace grouser::validation
