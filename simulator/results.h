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

/// Series kept in memory while a run goes, for its results: one entry a sample.
struct RunSeries {
  std::vector<double> time, x, y, yaw, speed, yaw_rate;  ///< chassis origin, W
  std::vector<double> ground_force;                      ///< N, vertical, all links
  std::vector<double> probe_time;                        ///< s, at the probe rate
  std::vector<double> probe_torque;                      ///< N m, left sprocket
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
void add_results(const System& system, const Assembled& assembled, const RunSeries& series, const EnergyBook& book,
                 RunSummary& summary);

/// Longest stretch of a scenario, of half a second at least, with both sprockets at a constant speed other than zero.
struct Interval {
  double from = 0.0, to = 0.0;
};
[[nodiscard]] std::optional<Interval> steady_drive(const Scenario& scenario);

/// Amplitude of a line at `frequency` [Hz] in samples from..to of a series (Hann window), and of its background (median
/// over
/// +-20 Hz).
struct SpectralLine {
  double amplitude = 0.0, background = 0.0;
};
[[nodiscard]] SpectralLine spectral_line(const std::vector<double>& time, const std::vector<double>& value, double from,
                                         double to, double frequency);

}  // namespace grouser
