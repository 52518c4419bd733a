#pragma once
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "model/ground_surface.h"
#include "model/scenario.h"
#include "simulator/lanes.h"
#include "simulator/tree.h"

/// Everything that does not change during a run, compiled from Vehicle + Bushing + Scenario.
namespace grouser {

/// Spring curve in pieces, force = c0 + u (c1 + u (c2 + u c3)) with u from a piece's beginning. The first piece holds
/// below its beginning too and the last one for ever, for the ends are straight.
struct CompiledSpring {
  bool odd = false;     ///< f(-x) = -f(x): the pieces cover x >= 0 and the sign is carried, exact in a mirror
  LaneTable<6> pieces;  ///< beginning [m or rad], c0 to c3, energy stored there [J] (zero at displacement 0)
};

/// One bushing axis as the step uses it (model/bushing_law.h).
struct CompiledAxis {
  CompiledSpring spring;
  std::vector<FrictionStop> stops;
  double stop_stiffness = 0.0;  ///< of all stops
  std::vector<MaxwellBranch> branches;
  std::vector<Lanes> relaxation_rate;  ///< 1/s, 1 / tau of the branches, eight a block; 0 behind the last
  double yield_growth = 0.0;           ///< 1/m^2 or 1/rad^2
  double viscous = 0.0;
  int first_stop = 0;    ///< row of the first stop in History::stop
  int first_branch = 0;  ///< row of the first branch in History::branch
};

/// Contact law with its rate coefficient a [s/m] solved from the restitution.
struct CompiledContact {
  double stiffness = 0.0;
  double rate = 0.0;  ///< a in f = k delta (1 + a delta_dot)
  double friction = 0.0;
  double friction_speed = 0.1;
  double friction_slope_limit = 2e4;
};

/// How the stability bound shares a contact between link and wheel (simulator/stability.h): factors of its slopes.
struct ContactShare {
  double link = 1.0, wheel = 0.0;
};

/// A disc pair that a track runs over.
enum class Partner { road_wheel, support_roller, idler, sprocket, guide, ground };
inline constexpr int k_num_partners = 6;
inline constexpr std::array<const char*, k_num_partners> k_partner_names{"road_wheel", "support_roller", "idler",
                                                                         "sprocket",   "guide",          "ground"};
struct CompiledDiscs {
  int body = 0;  ///< tree body
  Partner partner = Partner::road_wheel;
  double radius = 0.0;
  double disc_offset = 0.0;  ///< m, lateral position of each disc's middle
  double half_gap = 0.0;     ///< m
  // Where in the frame of a link the pair's centre stands when the link may touch it.
  double reach_along = 0.0, reach_up = 0.0;  ///< |x| and z at most [m]; z >= 0
  double reach = 0.0;                        ///< m, distance at most
  CompiledContact contact;
  ContactShare share;
};

/// The gap between two sprocket teeth in its own frame: X radial outwards through the gap's middle, Y tangential.
struct CompiledSprocket {
  int body = 0;
  int teeth = 10;
  std::vector<std::array<double, 2>> gaps;  ///< unit vectors (x, z) to the middles of the gaps, the first along x
  double pitch_radius = 0.0;
  double tip_radius = 0.0, base_radius = 0.0;
  double pin_radius = 0.0;
  double seat_radius = 0.0;  ///< fillet radius = pin radius + clearance
  double seat_center = 0.0;  ///< X of the fillet's centre
  double flank_sin = 0.0, flank_cos = 1.0;
  double corner_x = 0.0, corner_y = 0.0;  ///< where the flank meets the tip circle (Y > 0 side)
  double ring_offset = 0.0;
  double side_clearance = 0.0, side_stiffness = 0.0;
  CompiledContact contact;  ///< stiffness per ring
  ContactShare share;
};

/// How two links are joined.
enum class JointForm { single_pin, double_pin, connector_bodies };

/// Equal rigid bodies that stand one after the other in the link arrays.
struct LinkBodies {
  int offset = 0, count = 0;
  double mass = 0.0;
  Vector3d inertia = Vector3d::Zero();
};

struct CompiledTrack {
  Side side = Side::left;
  Side law = Side::left;  ///< the first side whose bushings are the same
  double lateral = 1.0;   ///< outwards along +-y: what comes in lateral pairs is worked through in this order
  int num_links = 0;
  int offset = 0;  ///< first element in the link arrays
  double pitch = 0.0;
  double mass = 0.0;
  Vector3d inertia = Vector3d::Zero();
  std::array<CompiledAxis, k_num_axes> bushing;
  JointForm joint = JointForm::single_pin;
  double groove = 0.0;             ///< m, link centre to the middle of a bore
  double connector_length = 0.0;   ///< m, between the pins of a double pin
  int connector_offset = 0;        ///< double pin: first rear bushing in the arrays of joints, first connector in those
                                   ///< of links
  std::vector<LinkBodies> bodies;  ///< what is integrated: links, and connectors that are bodies
  double free_twist = 0.0;         ///< hinge angle of a bushing at which it is free [rad]
  double clearance = 0.0;          ///< m, radial play of every bushing
  double stop_angle = std::numeric_limits<double>::infinity();  ///< rad of a hinge bent back, where its stop begins
  double stop_stiffness = 0.0;                                  ///< N m/rad
  double wheel_path_height = 0.0, ground_depth = 0.0, half_width = 0.0;
  double guide_height = 0.0, guide_half_base = 0.0, guide_half_top = 0.0;
  CompiledContact guide;
  std::vector<Vector3d> ground_points;
  CompiledContact ground;
  double bristle_stiffness = 0.0, bristle_damping = 0.0;
  std::vector<CompiledDiscs> discs;
  CompiledSprocket sprocket;
  double pre_tension = 0.0;
  double speed_per_sprocket_rate = 0.0;  ///< N p / 2 pi [m]
};

enum class JointSpring { none, torsion_bar, hydropneumatic, tensioner };

/// Suspension or tensioner acting along one joint.
struct CompiledSuspension {
  int body = 0;
  Side side = Side::left;
  JointSpring kind = JointSpring::none;
  double bump_sign = 1.0;     ///< +1: bump is a positive joint angle (trailing arm)
  double design_angle = 0.0;  ///< rad below horizontal at joint angle 0
  TorsionBar bar;
  Hydropneumatic unit;
  double bump_angle = 0.0, rebound_angle = 0.0, stop_stiffness = 0.0;
  double tensioner_stiffness = 0.0, tensioner_damping = 0.0;  ///< N m/rad, N m s/rad about the arm pivot
};

struct System {
  Scenario scenario;  ///< what it was compiled from
  Tree tree;
  std::vector<CompiledSuspension> suspension;
  std::array<int, k_num_sides> sprocket_body{};
  std::array<int, k_num_sides> idler_arm_body{};
  std::array<CompiledTrack, k_num_sides> tracks;
  int link_array_length = 0;  ///< of every link array, padding included
  int num_stop_rows = 0, num_branch_rows = 0, num_ground_rows = 0;
  Vector3d gravity_W = Vector3d::Zero();
  Vector3d chassis_center_V = Vector3d::Zero();  ///< chassis centre of mass in the vehicle frame
  GroundSurface ground;
  double weight = 0.0;  ///< N, whole vehicle

  [[nodiscard]] int num_bodies() const;
  [[nodiscard]] int num_revolute_joints() const { return static_cast<int>(tree.bodies.size()); }
  [[nodiscard]] int num_bushings() const;     ///< one a single pin, two a double pin
  [[nodiscard]] int num_link_bodies() const;  ///< links, and connectors that are bodies
  [[nodiscard]] int num_degrees_of_freedom() const;
  [[nodiscard]] int num_prescribed() const;
};

[[nodiscard]] System compile(const Scenario& scenario);

/// Two links and the one joint between them, both link centres at the pin, nothing else: for bushing_forces alone.
/// Every axis needs a law.
[[nodiscard]] System compile_joint(const Bushing& bushing);

/// Rate coefficient a [s/m] of f = k delta^n (1 + a delta_dot) with restitution e at impact speed v (exact for any n,
/// k, m): (1 + e) a v = ln[(1 + a v) / (1 - e a v)].
[[nodiscard]] double rate_coefficient(double restitution, double speed);

[[nodiscard]] CompiledSpring compile_spring(const SpringSpline& spring);

/// Length of the arrays of so many links: whole blocks, and one block more so that a load at i + 1 stays inside.
[[nodiscard]] int padded_length(int num_links);

/// "link 12 of the left track" for an index into the link arrays; "the chassis" for none.
[[nodiscard]] std::string link_name(const System& system, int index);

/// Joint names in file order: `left/arm_1`, ... (the order of tree.bodies).
[[nodiscard]] std::vector<std::string> joint_names(const System& system);

}  // namespace grouser
