#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/geometry.h"
#include "model/provenance.h"

/// The vehicle as data (vehicle.json). All positions are in the vehicle frame V at design: x forward, y left, z up,
/// origin at mid-wheelbase, ground level, centre plane. Every rotation axis is V's y axis. SI and radians.
namespace grouser {

/// Mass, centre of mass and principal inertia about it, axes parallel to V at design.
struct MassProperties {
  double mass = 0.0;                           ///< kg, > 0
  Vector3d center_of_mass = Vector3d::Zero();  ///< m; relative to the body's own origin (chassis: in V)
  Vector3d inertia = Vector3d::Zero();         ///< kg m^2 (xx, yy, zz)
};

/// Normal law f = k delta (1 + a delta_dot), continuous at touch-down; `a` follows from the restitution.
struct ContactLaw {
  double stiffness = 0.0;               ///< N/m (point, per disc or ring) or N/m^2 (disc foundation)
  double restitution = 0.835;           ///< at `restitution_speed`, 0..1
  double restitution_speed = 1.0;       ///< m/s
  double friction = 0.0;                ///< coefficient, >= 0
  double friction_speed = 0.1;          ///< m/s, speed at which sliding friction is developed (0.707 of mu N)
  double friction_damping_limit = 2e4;  ///< N s/m, largest slope of the friction law (keeps the explicit step)
};

/// Two rigidly joined discs (road wheel, idler, support roller), turning about y.
struct DiscPair {
  MassProperties body;
  Vector3d center = Vector3d::Zero();  ///< m, in V
  double radius = 0.0;                 ///< m
  double disc_width = 0.0;             ///< m, each
  double gap = 0.0;                    ///< m, between the discs (the centre guide runs here)
  ContactLaw contact;                  ///< against the link's wheel path; stiffness in N/m^2 of path length, per disc
};

enum class SuspensionKind { torsion_bar, hydropneumatic };

/// M = stiffness (free_angle - angle) - damping * rate, angle below horizontal.
struct TorsionBar {
  double stiffness = 0.0;   ///< N m/rad
  double free_angle = 0.0;  ///< rad below horizontal at which the bar is unloaded
  double damping = 0.0;     ///< N m s/rad
};

/// Gas spring driven by the arm through a slider-crank, orifice damping with blow-off.
struct Hydropneumatic {
  double piston_area = 0.0;   ///< m^2
  double crank_radius = 0.0;  ///< m
  double rod_length = 0.0;    ///< m
  double crank_angle = 0.0;   ///< rad, crank against the cylinder axis at the design arm angle (90 deg: full leverage)
  double gas_volume = 0.0;    ///< m^3 at the design arm angle
  double gas_pressure = 0.0;  ///< Pa absolute at the design arm angle
  double polytropic_exponent = 1.3;
  double gas_charge_temperature = 293.15;  ///< K, at which volume and pressure are given
  double gas_temperature = 293.15;         ///< K, of the gas at rest in this run
  double orifice_area = 0.0;               ///< m^2, discharge coefficient included
  double oil_density = 870.0;              ///< kg/m^3
  double blow_off_pressure = 0.0;          ///< Pa across the orifice
  double blow_off_area = 0.0;              ///< m^2 per Pa above it, discharge coefficient included
  double linear_damping = 0.0;             ///< N m s/rad (seals, bleed)
};

/// One suspension station: trailing (or leading) arm with its wheel.
struct Station {
  Vector3d pivot = Vector3d::Zero();  ///< m, arm pivot in V; y = track centre
  MassProperties arm;                 ///< centre of mass relative to the pivot, at design
  DiscPair wheel;                     ///< its centre is the arm's end at design
  SuspensionKind kind = SuspensionKind::torsion_bar;
  TorsionBar torsion_bar;
  Hydropneumatic hydropneumatic;
  double bump_angle = 0.55;     ///< rad of arm rotation up from design where the bump stop begins
  double rebound_angle = 0.35;  ///< rad down from design
  double stop_stiffness = 1e6;  ///< N m/rad
};

/// Idler on its arm with a tensioner acting between chassis and idler centre.
struct Idler {
  Vector3d pivot = Vector3d::Zero();
  MassProperties arm;
  DiscPair wheel;
  double tensioner_stiffness = 0.0;  ///< N/m at the idler centre, tangential to the arm
  double tensioner_damping = 0.0;    ///< N s/m
};

/// Toothed wheel: two rings of teeth; per tooth a top, two flanks (root fillet included) and two sides; base circle
/// inside.
struct Sprocket {
  MassProperties body;
  Vector3d center = Vector3d::Zero();
  int teeth = 10;
  double tip_radius = 0.0;      ///< m
  double base_radius = 0.0;     ///< m
  double flank_angle = 0.0;     ///< rad, against the gap's radial line
  double seat_clearance = 0.0;  ///< m, seat fillet radius less pin radius
  double ring_offset = 0.0;     ///< m, lateral position of each ring from the track centre
  double side_clearance = 0.0;  ///< m, lateral play before a tooth side touches
  double side_stiffness = 2e7;  ///< N/m
  ContactLaw contact;           ///< pins on teeth; stiffness per joint (both rings)
};

enum class Connection { single_pin, double_pin };

/// What joins two shoes of a double-pin track: the end connectors and the centre connector of a joint, and its two
/// pins, as one rigid body. Frame: x from pin to pin, origin half way.
struct Connector {
  double length = 0.0;                  ///< m, between its pins, > 0 and below the pitch
  bool condensed = true;                ///< massless, placed by the balance of its bushings; else a body of its own
  double mass = 0.0;                    ///< kg, part of the link's; > 0 for a body
  Vector3d inertia = Vector3d::Zero();  ///< kg m^2 (xx, yy, zz), part of the link's
};
/// What connectors add to a link's inertia when half of one is fixed to either end, p / 2 from the link's centre
/// [kg m^2].
[[nodiscard]] inline Vector3d lumped_inertia(const Connector& connector, double pitch) {
  const double carried = 0.25 * connector.mass * pitch * pitch;
  return connector.inertia + Vector3d(0.0, carried, carried);
}

/// A track of identical links; all dimensions in the link frame L (origin at the centre of mass, x towards the next
/// joint).
struct Track {
  int num_links = 0;
  double pitch = 0.0;   ///< m
  MassProperties link;  ///< of a whole pitch, connectors included
  Connection connection = Connection::single_pin;
  Connector connector;                  ///< double_pin only
  double pin_radius = 0.0;              ///< m, where the sprocket drives
  double shoe_width = 0.0;              ///< m
  double ground_depth = 0.0;            ///< m, pin axis to ground face
  double wheel_path_height = 0.0;       ///< m, pin axis to the wheels' path
  std::vector<Vector3d> ground_points;  ///< m, in L; six: two pads x three
  ContactLaw ground_contact;  ///< stiffness per point; friction with the ground comes from the scenario's terrain
  double ground_bristle_stiffness = 2.5e6;  ///< N/m per point, tangential
  double ground_bristle_damping = 1e3;      ///< N s/m per point
  double guide_height = 0.0;                ///< m, centre guide above the wheel path
  double guide_base_width = 0.0;            ///< m, full, at the wheel path
  double guide_top_width = 0.0;             ///< m
  double guide_stiffness = 2e7;             ///< N/m
  double guide_restitution = 0.835;         ///< at 1 m/s
  double pre_tension = 0.0;                 ///< N, mean of the upper run, THIS track, at rest
  double pre_torsion = 0.0;                 ///< rad per joint, > 0 = unloaded when wrapped inward
  double clearance = 0.0;                   ///< m, radial play of every (worn) bushing before its rubber engages
  std::optional<double> stop_angle;         ///< rad, back-bending of every hinge at which its stop begins
  double stop_stiffness = 2e5;              ///< N m/rad, of the stop
  std::string bushing;                      ///< optional path overriding the scenario's bushing for this track
};

struct RunningGear {
  double track_center_y = 0.0;  ///< m
  Sprocket sprocket;
  Idler idler;
  std::vector<DiscPair> support_rollers;
  std::vector<Station> stations;  ///< front to rear
  Track track;
};

/// Picture only; never physics.
struct VisualPart {
  std::string name;
  std::string color;              ///< "#6b7f4a"
  std::vector<Vector3d> outline;  ///< m, closed polygon in V's x-z plane (y ignored)
  double half_width = 0.0;        ///< m, extruded over y in [-half_width, half_width]
  double taper = 0.0;             ///< m, taken off the half width at the polygon's top
};
struct VisualTube {
  std::string name, color;
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  double radius = 0.0;
};

struct Vehicle {
  std::string name;
  MassProperties chassis;
  std::array<RunningGear, k_num_sides> sides;  ///< index_of(Side)
  std::vector<VisualPart> visual_parts;
  std::vector<VisualTube> visual_tubes;
  Provenance provenance;

  [[nodiscard]] const RunningGear& side(Side s) const { return sides[static_cast<std::size_t>(index_of(s))]; }
  [[nodiscard]] RunningGear& side(Side s) { return sides[static_cast<std::size_t>(index_of(s))]; }
};

/// Reads `grouser.vehicle/1`; throws InputError with every finding (units, keys, positivity, triangle inequality of
/// inertia).
[[nodiscard]] Vehicle read_vehicle(const std::filesystem::path& file);

}  // namespace grouser
