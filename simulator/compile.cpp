#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "simulator/lanes.h"
#include "simulator/stability.h"
#include "simulator/system.h"

namespace grouser {
namespace {

CompiledContact compile_contact(const ContactLaw& law) {
  return {law.stiffness, rate_coefficient(law.restitution, law.restitution_speed), law.friction, law.friction_speed,
          law.friction_damping_limit};
}

TreeBody make_body(const std::string& name, int parent, const Vector3d& origin, const MassProperties& properties) {
  TreeBody body;
  body.name = name;
  body.parent = parent;
  body.origin = origin;
  body.mass = properties.mass;
  body.center_of_mass = properties.center_of_mass;
  body.inertia = properties.inertia.asDiagonal();
  return body;
}

CompiledDiscs compile_discs(const DiscPair& pair, int body, Partner partner) {
  CompiledDiscs discs;
  discs.body = body;
  discs.partner = partner;
  discs.radius = pair.radius;
  discs.disc_offset = 0.5 * (pair.gap + pair.disc_width);
  discs.half_gap = 0.5 * pair.gap;
  discs.contact = compile_contact(pair.contact);
  return discs;
}

CompiledSuspension compile_station(const Station& station, int body, Side side) {
  CompiledSuspension spring;
  const Vector3d arm = station.wheel.center - station.pivot;
  spring.body = body;
  spring.side = side;
  spring.kind = station.kind == SuspensionKind::torsion_bar ? JointSpring::torsion_bar : JointSpring::hydropneumatic;
  spring.bump_sign = arm.x() <= 0.0 ? 1.0 : -1.0;
  spring.design_angle = std::atan2(-arm.z(), std::abs(arm.x()));
  spring.bar = station.torsion_bar;
  spring.unit = station.hydropneumatic;
  spring.bump_angle = station.bump_angle;
  spring.rebound_angle = station.rebound_angle;
  spring.stop_stiffness = station.stop_stiffness;
  return spring;
}

/// Corner where the straight flank reaches the tip circle, by bisection along the flank.
void find_flank_corner(CompiledSprocket& sprocket) {
  double low = 0.0, high = sprocket.tip_radius;
  for (int i = 0; i < 80; ++i) {
    const double x = 0.5 * (low + high);
    const double y = (sprocket.seat_radius + x * sprocket.flank_sin) / sprocket.flank_cos;
    (std::hypot(sprocket.seat_center + x, y) < sprocket.tip_radius ? low : high) = x;
  }
  sprocket.corner_x = sprocket.seat_center + low;
  sprocket.corner_y = (sprocket.seat_radius + low * sprocket.flank_sin) / sprocket.flank_cos;
}

CompiledSprocket compile_sprocket(const Sprocket& from, const Track& track, int body) {
  CompiledSprocket sprocket;
  sprocket.body = body;
  sprocket.teeth = from.teeth;
  for (int gap = 0; gap < from.teeth; ++gap) {
    const double angle = 2.0 * k_pi * gap / from.teeth;
    sprocket.gaps.push_back({std::cos(angle), std::sin(angle)});
  }
  sprocket.pitch_radius = track.pitch / (2.0 * std::sin(k_pi / from.teeth));
  sprocket.tip_radius = from.tip_radius;
  sprocket.base_radius = from.base_radius;
  sprocket.pin_radius = track.pin_radius;
  sprocket.seat_radius = track.pin_radius + from.seat_clearance;
  sprocket.seat_center = sprocket.pitch_radius + from.seat_clearance;
  sprocket.flank_sin = std::sin(from.flank_angle);
  sprocket.flank_cos = std::cos(from.flank_angle);
  sprocket.ring_offset = from.ring_offset;
  sprocket.side_clearance = from.side_clearance;
  sprocket.side_stiffness = from.side_stiffness;
  sprocket.contact = compile_contact(from.contact);
  sprocket.contact.stiffness *= 0.5;
  find_flank_corner(sprocket);
  return sprocket;
}

CompiledAxis compile_axis(const AxisLaw& law, int& stop_row, int& branch_row) {
  CompiledAxis axis;
  axis.spring = compile_spring(law.spring);
  axis.stops = law.stops;
  for (const FrictionStop& stop : law.stops) axis.stop_stiffness += stop.stiffness;
  axis.yield_growth = law.yield_growth;
  axis.branches = law.branches;
  axis.relaxation_rate.assign((law.branches.size() + k_lanes - 1) / k_lanes, 0.0);
  for (std::size_t m = 0; m < law.branches.size(); ++m)
    axis.relaxation_rate[m / k_lanes].set(static_cast<int>(m % k_lanes), 1.0 / law.branches[m].relaxation_time);
  axis.viscous = law.viscous;
  axis.first_stop = stop_row;
  axis.first_branch = branch_row;
  stop_row += static_cast<int>(law.stops.size());
  branch_row += static_cast<int>(law.branches.size());
  return axis;
}

void compile_bushing(const Bushing& bushing, CompiledTrack& track) {
  int stop_row = 0, branch_row = 0;
  for (std::size_t a = 0; a < k_num_axes; ++a) {
    track.bushing[a] = compile_axis(bushing.axes[a], stop_row, branch_row);
  }
}

/// Rows that the rubber of this track needs in the arrays of a System.
void reserve_rubber(const CompiledTrack& track, System& system) {
  const CompiledAxis& last = track.bushing.back();
  system.num_stop_rows = std::max(system.num_stop_rows, last.first_stop + static_cast<int>(last.stops.size()));
  system.num_branch_rows = std::max(system.num_branch_rows, last.first_branch + static_cast<int>(last.branches.size()));
}

void compile_joints(const Track& from, CompiledTrack& track) {
  track.groove = 0.5 * from.pitch;
  track.free_twist = -from.pre_torsion;  // wrapping inward turns link i+1 by a negative angle about +y
  track.clearance = from.clearance;
  if (from.stop_angle) track.stop_angle = *from.stop_angle;
  track.stop_stiffness = from.stop_stiffness;
  if (from.connection == Connection::single_pin) return;
  track.joint = from.connector.condensed ? JointForm::double_pin : JointForm::connector_bodies;
  track.connector_length = from.connector.length;
  track.groove -= 0.5 * from.connector.length;
  track.free_twist *= 0.5;  // stated for the joint, shared by its two bushings
}

CompiledTrack compile_track(const RunningGear& gear, Side side, const Bushing& bushing, int offset) {
  const Track& from = gear.track;
  CompiledTrack track;
  track.side = side;
  track.num_links = from.num_links;
  track.offset = offset;
  track.pitch = from.pitch;
  track.mass = from.link.mass;
  track.inertia = from.link.inertia;
  compile_joints(from, track);
  compile_bushing(bushing, track);
  track.wheel_path_height = from.wheel_path_height;
  track.ground_depth = from.ground_depth;
  track.half_width = 0.5 * from.shoe_width;
  track.guide_height = from.guide_height;
  track.guide_half_base = 0.5 * from.guide_base_width;
  track.guide_half_top = 0.5 * from.guide_top_width;
  track.guide = {from.guide_stiffness, rate_coefficient(from.guide_restitution, 1.0), 0.0, 0.1, 0.0};
  track.lateral = side == Side::left ? 1.0 : -1.0;
  track.ground_points = from.ground_points;
  // The same order on both sides when seen in a mirror.
  std::sort(track.ground_points.begin(), track.ground_points.end(), [&](const Vector3d& a, const Vector3d& b) {
    return std::pair(a.x(), track.lateral * a.y()) < std::pair(b.x(), track.lateral * b.y());
  });
  track.ground = compile_contact(from.ground_contact);
  track.bristle_stiffness = from.ground_bristle_stiffness;
  track.bristle_damping = from.ground_bristle_damping;
  track.pre_tension = from.pre_tension;
  return track;
}

/// Room for connectors behind both tracks' links, and the bodies that every track is made of. A connector that is a
/// body takes its mass from the two link ends that the condensed form lumps it into.
void add_connectors(System& system) {
  for (CompiledTrack& track : system.tracks) {
    const Connector& connector = system.scenario.vehicle.side(track.side).track.connector;
    if (track.joint != JointForm::single_pin) {
      track.connector_offset = system.link_array_length;
      system.link_array_length += padded_length(track.num_links);
    }
    if (track.joint == JointForm::connector_bodies) {
      track.mass -= connector.mass;
      track.inertia -= lumped_inertia(connector, track.pitch);
    }
    track.bodies.push_back({track.offset, track.num_links, track.mass, track.inertia});
    if (track.joint == JointForm::connector_bodies) {
      track.bodies.push_back({track.connector_offset, track.num_links, connector.mass, connector.inertia});
    }
  }
}

void add_running_gear(System& system, const RunningGear& gear, Side side, const DriveTable& drive) {
  auto& bodies = system.tree.bodies;
  CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
  const std::string prefix = std::string(name_of(side)) + "/";
  const int first = static_cast<int>(bodies.size());
  const int num_stations = static_cast<int>(gear.stations.size());
  const Vector3d& center = system.chassis_center_V;
  for (int i = 0; i < num_stations; ++i) {
    const Station& station = gear.stations[static_cast<std::size_t>(i)];
    bodies.push_back(make_body(prefix + "arm_" + std::to_string(i + 1), -1, station.pivot - center, station.arm));
    system.suspension.push_back(compile_station(station, first + i, side));
  }
  for (int i = 0; i < num_stations; ++i) {
    const Station& station = gear.stations[static_cast<std::size_t>(i)];
    track.discs.push_back(compile_discs(station.wheel, static_cast<int>(bodies.size()), Partner::road_wheel));
    bodies.push_back(make_body(prefix + "wheel_" + std::to_string(i + 1), first + i,
                               station.wheel.center - station.pivot, station.wheel.body));
  }
  for (std::size_t i = 0; i < gear.support_rollers.size(); ++i) {
    const DiscPair& roller = gear.support_rollers[i];
    track.discs.push_back(compile_discs(roller, static_cast<int>(bodies.size()), Partner::support_roller));
    bodies.push_back(make_body(prefix + "roller_" + std::to_string(i + 1), -1, roller.center - center, roller.body));
  }
  const auto s = static_cast<std::size_t>(index_of(side));
  system.idler_arm_body[s] = static_cast<int>(bodies.size());
  const Vector3d arm = gear.idler.wheel.center - gear.idler.pivot;
  bodies.push_back(make_body(prefix + "idler_arm", -1, gear.idler.pivot - center, gear.idler.arm));
  CompiledSuspension tensioner;
  tensioner.body = system.idler_arm_body[s];
  tensioner.side = side;
  tensioner.kind = JointSpring::tensioner;
  tensioner.tensioner_stiffness = gear.idler.tensioner_stiffness * arm.squaredNorm();
  tensioner.tensioner_damping = gear.idler.tensioner_damping * arm.squaredNorm();
  system.suspension.push_back(tensioner);
  track.discs.push_back(compile_discs(gear.idler.wheel, static_cast<int>(bodies.size()), Partner::idler));
  bodies.push_back(make_body(prefix + "idler", system.idler_arm_body[s], arm, gear.idler.wheel.body));
  system.sprocket_body[s] = static_cast<int>(bodies.size());
  bodies.push_back(make_body(prefix + "sprocket", -1, gear.sprocket.center - center, gear.sprocket.body));
  bodies.back().prescribed = drive.kind == DriveKind::speed;
  track.sprocket = compile_sprocket(gear.sprocket, gear.track, system.sprocket_body[s]);
  track.speed_per_sprocket_rate = gear.sprocket.teeth * gear.track.pitch / (2.0 * k_pi);
  for (auto body = bodies.begin() + first; body != bodies.end(); ++body) body->mirror_group = index_of(side);
}

void share_contacts(const Tree& tree, CompiledTrack& track) {
  const double path = track.wheel_path_height, moving = 1.0 / track.mass;
  for (CompiledDiscs& discs : track.discs) {
    // Wheels carry most on two links, rollers on one, idlers on half a turn, whose middle weighs most on the spin.
    const double wrapped = discs.partner == Partner::idler        ? 2.0 * discs.radius / track.pitch
                           : discs.partner == Partner::road_wheel ? 2.0
                                                                  : 1.0;
    const double mobility = moving + path * path / track.inertia.y();
    discs.share = contact_share(tree, discs.body, discs.radius, mobility, wrapped);
  }
  const double wrapped = 0.5 * track.sprocket.teeth;
  track.sprocket.share = contact_share(tree, track.sprocket.body, track.sprocket.pitch_radius, moving, wrapped);
}

/// What of a link may touch a disc pair.
void find_reach(const CompiledTrack& track, CompiledDiscs& discs) {
  constexpr double k_deepest = 0.03;  // m of penetration, for the length of the patch
  const double patch = std::sqrt(2.0 * discs.radius * k_deepest);
  discs.reach_along = std::max(track.pitch, 0.5 * track.pitch + patch);
  discs.reach_up = discs.radius + std::max(track.wheel_path_height + track.guide_height, 0.0);
  discs.reach = std::hypot(discs.reach_along, discs.reach_up);
}

/// f(-x) = -f(x) over the whole curve, to the round-off of a file.
bool is_odd(const SpringSpline& spring) {
  constexpr double k_round_off = 1e-12;
  const std::size_t n = spring.displacement.size();
  const double reach = spring.displacement.back(), force = std::abs(spring.force.back());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = n - 1 - i;
    if (std::abs(spring.displacement[i] + spring.displacement[j]) > k_round_off * reach) return false;
    if (std::abs(spring.force[i] + spring.force[j]) > k_round_off * force) return false;
    if (std::abs(spring.slope[i] - spring.slope[j]) > k_round_off * std::abs(spring.slope[j])) return false;
  }
  return true;
}

/// The part of an odd curve over x >= 0, beginning with a knot at 0.
SpringSpline positive_half(const SpringSpline& spring) {
  SpringSpline half{{0.0}, {0.0}, {evaluate(spring, 0.0).slope}};
  const double reach = spring.displacement.back();
  for (std::size_t i = 0; i < spring.displacement.size(); ++i) {
    if (spring.displacement[i] <= 1e-9 * reach) continue;
    half.displacement.push_back(spring.displacement[i]);
    half.force.push_back(spring.force[i]);
    half.slope.push_back(spring.slope[i]);
  }
  return half;
}

}  // namespace

double rate_coefficient(double restitution, double speed) {
  if (restitution >= 1.0) return 0.0;
  const auto excess = [&](double av) {  // > 0: too little loss
    return std::log((1.0 + av) / (1.0 - restitution * av)) - (1.0 + restitution) * av;
  };
  // f has a root at 0; the wanted one lies between it and the pole at 1 / e.
  double low = 0.0, high = 1.0 / restitution * (1.0 - 1e-15);
  for (int i = 0; i < 200; ++i) {
    const double mid = 0.5 * (low + high);
    (excess(mid) < 0.0 ? low : high) = mid;
  }
  return 0.5 * (low + high) / speed;
}

CompiledSpring compile_spring(const SpringSpline& given) {
  const bool odd = is_odd(given);
  const SpringSpline from = odd ? positive_half(given) : given;
  const auto& x = from.displacement;
  std::vector<std::array<double, 6>> pieces;
  const auto add_piece = [&](std::size_t i, double c2, double c3) {
    pieces.push_back({x[i], from.force[i], from.slope[i], c2, c3, stored_energy(from, x[i])});
  };
  if (!odd) add_piece(0, 0.0, 0.0);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double width = x[i + 1] - x[i], secant = (from.force[i + 1] - from.force[i]) / width;
    const double s0 = from.slope[i], s1 = from.slope[i + 1];
    add_piece(i, (3.0 * secant - 2.0 * s0 - s1) / width, (s0 + s1 - 2.0 * secant) / (width * width));
  }
  add_piece(x.size() - 1, 0.0, 0.0);
  return {odd, LaneTable<6>(pieces)};
}

int padded_length(int num_links) { return (num_links + k_lanes - 1) / k_lanes * k_lanes + k_lanes; }

System compile(const Scenario& scenario) {
  System system;
  system.scenario = scenario;
  const Vehicle& vehicle = scenario.vehicle;
  system.chassis_center_V = vehicle.chassis.center_of_mass;
  system.tree.base_mass = vehicle.chassis.mass;
  system.tree.base_inertia = vehicle.chassis.inertia.asDiagonal();
  system.gravity_W = Vector3d(0.0, 0.0, -scenario.gravity);
  system.ground = GroundSurface(scenario.terrain,
                                vehicle.side(Side::left).track_center_y - vehicle.side(Side::right).track_center_y);
  double mass = vehicle.chassis.mass;
  for (const Side side : {Side::left, Side::right}) {
    const RunningGear& gear = vehicle.side(side);
    CompiledTrack& track = system.tracks[static_cast<std::size_t>(index_of(side))];
    track = compile_track(gear, side, scenario.bushing_of(side), system.link_array_length);
    track.law = &scenario.bushing_of(side) == &scenario.bushing_of(Side::left) ? Side::left : side;
    system.link_array_length += padded_length(track.num_links);
    add_running_gear(system, gear, side, scenario.drive[static_cast<std::size_t>(index_of(side))]);
    share_contacts(system.tree, track);
    for (CompiledDiscs& discs : track.discs) find_reach(track, discs);
    mass += track.num_links * track.mass;  // a link and its connector, whether that is a body or not
    reserve_rubber(track, system);
    // A bristle a point for the surface, and one more where half rounds stand on it.
    const std::size_t bristles = track.ground_points.size() * (system.ground.half_rounds().empty() ? 1 : 2);
    system.num_ground_rows = std::max(system.num_ground_rows, static_cast<int>(bristles));
  }
  add_connectors(system);
  for (const TreeBody& body : system.tree.bodies) mass += body.mass;
  system.weight = mass * scenario.gravity;
  return system;
}

System compile_joint(const Bushing& bushing) {
  System system;
  system.tracks.back().side = Side::right;
  CompiledTrack& track = system.tracks.front();
  track.num_links = 1;  // one joint, from link 0 to link 1
  compile_bushing(bushing, track);
  reserve_rubber(track, system);
  system.link_array_length = padded_length(track.num_links);
  return system;
}

int System::num_bushings() const {
  int count = 0;
  for (const CompiledTrack& track : tracks) count += (track.joint == JointForm::single_pin ? 1 : 2) * track.num_links;
  return count;
}
int System::num_link_bodies() const {
  int count = 0;
  for (const CompiledTrack& track : tracks) {
    for (const LinkBodies& bodies : track.bodies) count += bodies.count;
  }
  return count;
}
int System::num_bodies() const { return 1 + static_cast<int>(tree.bodies.size()) + num_link_bodies(); }
int System::num_degrees_of_freedom() const {
  const int base = tree.base_fixed ? 0 : 6;
  return base + num_revolute_joints() + 6 * num_link_bodies();
}
int System::num_prescribed() const {
  return static_cast<int>(
      std::count_if(tree.bodies.begin(), tree.bodies.end(), [](const TreeBody& b) { return b.prescribed; }));
}

std::string link_name(const System& system, int index) {
  for (const CompiledTrack& track : system.tracks) {
    for (const LinkBodies& bodies : track.bodies) {
      if (index < bodies.offset || index >= bodies.offset + bodies.count) continue;
      const char* kind = bodies.offset == track.offset ? "link " : "connector ";
      return kind + std::to_string(index - bodies.offset) + " of the " + name_of(track.side) + " track";
    }
  }
  return "the chassis";
}

std::vector<std::string> joint_names(const System& system) {
  std::vector<std::string> names;
  for (const TreeBody& body : system.tree.bodies) names.push_back(body.name);
  return names;
}

}  // namespace grouser
