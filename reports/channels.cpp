#include "reports/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "model/errors.h"

namespace grouser {
namespace {

[[noreturn]] void missing(const RunFolder& run, const std::string& path) {
  throw InputError(InputFinding{(run.path / "run.h5").string(), path, "a dataset", "none", ""});
}

Quaterniond quaternion_of(std::span<const double> wxyz) { return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}; }
Vector3d vector_of(std::span<const double> xyz) { return {xyz[0], xyz[1], xyz[2]}; }

}  // namespace

Array require_channel(const RunFolder& run, const std::string& path) {
  if (!run.channels.has(path)) missing(run, path);
  Array array = run.channels.read(path);
  if (array.rows() == 0) missing(run, path);
  return array;
}

std::vector<double> require_column(const RunFolder& run, const std::string& path,
                                   const std::vector<std::size_t>& index) {
  if (!run.channels.has(path)) missing(run, path);
  std::vector<double> column = run.channels.read_column(path, index);
  if (column.empty()) missing(run, path);
  return column;
}

std::size_t joint_index(const RunFolder& run, Side side, const std::string& joint) {
  if (!run.channels.has("/joints/names")) missing(run, "/joints/names");
  const std::vector<std::string> names = run.channels.read_names("/joints/names");
  const std::string wanted = std::string(name_of(side)) + "/" + joint;
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end()) missing(run, "/joints/names: " + wanted);
  return static_cast<std::size_t>(found - names.begin());
}

std::vector<double> row_lengths(const Array& vectors) {
  std::vector<double> lengths(vectors.rows());
  for (std::size_t i = 0; i < lengths.size(); ++i) lengths[i] = vector_of(vectors.row(i)).norm();
  return lengths;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::optional<double> asked_speed(const RunFolder& run, Side side, double t) {
  const DriveTable& table = run.scenario.drive[static_cast<std::size_t>(index_of(side))];
  if (table.kind == DriveKind::torque) return std::nullopt;
  const double asked = table_value(table.time, table.value(), t);
  return table.kind == DriveKind::speed ? asked : asked / track_feed_speed(run, side, 1.0);
}

std::optional<TimeWindow> steady_window(const RunFolder& run) {
  std::vector<double> breaks{0.0, run.summary.simulated_time};
  for (const DriveTable& table : run.scenario.drive)
    for (const double t : table.time)
      if (t > 0.0 && t < run.summary.simulated_time) breaks.push_back(t);
  std::sort(breaks.begin(), breaks.end());
  std::optional<TimeWindow> best;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const TimeWindow window{breaks[i], breaks[i + 1]};
    const bool steady = std::ranges::all_of(std::array{Side::left, Side::right}, [&](Side side) {
      const std::optional<double> from = asked_speed(run, side, window.begin), to = asked_speed(run, side, window.end);
      return from && to && std::abs(*from) > 1e-6 && std::abs(*to - *from) < 1e-9;
    });
    if (steady && (!best || window.end - window.begin > best->end - best->begin)) best = window;
  }
  return best;
}

TimeWindow require_steady_window(const RunFolder& run) {
  const std::optional<TimeWindow> window = steady_window(run);
  if (!window)
    throw InputError(InputFinding{(run.path / "inputs/scenario.json").string(), "/drive",
                                  "a stretch of constant, non-zero sprocket speed", "none", ""});
  return *window;
}

double track_feed_speed(const RunFolder& run, Side side, double omega) {
  const RunningGear& gear = run.vehicle.side(side);
  return gear.sprocket.teeth * gear.track.pitch * omega / (2.0 * k_pi);
}

std::vector<Probe> probes(const RunFolder& run) {
  std::vector<Probe> found;
  for (const Side side : {Side::right, Side::left}) {
    const std::string start = std::string("/probes/") + name_of(side) + "_", end = "/bushing_force";
    for (const std::string& path : run.channels.datasets()) {
      if (!path.starts_with(start) || !path.ends_with(end)) continue;
      Probe probe{path.substr(0, path.size() - end.size()), side, 0};
      const char* const last = probe.path.data() + probe.path.size();
      if (std::from_chars(probe.path.data() + start.size(), last, probe.link).ptr == last) found.push_back(probe);
    }
  }
  return found;
}

Probe first_probe(const RunFolder& run) {
  const std::vector<Probe> all = probes(run);
  if (all.empty())
    throw InputError(InputFinding{(run.path / "run.h5").string(), "/probes", "a probe link", "none",
                                  "name probe links in the scenario's output section"});
  return all.front();
}

std::string probe_text(const Probe& probe) {
  return fmt::format("link {} of the {} track", probe.link, name_of(probe.side));
}

double lap_time(const RunFolder& run, Side side, const TimeWindow& steady) {
  const Track& track = run.vehicle.side(side).track;
  return track.num_links * track.pitch /
         std::abs(track_feed_speed(run, side, asked_speed(run, side, steady.begin).value()));
}

std::vector<double> probe_column(const RunFolder& run, const std::string& channel, std::size_t component) {
  const std::vector<Probe> all = probes(run);
  if (all.empty()) missing(run, "/probes");
  return require_column(run, all.front().path + channel, {component});
}

std::vector<double> upper_run_tension(const RunFolder& run, Side side) {
  return require_column(run, "/probes/upper_run_tension", {static_cast<std::size_t>(index_of(side))});
}

std::vector<double> sprocket_torque(const RunFolder& run, Side side) {
  return require_column(run, "/probes/sprocket_torque", {static_cast<std::size_t>(index_of(side))});
}

std::vector<double> sprocket_rate(const RunFolder& run, Side side) {
  return require_column(run, "/joints/rate", {joint_index(run, side, "sprocket")});
}

std::vector<double> forward_speed(const RunFolder& run) {
  const Array velocity = require_channel(run, "/chassis/velocity");
  const Array orientation = require_channel(run, "/chassis/orientation");
  std::vector<double> speed(velocity.rows());
  for (std::size_t i = 0; i < speed.size(); ++i)
    speed[i] = (quaternion_of(orientation.row(i)).conjugate() * vector_of(velocity.row(i))).x();
  return speed;
}

Spectrum amplitude_spectrum(const std::vector<double>& samples, double rate) {
  const std::size_t n = samples.size();
  if (n < 8) return {};
  // Line through the samples by least squares, removed so that slow drift does not leak over the low frequencies.
  const double middle = 0.5 * static_cast<double>(n - 1);
  double mean = 0.0, moment = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < n; ++i) mean += samples[i] / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(i) - middle;
    moment += x * samples[i];
    spread += x * x;
  }
  std::vector<double> windowed(n);
  double window_sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double window = 0.5 - 0.5 * std::cos(2.0 * k_pi * static_cast<double>(i) / static_cast<double>(n));
    windowed[i] = window * (samples[i] - mean - moment / spread * (static_cast<double>(i) - middle));
    window_sum += window;
  }
  std::vector<std::complex<double>> transform;
  Eigen::FFT<double>().fwd(transform, windowed);
  Spectrum spectrum;
  for (std::size_t i = 1; i <= n / 2; ++i) {
    spectrum.frequency.push_back(rate * static_cast<double>(i) / static_cast<double>(n));
    spectrum.amplitude.push_back(2.0 * std::abs(transform[i]) / window_sum);
  }
  return spectrum;
}

}  // namespace grouser
