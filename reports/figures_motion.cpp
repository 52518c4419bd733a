#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

const DriveTable& drive_of(const RunFolder& run, Side side) {
  return run.scenario.drive[static_cast<std::size_t>(index_of(side))];
}

/// The speed that the drivers of both sides wish for.
Series wished_speed(const RunFolder& run, const std::vector<double>& time) {
  Series wished{.name = "driver's wish", .x = time, .y = {}, .width = 1.2f, .hue = 6};
  for (const double t : time) {
    double sum = 0.0;
    for (const Side side : {Side::left, Side::right})
      sum += table_value(drive_of(run, side).time, drive_of(run, side).target_speed, t);
    wished.y.push_back(0.5 * sum);
  }
  return wished;
}

/// The torque tables of the sprockets that a torque drives.
std::optional<Panel> asked_torque(const RunFolder& run, const std::vector<double>& time) {
  Panel panel = time_panel("Torque asked for", "Torque [kN m]");
  for (const Side side : {Side::left, Side::right}) {
    const DriveTable& table = drive_of(run, side);
    if (table.kind != DriveKind::torque) continue;
    Series torque{.name = name_of(side), .x = time, .y = {}, .style = side_style(side)};
    for (const double t : time) torque.y.push_back(1e-3 * table_value(table.time, table.torque, t));
    panel.series.push_back(std::move(torque));
  }
  return panel.series.empty() ? std::nullopt : std::optional(std::move(panel));
}

/// What the scenario asks of the sprockets, in a sentence.
std::string asked_text(const RunFolder& run) {
  const DriveKind left = drive_of(run, Side::left).kind, right = drive_of(run, Side::right).kind;
  if (left != right) return "The sides are driven in different ways.";
  if (left == DriveKind::speed) return "Their motion is prescribed.";
  return left == DriveKind::torque ? "They turn under the torque asked for; no speed is."
                                   : "A driver holds the speed wished for, within the power and torque of the engine.";
}

}  // namespace

Panel time_panel(const std::string& title, const std::string& y_label) {
  Panel panel;
  panel.title = title;
  panel.x_label = "Time t [s]";
  panel.y_label = y_label;
  return panel;
}

SeriesStyle side_style(Side side) { return side == Side::left ? SeriesStyle::line : SeriesStyle::dashed; }

Figure stacked_figure(const std::string& name, const std::string& title, const std::string& caption,
                      std::vector<Panel> panels, int panel_height) {
  Figure figure;
  figure.name = name;
  figure.title = title;
  figure.caption = caption;
  constexpr int k_frame = 90;  // title and the shared x axis
  figure.height = k_frame + panel_height * static_cast<int>(panels.size());
  for (std::size_t i = 0; i + 1 < panels.size(); ++i) panels[i].x_label.clear();
  figure.panels = std::move(panels);
  figure.share_x = figure.panels.size() > 1;
  return figure;
}

Figure figure_speed(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  Panel vehicle = time_panel("Vehicle", "Speed v [m/s]");
  vehicle.series.push_back({.name = "vehicle", .x = time, .y = forward_speed(run)});
  Series feed{.name = "track feed, mean of both sides", .x = time, .y = {}, .style = SeriesStyle::dashed};
  const std::vector<double> left = sprocket_rate(run, Side::left), right = sprocket_rate(run, Side::right);
  for (std::size_t i = 0; i < time.size(); ++i)
    feed.y.push_back(0.5 * (track_feed_speed(run, Side::left, left[i]) + track_feed_speed(run, Side::right, right[i])));
  vehicle.series.push_back(std::move(feed));
  if (drive_of(run, Side::left).kind == DriveKind::cruise && drive_of(run, Side::right).kind == DriveKind::cruise)
    vehicle.series.push_back(wished_speed(run, time));
  Panel sprockets = time_panel("Sprockets", "Speed ω [rad/s]");
  for (const Side side : {Side::left, Side::right})
    sprockets.series.push_back(
        {.name = name_of(side), .x = time, .y = side == Side::left ? left : right, .style = side_style(side)});
  std::vector<Panel> panels{std::move(vehicle), std::move(sprockets)};
  if (std::optional<Panel> torque = asked_torque(run, time)) panels.push_back(std::move(*torque));
  return stacked_figure("speed", "Speed",
                        "Forward speed of the chassis against the speed at which the sprockets feed the tracks "
                        "(teeth × pitch × ω / 2π), and the sprockets' speeds. " +
                            asked_text(run),
                        std::move(panels), 190);
}

Figure figure_path(const RunFolder& run) {
  const std::vector<double> x = require_column(run, "/chassis/position", {0}),
                            y = require_column(run, "/chassis/position", {1});
  Figure figure;
  figure.name = "path";
  figure.title = "Path";
  figure.caption = "Path of the chassis origin over the ground, seen from above.";
  Panel panel;
  panel.x_label = "Forward x [m]";
  panel.y_label = "Left y [m]";
  panel.series.push_back({.name = "chassis origin", .x = x, .y = y, .width = 1.8f});
  panel.series.push_back(
      {.name = "start", .x = {x.front()}, .y = {y.front()}, .style = SeriesStyle::points, .width = 3.5f});
  panel.series.push_back(
      {.name = "end", .x = {x.back()}, .y = {y.back()}, .style = SeriesStyle::points, .width = 3.5f});
  const auto [rear, front] = std::ranges::minmax(x);
  const auto [low, high] = std::ranges::minmax(y);
  // A straight run would otherwise blow micrometres of drift up to the height of the page; a turn on the spot keeps one
  // scale along both axes (the panel is about 2.2 times as wide as high).
  constexpr double k_aspect = 2.2, k_spot = 3.0 /* m */;
  double half = std::max(0.6 * (high - low), 0.05);
  if (front - rear < k_spot) {
    half = std::max(half, 0.6 * (front - rear) / k_aspect);
    panel.x_range = {{0.5 * (rear + front) - k_aspect * half, 0.5 * (rear + front) + k_aspect * half}};
  }
  panel.y_range = {{0.5 * (low + high) - half, 0.5 * (low + high) + half}};
  figure.panels = {std::move(panel)};
  figure.width = 560;
  figure.height = 290;
  return figure;
}

Figure figure_yaw_rate(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  Panel panel = time_panel("", "Yaw rate [rad/s]");
  panel.series.push_back({.name = "vehicle", .x = time, .y = require_column(run, "/chassis/angular_velocity", {2})});
  const double tread = run.vehicle.side(Side::left).track_center_y - run.vehicle.side(Side::right).track_center_y;
  std::string caption = "Yaw rate of the chassis about the vertical; positive turns left.";
  if (tread > 0.0) {
    Series no_slip{.name = "without slip", .x = time, .y = {}, .style = SeriesStyle::dashed};
    const std::vector<double> left = sprocket_rate(run, Side::left), right = sprocket_rate(run, Side::right);
    for (std::size_t i = 0; i < time.size(); ++i)
      no_slip.y.push_back((track_feed_speed(run, Side::right, right[i]) - track_feed_speed(run, Side::left, left[i])) /
                          tread);
    panel.series.push_back(std::move(no_slip));
    caption += " Without slip it would be the difference of the track speeds over the tread.";
  }
  // A vehicle that drives straight shows a line, not its round-off.
  constexpr double k_turning = 0.05;
  bool turns = false;
  for (const Series& series : panel.series)
    turns = turns || std::ranges::any_of(series.y, [](double rate) { return std::abs(rate) > k_turning; });
  if (!turns) panel.y_range = {{-k_turning, k_turning}};
  return stacked_figure("yaw_rate", "Yaw rate", caption, {std::move(panel)}, 240);
}

}  // namespace grouser
