#pragma once
#include <array>
#include <optional>
#include <vector>

#include "model/run.h"
#include "simulator/assembly.h"
#include "simulator/energy_book.h"
#include "simulator/rubber_watch.h"
#include "simulator/track_watch.h"

namespace grouser {

/// A stretch of time [s].
struct Interval {
  double from = 0.0, to = 0.0;
  [[nodiscard]] bool holds(double time) const { return time >= from && time <= to; }
};

/// What a run's results are made of. It does not grow with the run, however long that is.
struct RunMeasures {
  /// Mean of the samples that were added.
  struct Mean {
    double sum = 0.0;
    long count = 0;
    void add(double value) { sum += value, ++count; }
    [[nodiscard]] double value() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }
  };
  /// Of a sample: chassis origin and heading in W, forward speed.
  struct Place {
    double x = 0.0, y = 0.0, yaw = 0.0, speed = 0.0;  ///< m, m, rad (turns counted), m/s
  };
  long samples = 0;
  Place first, last;
  double rest_ground_force = 0.0;                 ///< N, vertical, all links, of the first sample
  double largest_aside = 0.0, largest_way = 0.0;  ///< m, of any sample from the first: along y, in x and y
  Mean straight_speed, turn_rate;                 ///< m/s, rad/s, over straight_window and turn_window
  std::vector<double> tone_time, left_torque;     ///< s, N m of the left sprocket, at the probe rate in tone_window
  struct StepSum {
    double time = 0.0;
    long count = 0;
    long by_error = 0, by_stability = 0;  ///< what bounded them
    void add(double h, StepLimit limit) {
      time += h, ++count;
      by_error += limit == StepLimit::error ? 1 : 0;
      by_stability += limit == StepLimit::stability ? 1 : 0;
    }
    [[nodiscard]] double mean() const { return count > 0 ? time / static_cast<double>(count) : 0.0; }
  };
  StepSum rest_steps, steady_steps;  ///< sprockets nearly still; holding their speed
  RubberLoads rubber;
  double largest_guide_offset = 0.0;  ///< m
  std::array<double, k_num_sides> skipped_teeth{};
  std::array<SlackSpan, k_num_sides> slack;
  std::array<double, k_num_contact_cases> case_total{};  ///< summed over samples
};

/// Named scalars and checks of a run; which ones depends on what was driven (cruise, turn, stop, rest).
void add_results(const System& system, const Assembled& assembled, const RunMeasures& measures, const EnergyBook& book,
                 RunSummary& summary);

/// Longest stretch of a scenario, of half a second at least, with both sprockets at a constant speed other than zero.
[[nodiscard]] std::optional<Interval> steady_drive(const Scenario& scenario);
/// The part of a steady drive over which a straight one, a turn is judged: without what a corner of the drive leaves.
[[nodiscard]] Interval straight_window(const Interval& steady);
[[nodiscard]] Interval turn_window(const Interval& steady);
/// The part of it in which link passing is looked for: the last ten seconds tell it as well as an hour.
[[nodiscard]] Interval tone_window(const Interval& steady);

/// Amplitude of a line at `frequency` [Hz] in samples from..to of a series (Hann window), and of its background (median
/// over
/// +-20 Hz).
struct SpectralLine {
  double amplitude = 0.0, background = 0.0;
};
[[nodiscard]] SpectralLine spectral_line(const std::vector<double>& time, const std::vector<double>& value, double from,
                                         double to, double frequency);

}  // namespace grouser
