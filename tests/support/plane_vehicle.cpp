#include "tests/support/plane_vehicle.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace grouser::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr int k_x = 0, k_rise = 1, k_pitch = 2, k_first_arm = 3;
constexpr double k_step = 1e-4;  // m or rad, of the central differences: their error is 1e-6 of a curvature here

Vector2d in_plane(const Vector3d& v) { return {v.x(), v.z()}; }

/// Turns (x, z) by an angle about +y.
Vector2d turn(double angle, const Vector2d& v) {
  return {v.x() * std::cos(angle) + v.y() * std::sin(angle), v.y() * std::cos(angle) - v.x() * std::sin(angle)};
}

/// Where a point of the hull, given in V, stands.
Vector2d place(const VectorXd& y, const Vector2d& p_V) { return Vector2d(y[k_x], y[k_rise]) + turn(y[k_pitch], p_V); }

struct Circle {
  Vector2d center;
  double tangent_radius, wrap_radius;
  bool road_wheel;
};

double bar_energy(const Station& station, double bump) {
  const Vector2d arm = in_plane(station.wheel.center - station.pivot);
  const double below = std::atan2(-arm.y(), std::abs(arm.x())) - bump;
  const double twist = station.torsion_bar.free_angle - below;
  return 0.5 * station.torsion_bar.stiffness * twist * twist;
}

double gas_energy(const Hydropneumatic& unit, double bump) {
  const auto reach = [&](double phi) {
    const double side = unit.crank_radius * std::sin(phi);
    return unit.crank_radius * std::cos(phi) + std::sqrt(unit.rod_length * unit.rod_length - side * side);
  };
  const double n = unit.polytropic_exponent;
  const double volume = unit.gas_volume - unit.piston_area * (reach(unit.crank_angle) - reach(unit.crank_angle + bump));
  const double charge = unit.gas_pressure * std::pow(unit.gas_volume, n);
  constexpr double k_atmosphere = 1e5;  // Pa
  return charge * std::pow(volume, 1.0 - n) / (n - 1.0) + k_atmosphere * volume;
}

/// Force of a wheel pressed into plate and ground by `depth` in all: F = a u^(3/2) on the plate, F = b (depth - u).
struct Press {
  double force = 0.0, energy = 0.0;
};
Press press(const DiscPair& wheel, const Track& track, double depth) {
  if (depth <= 0.0) return {};
  // k int (u - s^2 / 2R) ds over the patch of one disc, two discs
  const double a = 2.0 * wheel.contact.stiffness * 4.0 / 3.0 * std::sqrt(2.0 * wheel.radius);
  const double b = track.ground_contact.stiffness * static_cast<double>(track.ground_points.size());
  double u = 0.5 * depth;
  for (int i = 0; i < 40; ++i)
    u -= (a * std::pow(u, 1.5) - b * (depth - u)) / (1.5 * a * std::sqrt(std::max(u, 1e-12)) + b);
  const double force = b * (depth - u);
  return {force, 0.4 * a * std::pow(u, 2.5) + 0.5 * force * force / b};
}

/// Hessian of a function by central differences.
MatrixXd curvature(const std::function<double(const VectorXd&)>& f, const VectorXd& y) {
  const Eigen::Index n = y.size();
  MatrixXd h(n, n);
  const auto at = [&](Eigen::Index i, double di, Eigen::Index j, double dj) {
    VectorXd moved = y;
    moved[i] += di;
    moved[j] += dj;
    return f(moved);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      h(i, j) = h(j, i) = (at(i, k_step, j, k_step) - at(i, k_step, j, -k_step) - at(i, -k_step, j, k_step) +
                           at(i, -k_step, j, -k_step)) /
                          (4.0 * k_step * k_step);
    }
  }
  return h;
}

VectorXd slope(const std::function<double(const VectorXd&)>& f, const VectorXd& y) {
  VectorXd g(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    VectorXd up = y, down = y;
    up[i] += k_step;
    down[i] -= k_step;
    g[i] = (f(up) - f(down)) / (2.0 * k_step);
  }
  return g;
}

}  // namespace

PlaneVehicle::PlaneVehicle(Vehicle vehicle, double joint_stiffness, double gravity)
    : vehicle_(std::move(vehicle)),
      joint_stiffness_(joint_stiffness),
      gravity_(gravity),
      num_stations_(static_cast<int>(gear().stations.size())) {}

std::vector<PlaneVehicle::Body> PlaneVehicle::bodies(const VectorXd& y) const {
  std::vector<Body> all;
  const auto add = [&](const MassProperties& body, double count, const Vector2d& at, double angle) {
    all.push_back({count * body.mass, count * body.inertia.y(), at.x(), at.y(), angle});
  };
  const double pitch = y[k_pitch];
  add(vehicle_.chassis, 1.0, place(y, in_plane(vehicle_.chassis.center_of_mass)), pitch);
  for (int i = 0; i < num_stations_; ++i) {
    const Station& station = gear().stations[static_cast<std::size_t>(i)];
    const Vector2d pivot = in_plane(station.pivot);
    const double angle = y[k_first_arm + i];
    add(station.arm, 2.0, place(y, pivot + turn(angle, in_plane(station.arm.center_of_mass))), pitch + angle);
    // Without friction nothing turns a wheel.
    add(station.wheel.body, 2.0, place(y, pivot + turn(angle, in_plane(station.wheel.center) - pivot)), 0.0);
  }
  const Vector2d pivot = in_plane(gear().idler.pivot);
  const double angle = y[k_first_arm + num_stations_];
  add(gear().idler.arm, 2.0, place(y, pivot + turn(angle, in_plane(gear().idler.arm.center_of_mass))), pitch + angle);
  add(gear().idler.wheel.body, 2.0, place(y, pivot + turn(angle, in_plane(gear().idler.wheel.center) - pivot)), 0.0);
  for (const DiscPair& roller : gear().support_rollers) add(roller.body, 2.0, place(y, in_plane(roller.center)), 0.0);
  add(gear().sprocket.body, 2.0, place(y, in_plane(gear().sprocket.center)), pitch);
  return all;
}

/// The loop runs forward along the ground, up in front and back above.
PlaneVehicle::Belt PlaneVehicle::belt(const VectorXd& y) const {
  const Track& track = gear().track;
  std::vector<Circle> circles;
  const auto add = [&](const DiscPair& wheel, const Vector2d& center, bool road_wheel) {
    const double line = wheel.radius + track.wheel_path_height;
    circles.push_back({center, line, track.pitch / (2.0 * std::atan(track.pitch / (2.0 * line))), road_wheel});
  };
  for (int i = num_stations_ - 1; i >= 0; --i) {
    const Station& station = gear().stations[static_cast<std::size_t>(i)];
    const Vector2d pivot = in_plane(station.pivot);
    add(station.wheel, place(y, pivot + turn(y[k_first_arm + i], in_plane(station.wheel.center) - pivot)), true);
  }
  const Vector2d pivot = in_plane(gear().idler.pivot);
  add(gear().idler.wheel,
      place(y, pivot + turn(y[k_first_arm + num_stations_], in_plane(gear().idler.wheel.center) - pivot)), false);
  for (const DiscPair& roller : gear().support_rollers) add(roller, place(y, in_plane(roller.center)), false);
  const double mean_radius = gear().sprocket.teeth * track.pitch / (2.0 * k_pi);
  circles.push_back({place(y, in_plane(gear().sprocket.center)), mean_radius, mean_radius, false});

  const std::size_t n = circles.size();
  std::vector<double> heading(n);
  Belt belt;
  for (std::size_t i = 0; i < n; ++i) {
    const Circle &a = circles[i], &b = circles[(i + 1) % n];
    const Vector2d d = b.center - a.center;
    const double less = a.tangent_radius - b.tangent_radius;
    heading[i] = std::atan2(d.y(), d.x()) + std::asin(less / d.norm());
    const double straight = std::sqrt(d.squaredNorm() - less * less);
    belt.length += straight;
    const double middle =
        0.5 * (a.center.y() + b.center.y()) - 0.5 * (a.tangent_radius + b.tangent_radius) * std::cos(heading[i]);
    // What lies on the ground neither hangs on the wheels nor rises with them.
    belt.moment += straight * (a.road_wheel && b.road_wheel ? track.ground_depth : middle);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Circle& c = circles[i];
    const double from = heading[(i + n - 1) % n], turned = std::remainder(heading[i] - from - 1.5, 2.0 * k_pi) + 1.5;
    belt.length += c.wrap_radius * turned;
    // integral of -R cos along the arc
    belt.moment += c.wrap_radius * (c.center.y() * turned - c.wrap_radius * (std::sin(from + turned) - std::sin(from)));
  }
  return belt;
}

/// The mean stretch gives the tension at the belt's mean height; above it the tension grows by the belt's weight.
double PlaneVehicle::upper_tension(const VectorXd& y) const {
  const Track& track = gear().track;
  const Belt line = belt(y);
  const double upper = gear().idler.wheel.center.z() + gear().idler.wheel.radius + track.wheel_path_height;
  const double weight_per_length = track.num_links * track.link.mass * gravity_ / line.length;
  return belt_stiffness() * (line.length - track.num_links * track.pitch) +
         weight_per_length * (upper - line.moment / line.length);
}

double PlaneVehicle::ground_load(const VectorXd& y, int i) const {
  const Station& station = gear().stations[static_cast<std::size_t>(i)];
  const Vector2d pivot = in_plane(station.pivot);
  const Vector2d wheel = place(y, pivot + turn(y[k_first_arm + i], in_plane(station.wheel.center) - pivot));
  const Track& track = gear().track;
  return press(station.wheel, track, station.wheel.radius + track.wheel_path_height + track.ground_depth - wheel.y())
      .force;
}

double PlaneVehicle::potential(const VectorXd& y, const Setting& setting) const {
  const Track& track = gear().track;
  double energy = 0.0;
  for (const Body& body : bodies(y)) energy += body.mass * gravity_ * body.z;
  for (int i = 0; i < num_stations_; ++i) {
    const Station& station = gear().stations[static_cast<std::size_t>(i)];
    const double bump = station.wheel.center.x() <= station.pivot.x() ? y[k_first_arm + i] : -y[k_first_arm + i];
    energy += 2.0 * (station.kind == SuspensionKind::torsion_bar ? bar_energy(station, bump)
                                                                 : gas_energy(station.hydropneumatic, bump));
    const Vector2d pivot = in_plane(station.pivot);
    const Vector2d wheel = place(y, pivot + turn(y[k_first_arm + i], in_plane(station.wheel.center) - pivot));
    const double depth = station.wheel.radius + track.wheel_path_height + track.ground_depth - wheel.y();
    energy += 2.0 * press(station.wheel, track, depth).energy;
  }
  const double stretch = y[k_first_arm + num_stations_] - setting.tensioner.free;
  energy += setting.tensioner.stiffness * stretch * stretch;  // both sides
  const Belt line = belt(y);
  const double longer = line.length - track.num_links * track.pitch;
  const double mean_height = line.moment / line.length, mass = 2.0 * track.num_links * track.link.mass;
  const double speed = setting.link_rate * line.length / track.num_links;
  return energy + belt_stiffness() * longer * longer + mass * (gravity_ * mean_height - 0.5 * speed * speed);
}

VectorXd PlaneVehicle::settle(VectorXd y, const Setting& setting) const {
  const auto energy = [&](const VectorXd& at) { return potential(at, setting); };
  const Eigen::Index n = y.size() - 1;  // surge is free
  for (int i = 0; i < 60; ++i) {
    VectorXd change = curvature(energy, y).bottomRightCorner(n, n).fullPivLu().solve(slope(energy, y).tail(n));
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > 0.02) change *= 0.02 / largest;
    y.tail(n) -= change;
    if (largest < 1e-10) break;
  }
  return y;
}

PlaneVehicle::Rest PlaneVehicle::stand(double tension, double stiffness) const {
  const double arm = (gear().idler.wheel.center - gear().idler.pivot).norm();
  Rest rest;
  rest.y = VectorXd::Zero(k_first_arm + num_stations_ + 1);
  rest.tensioner.stiffness = stiffness * arm * arm;
  double before = 0.0, excess_before = 0.0;
  for (int i = 0; i < 60; ++i) {  // secant on the tensioner's free angle
    rest.y = settle(rest.y, {rest.tensioner, 0.0});
    const double excess = upper_tension(rest.y) - tension;
    if (std::abs(excess) < 1e-3) break;
    const double newton = i == 0 ? 1e-3 : -excess * (rest.tensioner.free - before) / (excess - excess_before);
    const double change = std::clamp(newton, -0.02, 0.02);
    before = rest.tensioner.free;
    excess_before = excess;
    rest.tensioner.free += change;
  }
  for (int i = 0; i < num_stations_; ++i) rest.ground_loads.push_back(ground_load(rest.y, i));
  return rest;
}

/// The track as bodies: the ground run, which only slides; the upper run; the rest at idler and sprocket.
std::vector<PlaneVehicle::Body> PlaneVehicle::track_bodies(const VectorXd& y) const {
  const RunningGear& g = gear();
  const double per_length = 2.0 * g.track.num_links * g.track.link.mass / belt(y).length;
  const double ground = g.stations.front().wheel.center.x() - g.stations.back().wheel.center.x();
  const Vector2d idler = in_plane(g.idler.wheel.center), sprocket = in_plane(g.sprocket.center);
  const double upper = idler.x() - sprocket.x(), end = 0.5 * per_length * (belt(y).length - ground - upper);
  const Vector2d above(0.5 * (idler.x() + sprocket.x()), idler.y() + g.idler.wheel.radius + g.track.wheel_path_height);
  const Vector2d run = place(y, above), front = place(y, idler), rear = place(y, sprocket);
  return {{per_length * ground, 0.0, y[k_x], 0.0, 0.0},
          {per_length * upper, per_length * upper * upper * upper / 12.0, run.x(), run.y(), y[k_pitch]},
          {end, 0.0, front.x(), front.y(), 0.0},
          {end, 0.0, rear.x(), rear.y(), 0.0}};
}

MatrixXd PlaneVehicle::mass_matrix(const VectorXd& y) const {
  const auto positions = [&](const VectorXd& at) {  // columns x, z, angle; a row a body
    std::vector<Body> all = bodies(at);
    const std::vector<Body> track = track_bodies(at);
    all.insert(all.end(), track.begin(), track.end());
    Eigen::MatrixX3d p(static_cast<Eigen::Index>(all.size()), 3);
    Eigen::MatrixX3d m = p;
    for (std::size_t b = 0; b < all.size(); ++b) {
      p.row(static_cast<Eigen::Index>(b)) << all[b].x, all[b].z, all[b].angle;
      m.row(static_cast<Eigen::Index>(b)) << all[b].mass, all[b].mass, all[b].inertia;
    }
    return std::pair(p, m);
  };
  const Eigen::Index n = y.size();
  std::vector<Eigen::MatrixX3d> rate;
  for (Eigen::Index i = 0; i < n; ++i) {
    VectorXd up = y, down = y;
    up[i] += k_step;
    down[i] -= k_step;
    rate.emplace_back((positions(up).first - positions(down).first) / (2.0 * k_step));
  }
  const Eigen::MatrixX3d inertia = positions(y).second;
  MatrixXd mass(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::MatrixX3d &a = rate[static_cast<std::size_t>(i)], &b = rate[static_cast<std::size_t>(j)];
      mass(i, j) = (a.array() * b.array() * inertia.array()).sum();
    }
  }
  return mass;
}

std::vector<PlaneVehicle::Mode> PlaneVehicle::modes(const Rest& rest, double stiffness) const {
  const Setting setting{exchanged(rest, stiffness), 0.0};
  const MatrixXd k = curvature([&](const VectorXd&at) { return potential(at, setting); }, rest.y),
                 m = mass_matrix(rest.y);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(k, m);
  std::vector<Mode> found;
  for (Eigen::Index i = 1; i < k.rows(); ++i) {  // 0: the surge
    const VectorXd shape = solver.eigenvectors().col(i);
    found.push_back({std::sqrt(solver.eigenvalues()[i]) / (2.0 * k_pi), shape, m * shape});
  }
  return found;
}

PlaneVehicle::Tensioner PlaneVehicle::exchanged(const Rest& rest, double stiffness) const {
  const double lever = (gear().idler.wheel.center - gear().idler.pivot).norm(), angle = rest.y[rest.y.size() - 1];
  const double turning = stiffness * lever * lever;
  return {turning, angle - rest.tensioner.stiffness * (angle - rest.tensioner.free) / turning};
}

double PlaneVehicle::running_tension(const Rest& rest, double stiffness, double link_rate) const {
  return upper_tension(settle(rest.y, {exchanged(rest, stiffness), link_rate}));
}

}  // namespace grouser::test
