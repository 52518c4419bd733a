#include "reports/run_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "model/errors.h"
#include "reports/channels.h"

namespace grouser {
namespace {

// ---------------------------------------------------------------------------------------------------------- derived

std::vector<double> chassis_column(const RunFolder& run, const std::string& channel, std::size_t component) {
  return require_column(run, "/chassis/" + channel, {component});
}

/// An angle about an axis of the chassis, by the sequence yaw, pitch, roll (ISO 8855).
template <typename Angle>
std::vector<double> chassis_angle(const RunFolder& run, const Angle& angle) {
  const Array orientation = require_channel(run, "/chassis/orientation");
  std::vector<double> angles(orientation.rows());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const std::span<const double> q = orientation.row(i);
    angles[i] = angle(q[0], q[1], q[2], q[3]);
  }
  return angles;
}

std::vector<double> pitch(const RunFolder& run) {
  return chassis_angle(run, [](double w, double x, double y, double z) {
    return std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0));
  });
}

std::vector<double> roll(const RunFolder& run) {
  return chassis_angle(run, [](double w, double x, double y, double z) {
    return std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
  });
}

/// What an accelerometer fixed to the chassis origin shows: acceleration less gravity, in the frame of the chassis.
std::vector<double> specific_force(const RunFolder& run, std::ptrdiff_t component) {
  const Array acceleration = require_channel(run, "/chassis/acceleration");
  const Array orientation = require_channel(run, "/chassis/orientation");
  std::vector<double> shown(acceleration.rows());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::span<const double> a = acceleration.row(i), q = orientation.row(i);
    const Vector3d f_W(a[0], a[1], a[2] + run.scenario.gravity);
    shown[i] = (Quaterniond(q[0], q[1], q[2], q[3]).conjugate() * f_W)[component];
  }
  return shown;
}

struct Derived {
  const char* name;
  const char* unit;
  const char* meaning;
  std::vector<double> (*values)(const RunFolder&);  ///< at /time
};
constexpr std::array<Derived, 10> k_derived{{
    {"speed", "m/s", "forward speed of the chassis origin, along the heading of the chassis",
     [](const RunFolder& run) { return forward_speed(run); }},
    {"yaw_rate", "rad/s", "about World z, up: positive in a turn to the left",
     [](const RunFolder& run) { return chassis_column(run, "angular_velocity", 2); }},
    {"pitch", "rad", "of the chassis, positive with the nose down (ISO 8855)", pitch},
    {"roll", "rad", "of the chassis, positive with the right side down (ISO 8855)", roll},
    {"sprocket_speed_left", "rad/s", "positive where it rolls forward",
     [](const RunFolder& run) { return sprocket_rate(run, Side::left); }},
    {"sprocket_speed_right", "rad/s", "positive where it rolls forward",
     [](const RunFolder& run) { return sprocket_rate(run, Side::right); }},
    {"accelerometer_x", "m/s^2", "acceleration less gravity at the chassis origin, in the chassis: forward",
     [](const RunFolder& run) { return specific_force(run, 0); }},
    {"accelerometer_y", "m/s^2", "acceleration less gravity at the chassis origin, in the chassis: to the left",
     [](const RunFolder& run) { return specific_force(run, 1); }},
    {"accelerometer_z", "m/s^2", "acceleration less gravity at the chassis origin, in the chassis: up, +g at rest",
     [](const RunFolder& run) { return specific_force(run, 2); }},
    {"distance", "m", "way of the chassis origin along World x from the start",
     [](const RunFolder& run) {
       std::vector<double> x = chassis_column(run, "position", 0);
       const double start = x.front();
       for (double& value : x) value -= start;
       return x;
     }},
}};

// ----------------------------------------------------------------------------------------------------------- columns

/// What the columns of a dataset are, by how its path begins and ends.
struct Meaning {
  std::string_view begin, end, text;
};
constexpr std::array<Meaning, 19> k_meanings{{
    {"/chassis/", "/position", "of the chassis origin in World: x forward at the start, y left, z up"},
    {"/chassis/", "/velocity", "of the chassis origin in World"},
    {"/chassis/", "/angular_velocity", "of the chassis in World"},
    {"/chassis/", "/acceleration", "of the chassis origin in World, gravity not in it"},
    {"/chassis/", "/orientation", "quaternion of the chassis, body to World"},
    {"/joints/", "/angle", "of the joint, positive as a wheel that rolls forward"},
    {"/joints/", "/rate", "of the joint, positive as a wheel that rolls forward"},
    {"/joints/", "/torque", "on the joint, positive as it drives a wheel forward"},
    {"/probes/", "/sprocket_torque", "drive torque of the sprocket, positive as it drives forward"},
    {"/probes/", "/upper_run_tension", "mean longitudinal force of the upper run's bushings, tension is positive"},
    {"", "/bushing_force",
     "in the frame of the link: x along the track (tension is positive), y along the pin, z normal"},
    {"", "/bushing_torque", "in the frame of the link: x along the track, y along the pin, z normal"},
    {"", "/bushing_deflection", "in the frame of the link: x along the track, y along the pin, z normal"},
    {"/tracks/", "/link_position", "of the link's origin in World"},
    {"/tracks/", "/link_velocity", "of the link's origin in World"},
    {"/tracks/", "/link_angular_velocity", "of the link in World"},
    {"/tracks/", "/link_orientation", "quaternion of the link, body to World"},
    {"/energy/", "", "of the energy book"},
    {"/steps/", "", "of the integrator's accepted steps"},
}};

std::string meaning_of(const std::string& dataset) {
  if (dataset.find("/contact_force/") != std::string::npos) return "on the link, in World";
  for (const Meaning& meaning : k_meanings)
    if (dataset.starts_with(meaning.begin) && dataset.ends_with(meaning.end)) return std::string(meaning.text);
  return "";
}

/// "probes_right_20_" of "/probes/right_20/bushing_force".
std::string flat_group(const std::string& dataset) {
  const std::string group = dataset.substr(0, dataset.rfind('/'));
  return group.empty() ? "" : flat_name(group) + "_";
}

std::string with_slashes_flat(std::string name) {
  std::ranges::replace(name, '/', '_');
  return name;
}

const Derived* derived(const std::string& name) {
  const auto found = std::ranges::find_if(k_derived, [&](const Derived& d) { return d.name == name; });
  return found == k_derived.end() ? nullptr : &*found;
}

}  // namespace

std::vector<RunChannel> channels_of(const RunFolder& run) {
  std::vector<RunChannel> channels;
  for (const Derived& d : k_derived) channels.push_back({d.name, d.unit, d.meaning, {}});
  for (const std::string& dataset : run.channels.datasets()) {
    if (holds_names(dataset) || dataset.ends_with("/time")) continue;
    for (RunColumn& column : columns_of(run.channels, dataset)) {
      const std::string name = with_slashes_flat(flat_group(dataset) + column.name), unit = column.unit;
      channels.push_back({name, unit, meaning_of(dataset), std::move(column)});
    }
  }
  return channels;
}

TimeSeries read_channel(const RunFolder& run, const RunChannel& channel) {
  if (const Derived* own = channel.column.dataset.empty() ? derived(channel.name) : nullptr)
    return {require_column(run, "/time"), own->values(run)};
  TimeSeries series;
  series.value = require_column(run, channel.column.dataset, channel.column.index);
  const std::string time = time_of(run.channels, channel.column.dataset, series.value.size());
  if (time.empty())
    throw InputError(
        InputFinding{(run.path / "run.h5").string(), channel.column.dataset, "a time for every row", "none", ""});
  series.time = require_column(run, time);
  return series;
}

std::vector<const RunChannel*> channels_called(const std::vector<RunChannel>& channels, const std::string& name,
                                               const std::string& dataset) {
  std::vector<const RunChannel*> found;
  for (const RunChannel& channel : channels)
    if (channel.name == name) return {&channel};
  for (const RunChannel& channel : channels) {
    if (channel.column.dataset.empty() || with_slashes_flat(channel.column.name) != with_slashes_flat(name)) continue;
    if (!dataset.empty() && flat_name(channel.column.dataset) == dataset) return {&channel};
    found.push_back(&channel);
  }
  return found;
}

std::vector<RunChannel> main_channels(const RunFolder& run) {
  const std::vector<RunChannel> all = channels_of(run);
  std::vector<std::string> names{"speed",
                                 "yaw_rate",
                                 "sprocket_torque_left",
                                 "sprocket_torque_right",
                                 "upper_run_tension_left",
                                 "upper_run_tension_right"};
  if (const std::vector<Probe> probed = probes(run); !probed.empty())
    names.push_back(flat_name(probed.front().path) + "_bushing_force_x");
  std::vector<RunChannel> kept;
  for (const std::string& name : names)
    if (const std::vector<const RunChannel*> found = channels_called(all, name); found.size() == 1)
      kept.push_back(*found.front());
  return kept;
}

ShownUnit shown_unit(const std::string& unit, double largest) {
  if (unit == "rad") return {"deg", 180.0 / k_pi};
  if ((unit == "N" || unit == "N m" || unit == "J") && largest >= 1e3) return {"k" + unit, 1e-3};
  if (unit == "m" && largest < 0.1) return {"mm", 1e3};
  return {unit, 1.0};
}

}  // namespace grouser
