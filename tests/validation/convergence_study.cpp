// grouser_convergence [-o DOCS] [--smoke]: runs run A at a ladder of tolerances and of fixed steps, and writes
// DOCS/convergence.md with its pictures. Exits 1 where the shipped tolerance does not agree with the reference.
// --smoke: a drive of two seconds at three settings, to see that the program works.
#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>

#include "render/figure.h"
#include "tests/validation/convergence_figures.h"
#include "tests/validation/convergence_page.h"

namespace {

using namespace grouser;
using namespace grouser::validation;

struct Options {
  std::filesystem::path output;
  bool smoke = false;
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "-o") == 0 && i + 1 < argc) {
      options.output = argv[++i];
    } else if (std::strcmp(argv[i], "--smoke") == 0) {
      options.smoke = true;
    } else {
      throw std::runtime_error(fmt::format("unknown argument `{}`", argv[i]));
    }
  }
  return options;
}

std::string tolerance_name(double tolerance) { return fmt::format("{:g} mm/s", 1e3 * tolerance); }

Rung tolerance_rung(const IntegratorOptions& shipped, double tolerance) {
  IntegratorOptions options = shipped;
  options.velocity_tolerance = tolerance;
  options.displacement_tolerance = 1e-3 * tolerance;  // m per m/s
  return {tolerance_name(tolerance), tolerance, true, options};
}

Rung bound_rung(const IntegratorOptions& shipped, double fraction) {
  Rung rung = tolerance_rung(shipped, shipped.velocity_tolerance);
  rung.options.stability_fraction = fraction;
  rung.name += fmt::format(", bound {:g}", fraction);
  return rung;
}

Rung fixed_rung(const IntegratorOptions& shipped, double step) {
  IntegratorOptions options = shipped;
  options.fixed_step = step;
  return {fmt::format("{:g} µs", 1e6 * step), step, false, options};
}

/// What one call computes: the whole study, or a little of everything.
struct Study {
  Scenario scenario;
  Ladder ladder;
  std::string fine;  ///< tolerance at which the error bounds the step
  double trajectory_from = 11.0;
  std::vector<double> windows{0.005, 0.02, 0.05}, steps{1.6e-4, 8e-5, 4e-5, 2e-5, 1e-5, 5e-6};
};

Study make_study(bool smoke) {
  Study study;
  study.scenario = read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json");
  const IntegratorOptions& shipped = study.scenario.integrator;
  study.ladder.phases = smoke ? Phases{0.3, 1.6, 2.2} : Phases{10.0, 18.0, 22.0, 5.0};
  const double top = smoke ? 4.5 : 45.0;  // rad/s
  const Phases& phases = study.ladder.phases;
  for (DriveTable& table : study.scenario.drive)
    table = DriveTable{{0.0, phases.cruise_from, phases.cruise_to, phases.end}, {0.0, top, top, 0.0}};
  study.scenario.duration = phases.end;
  study.ladder.chosen = tolerance_name(shipped.velocity_tolerance);
  const auto coarse_to_fine =
      smoke ? std::vector{shipped.velocity_tolerance, 0.003} : std::vector{0.1, 0.03, 0.01, 0.005, 0.002, 0.001};
  for (const double tolerance : coarse_to_fine) study.ladder.tolerances.push_back(tolerance_rung(shipped, tolerance));
  for (const double fraction : smoke ? std::vector{1.1} : std::vector{1.1})
    study.ladder.bounds.push_back(bound_rung(shipped, fraction));
  for (const double step : smoke ? std::vector{1e-4, 8e-5} : std::vector{1.6e-4, 1.2e-4, 8e-5, 4e-5, 2e-5})
    study.ladder.fixed_steps.push_back(fixed_rung(shipped, step));
  for (auto* rungs : {&study.ladder.tolerances, &study.ladder.fixed_steps}) {
    for (Rung& rung : *rungs) {
      if (rung.setting < (rung.adaptive ? 8e-3 : 6e-5))
        rung.num_runs = 1;  // costly; the scatter is known from the rest
    }
  }
  study.fine = study.ladder.tolerances.back().name;
  if (smoke) {
    study.trajectory_from = 1.0;
    study.windows = {0.005};
    study.steps = {8e-5, 4e-5};
  }
  return study;
}

void say(const std::string& line) { fmt::print(stderr, "{}\n", line); }

constexpr double k_pixels = 1.5;  // device pixels a CSS pixel

void draw_both(const Figure& figure, const std::filesystem::path& folder) {
  write_png(draw(figure, Theme::light, k_pixels), folder / (figure.name + ".png"));
  write_png(draw(figure, Theme::dark, k_pixels), folder / (figure.name + "_dark.png"));
}

void write(const Study& study, const System& system, const TrajectoryErrors& errors,
           const std::filesystem::path& docs) {
  const std::filesystem::path pictures = docs / "pictures";
  std::filesystem::create_directories(pictures);
  for (const Figure& figure :
       {figure_fluctuation(study.ladder), figure_means_and_peaks(study.ladder), figure_residual(study.ladder),
        figure_step_size(study.ladder, system, study.fine), figure_trajectory(errors)}) {
    draw_both(figure, pictures);
  }
  std::ofstream(docs / "convergence.md") << convergence_page(study.ladder, errors, study.fine);
}

int run(const Options& options) {
  Study study = make_study(options.smoke);
  const System system = compile(study.scenario);
  const Assembled rest = assemble(system);
  climb(system, rest, study.ladder, say);
  const TrajectoryErrors errors =
      trajectory_errors(system, rest, study.trajectory_from, study.windows, study.steps, 2.5e-6);
  if (!options.output.empty()) write(study, system, errors, options.output);
  if (options.smoke) return 0;  // statistics of a second of cruise are none
  const std::vector<std::string> faults = study.ladder.faults(study.ladder.tolerance(study.ladder.chosen));
  for (const std::string& fault : faults) say("the shipped tolerance does not agree in: " + fault);
  return faults.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(read_options(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
