#include "tests/support/mock_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "model/run.h"
#include "tests/support/mock_inputs.h"

namespace grouser::mock {
namespace {

struct Point {
  double x = 0.0, z = 0.0;
};

/// Closed belt round the running gear: hull of circles, walked by arc length.
class Belt {
 public:
  Belt() {
    struct Circle {
      double x, z, r;
    };
    std::vector<Point> points;
    for (const Circle& c :
         {Circle{-2.75, 0.82, 0.31}, Circle{2.75, 0.75, 0.335}, Circle{1.9, 0.4, 0.345}, Circle{-1.9, 0.4, 0.345}})
      for (int i = 0; i < 64; ++i)
        points.push_back({c.x + c.r * std::cos(k_pi * i / 32.0), c.z + c.r * std::sin(k_pi * i / 32.0)});
    std::ranges::sort(points, [](const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.z < b.z); });
    for (const bool upper : {false, true}) {
      const std::size_t start = hull_.size();
      for (const Point& p : points) {
        while (hull_.size() >= start + 2 && turn(hull_[hull_.size() - 2], hull_.back(), p) <= 0.0) hull_.pop_back();
        hull_.push_back(p);
      }
      hull_.pop_back();
      if (!upper) std::ranges::reverse(points);
    }
    hull_.push_back(hull_.front());
    length_.push_back(0.0);
    for (std::size_t i = 1; i < hull_.size(); ++i)
      length_.push_back(length_.back() + std::hypot(hull_[i].x - hull_[i - 1].x, hull_[i].z - hull_[i - 1].z));
  }
  [[nodiscard]] double length() const { return length_.back(); }
  /// Point and direction angle about y at arc length s, walked against the sense of rolling forward.
  [[nodiscard]] Point at(double s, double& angle) const {
    s = std::fmod(std::fmod(s, length()) + length(), length());
    const auto after = std::upper_bound(length_.begin(), length_.end() - 1, s);
    const auto i = static_cast<std::size_t>(after - length_.begin());
    const Point a = hull_[i - 1], b = hull_[i];
    const double part = (s - length_[i - 1]) / (length_[i] - length_[i - 1]);
    angle = -std::atan2(b.z - a.z, b.x - a.x);
    return {a.x + part * (b.x - a.x), a.z + part * (b.z - a.z)};
  }

 private:
  static double turn(const Point& o, const Point& a, const Point& b) {
    return (a.x - o.x) * (b.z - o.z) - (a.z - o.z) * (b.x - o.x);
  }
  std::vector<Point> hull_;
  std::vector<double> length_;
};

const std::vector<std::string>& partners() {
  static const std::vector<std::string> names{"road_wheel", "support_roller", "idler", "sprocket", "guide", "ground"};
  return names;
}

ChannelTable sample_table(const RunOptions& options) {
  const std::size_t n = k_num_links, joints = 36;
  ChannelTable table{"samples",
                     {{"/time", "s", {}, false},
                      {"/chassis/position", "m", {3}, false},
                      {"/chassis/orientation", "1", {4}, false},
                      {"/chassis/velocity", "m/s", {3}, false},
                      {"/chassis/angular_velocity", "rad/s", {3}, false},
                      {"/chassis/acceleration", "m/s^2", {3}, false},
                      {"/joints/angle", "rad", {joints}, false},
                      {"/joints/rate", "rad/s", {joints}, false},
                      {"/joints/torque", "N m", {joints}, false}}};
  for (const std::string side : {"left", "right"}) {
    const std::string track = "/tracks/" + side;
    table.channels.push_back({track + "/link_position", "m", {n, 3}, false});
    table.channels.push_back({track + "/link_orientation", "1", {n, 4}, true});
    table.channels.push_back({track + "/bushing_force", "N", {n, 3}, true});
    for (const std::string& partner : options.contact_forces ? partners() : std::vector<std::string>{})
      table.channels.push_back({track + "/contact_force/" + partner, "N", {n, 3}, true});
  }
  for (const char* term :
       {"kinetic", "gravity", "bushing", "suspension", "contact", "input", "bushing_loss", "contact_loss",
        "friction_loss", "ground_loss", "suspension_loss", "tensioner_loss", "residual"})
    table.channels.push_back({std::string("/energy/") + term, "J", {}, false});
  return table;
}

std::vector<std::string> joint_names() {
  std::vector<std::string> names;
  for (const std::string side : {"left", "right"}) {
    for (const char* part : {"sprocket", "idler_arm", "idler"}) names.push_back(side + "/" + part);
    for (int i = 1; i <= 3; ++i) names.push_back(side + "/roller_" + std::to_string(i));
    for (int i = 1; i <= k_num_stations; ++i) {
      names.push_back(side + "/arm_" + std::to_string(i));
      names.push_back(side + "/wheel_" + std::to_string(i));
    }
  }
  return names;
}

/// Everything a row needs, as closed forms of time.
struct Motion {
  RunOptions options;
  Belt belt;
  [[nodiscard]] double omega(double t) const {
    const double third = options.duration / 3.0;
    return options.top_speed * std::clamp(std::min(t, options.duration - t) / third, 0.0, 1.0);
  }
  [[nodiscard]] double angle(double t) const {
    const double d = options.duration / 3.0;
    if (t < d) return options.top_speed * 0.5 * t * t / d;
    if (t < 2.0 * d) return options.top_speed * (t - 0.5 * d);
    const double left = options.duration - t;
    return options.top_speed * (2.0 * d - 0.5 * left * left / d);
  }
  [[nodiscard]] double torque(double t) const {
    return 6e3 + 4e3 * std::sin(2.0 * k_pi * 71.6 * t) + (t < options.duration / 3.0 ? 8e3 : 0.0);
  }
};

std::vector<double> sample_row(const Motion& motion, double t) {
  const double w = motion.omega(t), phi = motion.angle(t), radius = 1.94 / (2.0 * k_pi);
  const bool turn = motion.options.turn;
  const double x = turn ? 0.0 : radius * phi, v = turn ? 0.0 : radius * w, yaw = turn ? -0.13 * radius * phi : 0.0;
  const std::array<double, 4> facing{std::cos(yaw / 2.0), 0.0, 0.0, std::sin(yaw / 2.0)};
  std::vector<double> row{t, x, 0.001 * std::sin(t), 0.0};
  row.insert(row.end(), facing.begin(), facing.end());
  row.insert(row.end(), {v, 0.0, 0.0, 0.0, 0.0, turn ? -0.13 * radius * w : 0.0, 0.0, 0.0, 0.0});
  const std::vector<std::string> names = joint_names();
  for (const int channel : {0, 1, 2})
    for (const std::string& name : names) {
      const double sense = turn && name.starts_with("right") ? -1.0 : 1.0;
      const bool arm = name.find("arm_") != std::string::npos, sprocket = name.ends_with("sprocket");
      if (channel == 0) row.push_back(arm ? 0.02 * std::sin(9.0 * t) : sense * phi);
      if (channel == 1) row.push_back(arm ? 0.18 * std::cos(9.0 * t) : sense * w);
      if (channel == 2) row.push_back(sprocket ? sense * motion.torque(t) : 0.0);
    }
  for (const double side : {1.0, -1.0}) {
    const double sense = turn && side < 0.0 ? -1.0 : 1.0;
    std::vector<double> position, orientation, force;
    for (int i = 0; i < k_num_links; ++i) {
      double tilt = 0.0;
      const Point p = motion.belt.at(motion.belt.length() * i / k_num_links - sense * radius * phi, tilt);
      position.insert(position.end(), {x + p.x * std::cos(yaw) - 1.4 * side * std::sin(yaw),
                                       p.x * std::sin(yaw) + 1.4 * side * std::cos(yaw), p.z});
      const double c = std::cos(tilt / 2.0), s = std::sin(tilt / 2.0);
      orientation.insert(orientation.end(), {facing[0] * c, -facing[3] * s, facing[0] * s, facing[3] * c});
      force.insert(force.end(), {5e4 + 1e4 * std::sin(5.0 * t + i) + 200.0 * w, 100.0, -300.0});
    }
    for (const std::vector<double>* part : {&position, &orientation, &force})
      row.insert(row.end(), part->begin(), part->end());
    for (std::size_t partner = 0; motion.options.contact_forces && partner < partners().size(); ++partner) {
      for (int i = 0; i < k_num_links; ++i) {  // every seventh link is loaded, each partner's own
        const bool loaded = i % 7 == static_cast<int>(partner);
        const double up = partners()[partner] == "ground" ? 1.0 : -1.0;
        row.insert(row.end(), {loaded ? 2e3 * std::sin(t + i) : 0.0, 0.0, loaded ? up * (3e4 + 200.0 * i) : 0.0});
      }
    }
  }
  const double kinetic = 0.5 * 4.4e4 * v * v, work = 2.0 * 6e3 * phi;
  row.insert(row.end(), {kinetic, 0.0, 2e3, 1e3, 50.0, kinetic + work + 3050.0, 0.5 * work, 0.1 * work, 0.1 * work,
                         0.2 * work, 0.1 * work, 0.0, 3.0 * std::sin(t)});
  return row;
}

ChannelTable probe_table() {
  ChannelTable table{"probes",
                     {{"/probes/time", "s", {}, false},
                      {"/probes/sprocket_torque", "N m", {2}, false},
                      {"/probes/upper_run_tension", "N", {2}, false},
                      {"/probes/right_20/bushing_force", "N", {3}, true},
                      {"/probes/right_20/bushing_torque", "N m", {3}, true},
                      {"/probes/right_20/bushing_deflection", "m, rad", {6}, true}}};
  for (const std::string& partner : partners())
    table.channels.push_back({"/probes/right_20/contact_force/" + partner, "N", {3}, true});
  return table;
}

std::vector<double> probe_row(const Motion& motion, double t) {
  const double sense = motion.options.turn ? -1.0 : 1.0, upper = 5e4 + 300.0 * motion.omega(t);
  std::vector<double> row{t,
                          motion.torque(t),
                          sense * motion.torque(t),
                          upper,
                          0.98 * upper,
                          5e4 + 2e4 * std::sin(3.0 * t) + 5e3 * std::sin(440.0 * t),
                          0.0,
                          0.0};
  const double twist = 0.2 * std::sin(3.0 * t);
  row.insert(row.end(), {0.0, 2e3 * twist + 50.0 * std::cos(3.0 * t), 0.0});
  row.insert(row.end(), {row[5] / 1.5e8, 0.0, 0.0, 0.0, twist, 0.0});
  const double lap = motion.angle(t) / 40.0;
  for (std::size_t i = 0; i < partners().size(); ++i) {
    const double phase = std::fmod(lap + static_cast<double>(i) / 6.0, 1.0);
    row.insert(row.end(), {0.0, 0.0, phase < 0.16 ? 4e4 * std::pow(std::sin(60.0 * phase), 2) : 0.0});
  }
  return row;
}

RunSummary summary_of(const RunOptions& options) {
  RunSummary s;
  s.name = options.name;
  s.vehicle_name = options.vehicle_name;
  s.bushing_name = "mock bushing";
  s.simulated_time = options.duration;
  s.wall_time = 0.31 * options.duration;
  s.assembly_wall_time = 2.5;
  s.counts = {189, 36, 152, 954, 2};
  s.steps = {151234, 812, 152046, 3.1e-5, 1.13e-4 / std::sqrt(options.bushing_scale), 2.0e-4};
  s.status = options.failure.empty() ? RunStatus::completed : RunStatus::failed;
  s.message = options.failure;
  s.energy = {7.1e6, 7.05e6, 310.0, 8.1e-5};
  s.results = {
      {"cruise_speed_m_per_s", 13.98, "m/s", "mean cruise speed"},
      {"distance_m", 140.2, "m", "distance"},
      {"largest_tension_N", 178.8e3 * std::pow(options.bushing_scale, 0.25), "N", "in any bushing at any step"},
      {"bushing_torsion_rms_rad", options.double_pin ? 0.05 : 0.1, "rad", "twist of one bushing"},
      {"bushing_x_largest_over_identified", 1.5 / options.bushing_scale, "1", "largest over identified"},
      {"mean_contacts_sprocket_flank_driving", 9.5, "1", "mean number of contacts of this case"},
      {"mean_contacts_guide_top", 0.0, "1", "mean number of contacts of this case"},
      {"mean_step_s", s.steps.mean, "s", "mean accepted step"}};
  s.checks = {{"Mean cruise speed", 13.98, "m/s", "within 3 % of 13.89 m/s", true},
              {"Energy residual of ∫|P| dt", 8.1e-5, "1", "under 1e-3", !options.failing_check}};
  s.provenance.version = "0.1.0";
  s.provenance.command = "grouser simulate scenarios/mock.json -o mock";
  s.provenance.inputs = {{"scenario", "scenarios/mock.json", std::string(64, 'a')},
                         {"vehicle", "mock.json", std::string(64, 'b')}};
  s.provenance.options = {{"integrator.beta", "1.03"}};
  s.provenance.synthetic = {"Mock data, made up for a test, seed 1."};
  return s;
}

}  // namespace

void write_run(const std::filesystem::path& folder, const RunOptions& options) {
  write_inputs(folder, options);
  const Motion motion{options, {}};
  std::vector<ChannelTable> tables{sample_table(options),
                                   {"steps",
                                    {{"/steps/time", "s", {}, false},
                                     {"/steps/size", "s", {}, false},
                                     {"/steps/error", "1", {}, false},
                                     {"/steps/limit", "1", {}, false}}}};
  if (options.probes) tables.push_back(probe_table());
  RunWriter writer(
      folder / "run.h5", tables,
      {{"/joints/names", joint_names()}, {"/steps/limit_names", {"max_step", "stability", "error", "growth"}}});
  for (double t = 0.0; t <= options.duration; t += 1.0 / options.rate) writer.append(0, sample_row(motion, t));
  double h = 1e-4;
  for (double t = 0.0; t < options.duration; t += h) {
    h = 1.3e-4 - 2e-5 * motion.omega(t) / 45.0 + 1e-5 * std::sin(900.0 * t);
    writer.append(1, std::array{t, h, 0.3, std::floor(std::fmod(37.0 * t, 4.0))});
  }
  if (options.probes)
    for (double t = 0.0; t <= options.duration; t += 1.0 / 2000.0) writer.append(2, probe_row(motion, t));
  writer.close();
  write_run_summary(summary_of(options), folder / "run.json");
}

}  // namespace grouser::mock
