#include "tests/validation/convergence_page.h"

#include <fmt/format.h>

#include <cmath>

namespace grouser::validation {
namespace {

/// A picture that follows the reader's light or dark page.
std::string picture(const std::string& name, const std::string& alternative) {
  return fmt::format(
      "\n<picture>\n  <source media=\"(prefers-color-scheme: dark)\" srcset=\"pictures/{0}_dark.png\">\n"
      "  <img src=\"pictures/{0}.png\" alt=\"{1}\">\n</picture>\n\n",
      name, alternative);
}

std::string steps_table(const Ladder& ladder) {
  std::string text =
      "| setting | steps of a run | mean step in cruise µs | bounded by error % | by stability % | energy residual | "
      "agrees |\n| --- | ---: | ---: | ---: | ---: | ---: | --- |\n";
  for (const Rung* rung : ladder.rungs()) {
    const auto share = [&](double Measures::*field) {
      return rung->adaptive ? fmt::format("{:.0f}", 100.0 * rung->average(field)) : std::string("-");
    };
    const std::vector<std::string> faults = ladder.faults(*rung);
    std::string agrees = rung == &ladder.reference() ? "is the reference" : faults.empty() ? "yes" : "no: ";
    for (std::size_t i = 0; i < faults.size(); ++i) agrees += (i > 0 ? "; " : "") + faults[i];
    text += fmt::format("| {}{} | {:.0f} | {:.1f} | {} | {} | {:.1e} | {} |\n", rung->name,
                        rung->name == ladder.chosen ? " (**shipped**)" : "", rung->accepted(), 1e6 * rung->mean_step(),
                        share(&Measures::error_share), share(&Measures::stability_share),
                        rung->average(&Measures::residual_fraction), agrees);
  }
  return text;
}

std::string quantities_table(const Ladder& ladder) {
  std::string head = "| quantity | reference | scatter % | may be off % |", rule = "| --- | ---: | ---: | ---: |";
  std::vector<const Rung*> rungs = ladder.rungs();
  rungs.pop_back();  // the reference
  for (const Rung* rung : rungs) head += fmt::format(" {} |", rung->name), rule += " ---: |";
  std::string text = head + "\n" + rule + "\n";
  for (int q = 0; q < static_cast<int>(quantities().size()); ++q) {
    const Quantity& quantity = quantities()[static_cast<std::size_t>(q)];
    text += fmt::format("| {} | {:.{}f} {} | {:.2f} | {:.1f} |", quantity.name,
                        quantity.scale * ladder.reference().mean(q), quantity.digits, quantity.unit,
                        100.0 * ladder.scatter(q), 100.0 * ladder.allowance(ladder.tolerance(ladder.chosen), q));
    for (const Rung* rung : rungs) text += fmt::format(" {:+.2f} |", 100.0 * ladder.deviation(*rung, q));
    text += "\n";
  }
  return text;
}

/// Exponent of the error between the coarsest and the finest step.
double order_of(const TrajectoryErrors& errors, std::size_t window) {
  const std::vector<double>& e = errors.error[window];
  return std::log(e.front() / e.back()) / std::log(errors.steps.front() / errors.steps.back());
}

std::string trajectory_table(const TrajectoryErrors& errors) {
  std::string text = "| window |", rule = "| --- |";
  for (const double h : errors.steps) text += fmt::format(" {:g} µs |", 1e6 * h), rule += " ---: |";
  text += " order |\n" + rule + " ---: |\n";
  for (std::size_t w = 0; w < errors.windows.size(); ++w) {
    text += fmt::format("| {:g} ms |", 1e3 * errors.windows[w]);
    for (const double e : errors.error[w]) text += fmt::format(" {:.2g} µm |", 1e6 * e);
    text += fmt::format(" {:.2f} |\n", order_of(errors, w));
  }
  return text;
}

/// Mean step of a rung between two times, in microseconds.
double mean_step_between(const Rung& rung, double from, double to) {
  double sum = 0.0;
  int count = 0;
  for (const TenthOfSteps& tenth : rung.runs.front().steps) {
    if (tenth.time >= from && tenth.time <= to) sum += tenth.mean, ++count;
  }
  return 1e6 * sum / count;
}

std::string fall_of_steps(const Ladder& ladder, const std::string& name) {
  const Rung& rung = ladder.tolerance(name);
  const double standing = mean_step_between(rung, 0.0, 0.2),
               cruise = mean_step_between(rung, ladder.phases.cruise_from, ladder.phases.cruise_to);
  return fmt::format("{:.0f} µs at rest and {:.0f} µs in cruise at a tolerance of {}", standing, cruise, name);
}

}  // namespace

std::string convergence_page(const Ladder& ladder, const TrajectoryErrors& errors, const std::string& fine) {
  const Phases& phases = ladder.phases;
  std::string text = fmt::format(
      R"(# Convergence of run A

How the results of the reference vehicle's straight drive depend on the integrator's tolerance, and why the shipped tolerance is {chosen}. Tables
and pictures come from one program, with the numbers about them; make them again, after `./test.sh` (`./demo.sh` configures the same folder without tests), with
`cmake --build build/release --target grouser_convergence && build/release/grouser_convergence -o docs` (some minutes).

- The drive is run A with its cruise held for {cruise:g} s instead of 3, so that lines stand on {window:g} s: rest to 50 km/h in {up:g} s, cruise, rest in {down:g} s.
- The motion is chaotic: two runs that differ by 1 nm/s at the start part within a second and agree in statistics only. So statistics are
  compared, each setting is run twice, the costly ones once, and the scatter of such pairs, pooled over all settings, says what a difference may be worth.
- Tensions are read where the left track crosses a plane fixed to the hull, in the middle of the span; a peak is the largest value that a link
  sees, as the mean over the 76 links. The line at link passing is at 71.6 Hz.
- The reference is the finest fixed step, {reference}.
- A setting agrees when means are within 0.5 %, amplitudes of fluctuations within 5 % and peaks within 2 % of the reference, each widened by two
  standard errors of the two means compared, and when the energy residual stays under {residual:.0e} of the integral of |sprocket power|, the cruise
  counted for its 3 s only.

)",
      fmt::arg("chosen", ladder.chosen), fmt::arg("cruise", phases.cruise_to - phases.cruise_from),
      fmt::arg("window", phases.cruise_to - phases.cruise_from - 1.0), fmt::arg("up", phases.cruise_from),
      fmt::arg("down", phases.end - phases.cruise_to), fmt::arg("reference", ladder.reference().name),
      fmt::arg("residual", k_residual_limit));
  text +=
      "## What fluctuates\n" +
      picture("convergence_fluctuation", "Amplitudes at link passing over the mean step, tolerances and fixed steps") +
      "## Means and peaks\n" + picture("convergence_tension", "Mean tension, distance and peaks over the mean step") +
      "## Choice of the tolerance\n\n" + steps_table(ladder) +
      "\nThe displacement tolerance is the velocity tolerance times 1 ms on every line. `bound` is "
      "`integrator.stability_fraction`, where it is not the shipped one: it multiplies the largest step that is stable "
      "for certain.\n" +
      picture("convergence_energy", "Energy residual over the mean step; it falls as the square of a fixed step") +
      "Deviation from the reference in per cent, by quantity:\n\n" + quantities_table(ladder);
  text +=
      "\n## Step size over the drive\n\nThe paper shows the step falling as the vehicle goes from rest to speed (its "
      "Fig. 4). That is so where the error "
      "bounds the step: " +
      fall_of_steps(ladder, fine) +
      ". Where the stability bound does, the step is nearly that of the stiffest link at any speed: " +
      fall_of_steps(ladder, ladder.chosen) + ".\n" +
      picture("convergence_step_size", "Mean step over time at two tolerances, above the speed of the track");
  text += fmt::format(
      "## Trajectories\n\nOver a piece of motion too short for chaos, trajectories themselves can be compared. From "
      "the state at {:g} s (50 km/h), fixed steps "
      "are held against the classical Runge-Kutta method at {:g} µs, which shares with the program nothing but the "
      "equations of motion (twice its step "
      "changes it by {:.0e} µm at most). Largest error of any link's position:\n\n",
      errors.from, 1e6 * errors.reference_step, 1e6 * errors.reference_error.back());
  text +=
      trajectory_table(errors) +
      picture("convergence_trajectory", "Position error over the step on logarithmic axes, parallel to the square law");
  text += R"(## What once did not converge

Until friction of the ground was mended, run A's distance grew by 0.1 m for every halving of the step, and the front span's line fell by a fifth from 80
to 20 µs. The bristle under each pad held spring and damper together to the friction limit and then let the spring alone carry it; while the normal
force rises, the damper made such a bristle slide where it sticks, the more often the shorter the step. A law must have a limit for h -> 0 before a
tolerance can be chosen. The test `Ground.ALandingThatSticksAndSlipsErrsByTheSquareOfTheStep` holds that now.
)";
  return text;
}

}  // namespace grouser::validation
