#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

constexpr double k_kilo = 1e-3;
constexpr std::size_t k_max_columns = 680;  ///< of a map: about one a CSS pixel

/// Longitudinal force in every bushing of a track [kN], one row a sample.
std::vector<double> tensions(const RunFolder& run, Side side, std::size_t& num_links) {
  const Array force = require_channel(run, fmt::format("/tracks/{}/bushing_force", name_of(side)));
  num_links = force.shape.at(1);
  std::vector<double> tension;
  tension.reserve(force.rows() * num_links);
  for (std::size_t k = 0; k < force.values.size(); k += 3) tension.push_back(k_kilo * force.values[k]);
  return tension;
}

/// The largest tension of each bushing in equal stretches of time.
HeatMap tension_cells(const RunFolder& run, Side side, const std::vector<double>& time) {
  HeatMap map;
  map.label = "Tension [kN]";
  const std::vector<double> tension = tensions(run, side, map.rows);
  map.columns = std::clamp<std::size_t>(time.size() - 1, 1, k_max_columns);
  map.x_span = {time.front(), std::max(time.back(), time.front() + 1e-9)};
  map.y_span = {-0.5, static_cast<double>(map.rows) - 0.5};
  map.values.assign(map.columns * map.rows, std::nan(""));
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double share = (time[i] - map.x_span[0]) / (map.x_span[1] - map.x_span[0]);
    const auto column = std::min(map.columns - 1, static_cast<std::size_t>(share * static_cast<double>(map.columns)));
    for (std::size_t link = 0; link < map.rows; ++link) {
      double& cell = map.values[link * map.columns + column];
      cell = std::fmax(cell, tension[i * map.rows + link]);
    }
  }
  return map;
}

}  // namespace

Series histogram(const std::string& name, const std::vector<double>& values, double low, double high,
                 std::size_t bins) {
  Series shares{.name = name, .x = {}, .y = std::vector<double>(bins, 0.0), .style = SeriesStyle::bars};
  const double width = (high - low) / static_cast<double>(bins);
  double counted = 0.0;
  for (const double value : values) {
    if (!(value >= low && value <= high)) continue;
    shares.y[std::min(bins - 1, static_cast<std::size_t>((value - low) / width))] += 1.0;
    counted += 1.0;
  }
  for (std::size_t bin = 0; bin < bins; ++bin) {
    shares.x.push_back(low + (static_cast<double>(bin) + 0.5) * width);
    shares.y[bin] *= 100.0 / std::max(counted, 1.0);
  }
  return shares;
}

Figure figure_tension_map(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  std::vector<Panel> panels;
  std::array<double, 2> range{std::nan(""), std::nan("")};
  for (const Side side : {Side::left, Side::right}) {
    Panel panel = time_panel(side == Side::left ? "Left track" : "Right track", "Link number");
    panel.map = tension_cells(run, side, time);
    const std::array<double, 2> own = panel.map->color_range();
    range = {std::fmin(range[0], own[0]), std::fmax(range[1], own[1])};
    panels.push_back(std::move(panel));
  }
  for (Panel& panel : panels) panel.map->range = range;
  const HeatMap& any = *panels.front().map;
  const double stretch = (any.x_span[1] - any.x_span[0]) / static_cast<double>(any.columns);
  return stacked_figure(
      "tension_map", "Tension of every link",
      fmt::format("Longitudinal force in the bushing ahead of each link over time, the largest in stretches of {}. A "
                  "link that runs round the track crosses the tight span once a lap, so stripes slope with speed.",
                  quantity_text(stretch, "s", 2)),
      std::move(panels), 220);
}

Figure figure_tension_histogram(const RunFolder& run) {
  std::array<std::vector<double>, k_num_sides> all;
  double low = 0.0, high = 0.0;
  for (const Side side : {Side::left, Side::right}) {
    std::size_t num_links = 0;
    std::vector<double>& own = all[static_cast<std::size_t>(index_of(side))] = tensions(run, side, num_links);
    low = std::min(low, *std::ranges::min_element(own));
    high = std::max(high, *std::ranges::max_element(own));
  }
  if (high <= low) high = low + 1.0;
  std::vector<Panel> panels;
  for (const Side side : {Side::left, Side::right}) {
    Panel panel{.title = side == Side::left ? "Left track" : "Right track"};
    panel.x_label = "Tension [kN]";
    panel.y_label = "Samples [%]";
    panel.log_y = true;
    panel.x_range = {{low, high}};
    panel.series = {histogram(panel.title, all[static_cast<std::size_t>(index_of(side))], low, high, 80)};
    panels.push_back(std::move(panel));
  }
  return stacked_figure("tension_histogram", "Distribution of the tension",
                        "Longitudinal force over all bushings of a track and all samples of the "
                        "run, on a logarithmic scale: rare peaks are what tears rubber.",
                        std::move(panels), 140);
}

Figure figure_bushing_loops(const RunFolder& run) {
  const Probe probe = first_probe(run);
  const TimeWindow steady = require_steady_window(run);
  const double begin = std::max(steady.begin, steady.end - lap_time(run, probe.side, steady));
  const std::vector<double> time = require_column(run, "/probes/time");
  struct Loop {
    const char* title;
    const char* x_label;
    const char* y_label;
    const char* load;
    std::size_t axis, component;
    double x_scale;
  };
  constexpr std::array<Loop, 3> k_loops{
      {{"x, along the track", "Stretch [mm]", "Force [kN]", "/bushing_force", 0, 0, 1e3},
       {"z, normal to the link", "Deflection [mm]", "Force [kN]", "/bushing_force", 2, 2, 1e3},
       {"ry, hinge", "Twist [deg]", "Moment [kN m]", "/bushing_torque", 4, 1, 180.0 / k_pi}}};
  Figure figure;
  figure.name = "bushing_loops";
  figure.title = "Loops of one bushing";
  figure.caption = fmt::format(
      "Load over deflection of the joint ahead of {} during its last lap at steady speed ({}). "
      "The area of a loop is what the rubber turns into heat.",
      probe_text(probe), quantity_text(steady.end - begin, "s", 3));
  for (const Loop& loop : k_loops) {
    const std::vector<double> x = require_column(run, probe.path + "/bushing_deflection", {loop.axis});
    const std::vector<double> y = require_column(run, probe.path + loop.load, {loop.component});
    Panel panel{.title = loop.title, .x_label = loop.x_label, .y_label = loop.y_label};
    panel.zero_lines = true;
    Series series{.name = "", .x = {}, .y = {}, .width = 1.1f};
    for (std::size_t i = 0; i < std::min(time.size(), x.size()); ++i) {
      if (time[i] < begin || time[i] > steady.end) continue;
      series.x.push_back(loop.x_scale * x[i]);
      series.y.push_back(k_kilo * y[i]);
    }
    panel.series.push_back(std::move(series));
    figure.panels.push_back(std::move(panel));
  }
  figure.columns = 3;
  figure.width = 930;
  figure.height = 300;
  return figure;
}

}  // namespace grouser
