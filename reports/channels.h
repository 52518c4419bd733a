#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/run.h"

/// What figures and pages ask of a run folder beyond single datasets.
namespace grouser {

/// A dataset that a figure needs. Throws InputError naming run.h5 and the dataset when the run does not hold it.
[[nodiscard]] Array require_channel(const RunFolder& run, const std::string& path);
/// One column of it over all rows; the same error.
[[nodiscard]] std::vector<double> require_column(const RunFolder& run, const std::string& path,
                                                 const std::vector<std::size_t>& index = {});
/// Row of "<side>/<joint>" in /joints/*; the same error when the name is absent.
[[nodiscard]] std::size_t joint_index(const RunFolder& run, Side side, const std::string& joint);

/// Length of each row of a [T,3] array.
[[nodiscard]] std::vector<double> row_lengths(const Array& vectors);
[[nodiscard]] std::vector<double> scaled(std::vector<double> values, double factor);

struct TimeWindow {
  double begin = 0.0, end = 0.0;  ///< s
};
/// The longest stretch in which both sprockets are asked for a constant, non-zero speed; none when there is no such
/// stretch.
[[nodiscard]] std::optional<TimeWindow> steady_window(const RunFolder& run);
/// The same; InputError when there is none.
[[nodiscard]] TimeWindow require_steady_window(const RunFolder& run);
/// Sprocket speed that the scenario asks for at time t [rad/s]: prescribed, or what a driver's wish for the track's
/// speed comes to; none where a torque is asked for.
[[nodiscard]] std::optional<double> asked_speed(const RunFolder& run, Side side, double t);
/// Speed at which the sprocket feeds the track without slip: teeth * pitch * omega / 2 pi [m/s].
[[nodiscard]] double track_feed_speed(const RunFolder& run, Side side, double omega);

/// A link recorded at high rate: "/probes/right_20".
struct Probe {
  std::string path;
  Side side = Side::right;
  int link = 0;
};
/// All probes, right side first (the paper shows a link of the right track).
[[nodiscard]] std::vector<Probe> probes(const RunFolder& run);

/// The first of them; InputError when no link is probed.
[[nodiscard]] Probe first_probe(const RunFolder& run);
/// "link 20 of the right track"
[[nodiscard]] std::string probe_text(const Probe& probe);
/// Time that a link takes round its track at the steady speed [s].
[[nodiscard]] double lap_time(const RunFolder& run, Side side, const TimeWindow& steady);

/// Component of a channel ("/bushing_force") of the first probe, at /probes/time; InputError when no link is probed.
[[nodiscard]] std::vector<double> probe_column(const RunFolder& run, const std::string& channel, std::size_t component);

/// Mean longitudinal force [N] over the bushings of the upper run, at /probes/time.
[[nodiscard]] std::vector<double> upper_run_tension(const RunFolder& run, Side side);
/// Torque [N m] that holds the sprocket to its prescribed speed, at /probes/time: the samples are close enough for the
/// link-passing frequency and its harmonics.
[[nodiscard]] std::vector<double> sprocket_torque(const RunFolder& run, Side side);
/// Speed of a sprocket [rad/s], at /time.
[[nodiscard]] std::vector<double> sprocket_rate(const RunFolder& run, Side side);
/// Forward speed of the chassis origin, in the chassis' own heading [m/s].
[[nodiscard]] std::vector<double> forward_speed(const RunFolder& run);

/// Single-sided amplitude spectrum of evenly spaced samples: linear trend removed, Hann window, amplitudes of a sine
/// read true.
struct Spectrum {
  std::vector<double> frequency;  ///< Hz
  std::vector<double> amplitude;  ///< unit of the samples
};
[[nodiscard]] Spectrum amplitude_spectrum(const std::vector<double>& samples, double rate);

}  // namespace grouser
