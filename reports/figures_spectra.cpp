#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

/// Samples of the steady drive, without its first third, which still rings from the change of drive.
struct SteadySamples {
  std::size_t first = 0, count = 0;
  double begin = 0.0, end = 0.0;  ///< s
  double rate = 0.0;              ///< Hz
};
SteadySamples steady_samples(const RunFolder& run) {
  const TimeWindow window = require_steady_window(run);
  const std::vector<double> time = require_column(run, "/probes/time");
  const double begin = window.begin + (window.end - window.begin) / 3.0;
  const auto first = std::lower_bound(time.begin(), time.end(), begin),
             last = std::upper_bound(first, time.end(), window.end);
  if (last - first < 16) (void)require_channel(run, "/probes/time: samples of the steady stretch");
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - first), begin, window.end,
          static_cast<double>(last - first - 1) / (*(last - 1) - *first)};
}

/// Links meet the sprocket at teeth x omega / 2 pi [Hz].
double link_passing(const RunFolder& run, double time) {
  return run.vehicle.side(Side::right).sprocket.teeth * std::abs(asked_speed(run, Side::right, time).value()) /
         (2.0 * k_pi);
}

/// Amplitudes over frequency of a channel of both sides, with the line of link passing marked.
Panel spectrum_panel(const RunFolder& run, const SteadySamples& steady, const std::string& y_label, double scale,
                     std::vector<double> (*channel)(const RunFolder&, Side)) {
  Panel panel;
  panel.x_label = "Frequency f [Hz]";
  panel.y_label = y_label;
  panel.log_y = true;
  double peak = 0.0;
  for (const Side side : {Side::left, Side::right}) {
    const std::vector<double> all = channel(run, side);
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(steady.first);
    Spectrum spectrum = amplitude_spectrum({first, first + static_cast<std::ptrdiff_t>(steady.count)}, steady.rate);
    panel.series.push_back({.name = name_of(side),
                            .x = std::move(spectrum.frequency),
                            .y = scaled(std::move(spectrum.amplitude), scale),
                            .style = side_style(side),
                            .width = 1.3f});
    for (const double amplitude : panel.series.back().y) peak = std::max(peak, amplitude);
  }
  const double passing = link_passing(run, steady.begin);
  // Six harmonics tell the story; beyond them the line is fine print. Four decades below the peak is noise.
  panel.x_range = {{0.0, std::min(0.5 * steady.rate, 6.2 * passing)}};
  if (peak > 0.0) panel.y_range = {{1e-4 * peak, 2.5 * peak}};
  if (passing < 0.5 * steady.rate) panel.marks.push_back({passing, true, number_text(passing, 3) + " Hz link passing"});
  return panel;
}

}  // namespace

Figure figure_torque_spectrum(const RunFolder& run) {
  const SteadySamples steady = steady_samples(run);
  return stacked_figure(
      "torque_spectrum", "Spectrum of the sprocket torque",
      fmt::format("Amplitude spectrum of the drive torque at steady speed, {} to {} s (Hann window). Links meet the "
                  "sprocket at teeth × ω / 2π = {}; a tension that rides with a link would smear this line.",
                  number_text(steady.begin, 3), number_text(steady.end, 3),
                  quantity_text(link_passing(run, steady.begin), "Hz", 3)),
      {spectrum_panel(run, steady, "Torque amplitude [kN m]", 1e-3, sprocket_torque)}, 260);
}

Figure figure_tension_spectrum(const RunFolder& run) {
  const SteadySamples steady = steady_samples(run);
  return stacked_figure(
      "tension_spectrum", "Spectrum of the tension",
      fmt::format("Amplitude spectrum of the mean tension of the upper runs at steady speed, {} to {} s (Hann window): "
                  "what of the links’ meeting the sprocket reaches the free span of the track.",
                  number_text(steady.begin, 3), number_text(steady.end, 3)),
      {spectrum_panel(run, steady, "Tension amplitude [kN]", 1e-3, upper_run_tension)}, 260);
}

}  // namespace grouser
