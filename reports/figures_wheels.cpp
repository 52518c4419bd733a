#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/geometry.h"
#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

constexpr double k_smooth = 0.1;  ///< s

/// Curves of one side, one a station.
using Stations = std::vector<std::vector<double>>;

/// Angle of each road arm about V's +y, 0 at design [rad].
Stations arm_angles(const RunFolder& run, Side side) {
  Stations angles;
  for (std::size_t i = 0; i < run.vehicle.side(side).stations.size(); ++i)
    angles.push_back(require_column(run, "/joints/angle", {joint_index(run, side, fmt::format("arm_{}", i + 1))}));
  return angles;
}

/// Centre of a wheel in V when its arm has turned by `angle` about +y.
Vector3d wheel_center(const Station& station, double angle) {
  const Vector3d arm = station.wheel.center - station.pivot;
  const double c = std::cos(angle), s = std::sin(angle);
  return station.pivot + Vector3d(c * arm.x() + s * arm.z(), arm.y(), -s * arm.x() + c * arm.z());
}

/// Mean over the samples within `reach` to both sides.
std::vector<double> moving_mean(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> sum(values.size() + 1, 0.0), mean(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) sum[i + 1] = sum[i] + values[i];
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t begin = i > reach ? i - reach : 0, end = std::min(values.size(), i + reach + 1);
    mean[i] = (sum[end] - sum[begin]) / static_cast<double>(end - begin);
  }
  return mean;
}

/// Vertical force of each road wheel on the track [N]: that on each link belongs to the wheel nearest along the
/// vehicle, because wheels stand several links apart.
Stations wheel_loads(const RunFolder& run, Side side) {
  const std::string track = std::string("/tracks/") + name_of(side);
  const Array force = require_channel(run, track + "/contact_force/road_wheel");
  const Array link = require_channel(run, track + "/link_position");
  const Array chassis = require_channel(run, "/chassis/position");
  const Array orientation = require_channel(run, "/chassis/orientation");
  const Stations angles = arm_angles(run, side);
  const std::vector<Station>& stations = run.vehicle.side(side).stations;
  Stations loads(stations.size(), std::vector<double>(force.rows(), 0.0));
  for (std::size_t row = 0; row < force.rows(); ++row) {
    const std::span<const double> q = orientation.row(row), p = chassis.row(row), f = force.row(row), x = link.row(row);
    const Vector3d forward = Quaterniond(q[0], q[1], q[2], q[3]) * Vector3d::UnitX();
    for (std::size_t k = 0; k < f.size(); k += 3) {
      if (f[k + 2] == 0.0) continue;
      const double ahead = forward.dot(Vector3d(x[k] - p[0], x[k + 1] - p[1], x[k + 2] - p[2]));
      const auto distance = [&](std::size_t i) {
        return std::abs(ahead - wheel_center(stations[i], angles[i][row]).x());
      };
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < stations.size(); ++i)
        if (distance(i) < distance(nearest)) nearest = i;
      loads[nearest][row] -= f[k + 2];
    }
  }
  return loads;
}

Panel station_panel(Side side, const std::string& y_label, const std::vector<double>& time, const Stations& curves,
                    double scale, const char* name) {
  Panel panel = time_panel(side == Side::left ? "Left" : "Right", y_label);
  for (std::size_t i = 0; i < curves.size(); ++i)
    panel.series.push_back(
        {.name = fmt::format("{} {}", name, i + 1), .x = time, .y = scaled(curves[i], scale), .width = 1.2f});
  return panel;
}

}  // namespace

Figure figure_wheel_loads(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  const double interval = time.size() > 1 ? (time.back() - time.front()) / static_cast<double>(time.size() - 1) : 1.0;
  const auto reach = static_cast<std::size_t>(std::lround(0.5 * k_smooth / interval));
  std::vector<Panel> panels;
  for (const Side side : {Side::left, Side::right}) {
    Stations loads = wheel_loads(run, side);
    for (std::vector<double>& load : loads) load = moving_mean(load, reach);
    panels.push_back(station_panel(side, "Load [kN]", time, loads, 1e-3, "wheel"));
  }
  return stacked_figure("wheel_loads", "Wheel loads",
                        fmt::format("Vertical force of each road wheel on the track, counted from the front, mean over "
                                    "{}.",
                                    quantity_text(k_smooth, "s", 2)),
                        std::move(panels));
}

Figure figure_wheel_travel(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  std::vector<Panel> panels;
  for (const Side side : {Side::left, Side::right}) {
    Stations travel = arm_angles(run, side);
    for (std::size_t i = 0; i < travel.size(); ++i) {
      const Station& station = run.vehicle.side(side).stations[i];
      for (double& value : travel[i]) value = wheel_center(station, value).z() - station.wheel.center.z();
    }
    panels.push_back(station_panel(side, "Travel [mm]", time, travel, 1e3, "wheel"));
  }
  return stacked_figure("wheel_travel", "Wheel travel",
                        "Height of each wheel’s centre in the chassis against its design position, counted from the "
                        "front; up is bump.",
                        std::move(panels));
}

Figure figure_suspension(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/time");
  std::vector<Panel> panels;
  for (const Side side : {Side::left, Side::right})
    panels.push_back(station_panel(side, "Arm angle [deg]", time, arm_angles(run, side), 180.0 / k_pi, "arm"));
  return stacked_figure("suspension", "Suspension",
                        "Angle of every road arm against its design position, counted from the front.",
                        std::move(panels));
}

}  // namespace grouser
