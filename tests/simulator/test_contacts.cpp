#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/closed_forms.h"
#include "tests/support/contact_scene.h"

namespace grouser::test {
namespace {

Quaterniond roll(double angle) { return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX())); }

TEST(ContactLaw, RateCoefficientGivesTheAskedRestitution) {
  // a v over the restitution, inverted; five digits of the table.
  const double table[][2] = {{0.01, 0.99338}, {0.1, 0.93748}, {0.2, 0.88219}, {0.5, 0.74843},
                             {1.0, 0.59362},  {2.0, 0.41072}, {5.0, 0.19698}, {10.0, 0.09998}};
  for (const auto& [av, e] : table) {
    EXPECT_NEAR(rate_coefficient(e, 1.0) / av, 1.0, 2e-3) << "e " << e;
    EXPECT_NEAR(rate_coefficient(e, 2.5) * 2.5 / av, 1.0, 2e-3);  // only a v counts
  }
  for (const double e : {0.2, 0.3, 0.5, 0.835, 0.95, 0.999}) {
    const double av = rate_coefficient(e, 1.0);
    EXPECT_GT(av, 0.0);
    EXPECT_NEAR(restitution_defect(e, av), 0.0, 1e-12) << "e " << e;
  }
  EXPECT_EQ(rate_coefficient(1.0, 1.0), 0.0);
}

TEST(DiscContacts, MeetAPlateWithOneOrBothDiscs) {
  ContactScene scene;
  const DiscPair& wheel = scene.left().stations[2].wheel;
  scene.put(under_wheel(scene, wheel, 0.0, 1e-3));
  scene.touch();
  EXPECT_EQ(scene.count(ContactCase::two_discs_on_plate), 1);
  EXPECT_EQ(scene.count(ContactCase::guide_none), 1);
  // Foundation of a disc: k times the area of the circle's segment below the path, (4/3) d sqrt(2 R d) for small d.
  const double segment = 4.0 / 3.0 * 1e-3 * std::sqrt(2.0 * wheel.radius * 1e-3);
  EXPECT_NEAR(scene.work.contact_force_W[0][2][0], -2.0 * wheel.contact.stiffness * segment, 1e-6 * 2e4);
  EXPECT_NEAR(scene.work.torque_W[1][0], 0.0, 1e-9);  // no moment under the middle

  scene.put(under_wheel(scene, wheel, 0.0, 1e-3), roll(0.02));  // 2.3 mm at the discs
  scene.touch();
  EXPECT_EQ(scene.count(ContactCase::one_disc_on_plate), 1);
  EXPECT_EQ(scene.count(ContactCase::two_discs_on_plate), 0);
}

TEST(DiscContacts, MeetAnEdgeWithOneOrBothDiscs) {
  ContactScene scene;
  const DiscPair& wheel = scene.left().stations[2].wheel;
  const double beyond = 0.5 * scene.system.tracks[0].pitch + 0.02;
  scene.put(under_wheel(scene, wheel, -beyond, 4e-3));
  scene.touch();
  EXPECT_EQ(scene.count(ContactCase::two_discs_on_edge), 1);
  EXPECT_LT(scene.work.contact_force_W[0][0][0], 0.0);  // an axle ahead of the edge pushes the link back
  scene.put(under_wheel(scene, wheel, -beyond, 4e-3), roll(0.06));
  scene.touch();
  EXPECT_EQ(scene.count(ContactCase::one_disc_on_edge), 1);
}

TEST(DiscContacts, HandAWheelFromLinkToLinkWithoutAJump) {
  // Two links in line: the sum of their forces while the wheel rolls over the joint stays that of one long plate.
  ContactScene scene;
  const DiscPair& wheel = scene.left().stations[2].wheel;
  const double pitch = scene.system.tracks[0].pitch, segment = 4.0 / 3.0 * 2e-3 * std::sqrt(2.0 * wheel.radius * 2e-3);
  for (double along = 0.0; along > -pitch; along -= 0.003) {
    LinkMotion next = get_link(scene.state, 1);
    next.position = under_wheel(scene, wheel, along + pitch, 2e-3);
    set_link(scene.state, 1, next);
    scene.put(under_wheel(scene, wheel, along, 2e-3));
    scene.touch();
    const Field& force = scene.work.contact_force_W[0];
    ASSERT_NEAR(force[2][0] + force[2][1], -2.0 * wheel.contact.stiffness * segment, 1e-9 * 1e5) << along;
    ASSERT_NEAR(force[0][0] + force[0][1], 0.0, 1e-9 * 1e5) << along;
  }
}

TEST(DiscContacts, BookIdlerAndSupportRollersAsSuch) {
  ContactScene scene;
  const auto upside_down = Quaterniond(Eigen::AngleAxisd(k_pi, Vector3d::UnitY()));
  const double path = scene.system.tracks[0].wheel_path_height;
  const DiscPair& roller = scene.left().support_rollers[1];
  scene.put(roller.center + Vector3d(0.0, 0.0, roller.radius + path - 1e-3), upside_down);
  scene.touch();
  EXPECT_GT(scene.work.contact_force_W[static_cast<std::size_t>(Partner::support_roller)][2][0], 1e3);
  const DiscPair& idler = scene.left().idler.wheel;
  scene.put(idler.center + Vector3d(0.0, 0.0, idler.radius + path - 1e-3), upside_down);
  scene.touch();
  EXPECT_GT(scene.work.contact_force_W[static_cast<std::size_t>(Partner::idler)][2][0], 1e3);
}

TEST(GuideContacts, MeetEitherWallTheTopOrNothing) {
  ContactScene scene;
  const DiscPair& wheel = scene.left().stations[2].wheel;
  const auto put_aside = [&](double y, double depth) {
    scene.put(under_wheel(scene, wheel, 0.0, depth) + Vector3d(0.0, y, 0.0));
    scene.touch();
    return scene.work.contact_force_W[static_cast<std::size_t>(Partner::guide)][1][0];
  };
  EXPECT_EQ(put_aside(0.010, 1e-3), 0.0);  // 15 mm of play
  EXPECT_EQ(scene.count(ContactCase::guide_none), 1);
  EXPECT_NEAR(put_aside(0.020, 1e-3), -2e7 * 0.005, 1.0);  // 5 mm into the wall: pushed back to the right
  EXPECT_EQ(scene.count(ContactCase::guide_left_wall), 1);
  EXPECT_NEAR(put_aside(-0.020, 1e-3), 2e7 * 0.005, 1.0);
  EXPECT_EQ(scene.count(ContactCase::guide_right_wall), 1);
  EXPECT_EQ(put_aside(0.050, -0.075), 0.0);  // a rim rides 5 mm deep on the horn: straight down
  EXPECT_EQ(scene.count(ContactCase::guide_top), 1);
  EXPECT_NEAR(scene.work.contact_force_W[static_cast<std::size_t>(Partner::guide)][2][0], -2e7 * 0.005, 1.0);
}

TEST(SprocketContacts, MeetTopFlanksSidesAndBaseCircle) {
  ContactScene scene;
  const CompiledSprocket& sprocket = scene.system.tracks[0].sprocket;
  const auto put_pin = [&](double x, double z, double y = 0.0) {
    scene.put(with_pin_at(scene, x, z) + Vector3d(0.0, y, 0.0));
    scene.touch();
  };
  put_pin(sprocket.pitch_radius + 5e-4, 0.0);  // in the seat, with play
  EXPECT_EQ(get_vector(scene.work.force_W, 0).norm(), 0.0);
  put_pin(0.322, 0.0065);  // forward rolling (+y) turns +x towards -z: the tooth above drives the pin down
  EXPECT_EQ(scene.count(ContactCase::sprocket_flank_driving), 2);  // both rings
  EXPECT_LT(scene.work.force_W[2][0], 0.0);
  put_pin(0.322, -0.0065);
  EXPECT_EQ(scene.count(ContactCase::sprocket_flank_braking), 2);
  EXPECT_GT(scene.work.force_W[2][0], 0.0);
  put_pin(sprocket.base_radius + sprocket.pin_radius - 1e-3, 0.0);
  EXPECT_EQ(scene.count(ContactCase::sprocket_base), 2);
  const double half_step = k_pi / sprocket.teeth, radius = sprocket.tip_radius + 0.02;
  put_pin(radius * std::cos(half_step), radius * std::sin(half_step));
  EXPECT_EQ(scene.count(ContactCase::sprocket_top), 2);
  EXPECT_NEAR(get_vector(scene.work.force_W, 0).norm(), 5e7 * 0.002, 1e-3);
  put_pin(sprocket.pitch_radius + 5e-4, 0.0, 0.018);
  EXPECT_EQ(scene.count(ContactCase::sprocket_side_left), 1);
  EXPECT_LT(scene.work.force_W[1][0], 0.0);
  put_pin(sprocket.pitch_radius + 5e-4, 0.0, -0.018);
  EXPECT_EQ(scene.count(ContactCase::sprocket_side_right), 1);
}

TEST(SprocketContacts, PenetrationIsContinuousRoundTheTooth) {
  // A distance to a solid never changes faster than the point moves; a jump would be a step of energy.
  const ContactScene scene;
  const CompiledSprocket& sprocket = scene.system.tracks[0].sprocket;
  constexpr double k_step = 5e-5;  // m
  const double half_step = k_pi / sprocket.teeth, highest = sprocket.tip_radius + sprocket.pin_radius + 0.002;
  const auto depth = [&](double radius, double angle) {
    const Lanes x = radius * std::cos(angle), y = radius * std::sin(angle);
    return std::max(0.0, touch_tooth(sprocket, x, y).penetration[0]);
  };
  double worst = 0.0, at_radius = 0.0, at_angle = 0.0;
  for (double radius = sprocket.pitch_radius - 0.004; radius < highest; radius += k_step) {
    for (double angle = -half_step; angle < half_step; angle += k_step / radius) {
      const double here = depth(radius, angle);
      if (here > 0.02) continue;  // pins do not go that deep
      for (const double change :
           {depth(radius + k_step, angle) - here, depth(radius, angle + k_step / radius) - here}) {
        if (std::abs(change) > worst) worst = std::abs(change), at_radius = radius, at_angle = angle;
      }
    }
  }
  EXPECT_LT(worst, 1.05 * k_step) << "at radius " << at_radius << " and angle " << at_angle;
}

TEST(GroundContacts, HoldAPlateOnSixPoints) {
  ContactScene scene;
  scene.put({20.0, 0.0, scene.system.tracks[0].ground_depth - 1e-3});
  scene.touch_ground();
  EXPECT_EQ(scene.count(ContactCase::ground_point), 6);
  EXPECT_NEAR(scene.work.force_W[2][0], 6.0 * 5e6 * 1e-3, 1e-6);
  EXPECT_NEAR(get_vector(scene.work.torque_W, 0).norm(), 0.0, 1e-6);
}

/// Random poses of one link touching a wheel, a guide or the sprocket.
class TouchingPoses {
 public:
  explicit TouchingPoses(std::uint32_t seed) : random_(seed) {}
  double unit() { return unit_(random_); }
  Vector3d vector(double size) { return {size * unit(), size * unit(), size * unit()}; }
  /// Until something touches.
  void pose(ContactScene& scene, bool moving) {
    do {
      TreeState& base = scene.state.chassis;
      base.position = scene.system.chassis_center_V + vector(0.5);
      base.orientation = quaternion_exp(vector(0.3));
      base.velocity = moving ? vector(2.0) : Vector3d::Zero();
      base.angular_velocity = moving ? vector(0.5) : Vector3d::Zero();
      for (Eigen::Index j = 0; j < base.angle.size(); ++j) {
        base.angle[j] = 0.1 * unit();
        base.rate[j] = moving ? 5.0 * unit() : 0.0;
      }
      const RunningGear& gear = scene.left();
      const DiscPair& pair = gear.stations[3].wheel;
      const auto body = static_cast<std::size_t>(scene.system.tracks[0].discs[3].body);
      const int arm = scene.system.tree.bodies[body].parent;
      Vector3d place(0.0, 0.025 * unit(), 0.0);
      switch (kind_++ % 4) {
        case 0:  // rims on the wheel path, horn between the discs
          place += under_wheel(scene, pair, 0.12 * unit(), 3e-3 + 4e-3 * unit());
          base.angle[arm] = 0.0;  // the wheel stands where it stood at design
          break;
        case 1:  // a rim on the horn
          place += under_wheel(scene, pair, 0.12 * unit(), -0.076 + 2e-3 * unit());
          place.y() += unit() > 0.0 ? 0.05 : -0.05;
          base.angle[arm] = 0.0;
          break;
        case 2:  // a pin between the teeth
          place += with_pin_at(scene, 0.325 + 0.02 * unit(), 0.03 * unit());
          break;
        default:  // a pin on the base circle
          place += with_pin_at(scene, 0.289 + 0.002 * unit(), 0.01 * unit());
      }
      LinkMotion link;
      link.position = base.position + base.orientation * (place - scene.system.chassis_center_V);
      link.orientation = base.orientation * quaternion_exp(vector(0.04));
      if (moving) {
        link.velocity = base.velocity + vector(1.0);
        link.angular_velocity = vector(5.0);
      }
      set_link(scene.state, 0, link);
      scene.touch();
    } while (scene.work.energy.contact <= 0.0);
  }

 private:
  int kind_ = 0;
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

TEST(Contacts, ElasticForcesAreTheGradientOfTheirEnergy) {
  ContactScene scene;
  TouchingPoses poses(11);
  std::array<long, k_num_contact_cases> seen{};
  for (int n = 0; n < 1000; ++n) {
    poses.pose(scene, false);
    for (std::size_t c = 0; c < seen.size(); ++c) seen[c] += scene.work.case_count[c];
    const LinkMotion link = get_link(scene.state, 0);
    const Vector3d force = get_vector(scene.work.force_W, 0), torque = get_vector(scene.work.torque_W, 0);
    const auto energy = [&](const Vector3d& move, const Vector3d& turn) {
      scene.put(link.position + move, quaternion_exp(turn) * link.orientation);
      scene.touch();
      return scene.work.energy.contact;
    };
    constexpr double k_step = 1e-7;
    Vector3d gradient, moment;
    for (int c = 0; c < 3; ++c) {
      const Vector3d e = k_step * Vector3d::Unit(c), none = Vector3d::Zero();
      gradient[c] = (energy(e, none) - energy(-e, none)) / (2.0 * k_step);
      moment[c] = (energy(none, e) - energy(none, -e)) / (2.0 * k_step);
    }
    // The difference over 0.1 um of a force that grows by at most 1e8 N/m: a kink inside it costs 10 N.
    ASSERT_LT((force + gradient).norm(), 1e-5 * force.norm() + 10.0) << "pose " << n;
    ASSERT_LT((torque + moment).norm(), 1e-5 * force.norm() + 5.0) << "pose " << n;
  }
  using enum ContactCase;
  for (const ContactCase which :
       {one_disc_on_plate, two_discs_on_plate, one_disc_on_edge, two_discs_on_edge, guide_left_wall, guide_right_wall,
        sprocket_flank_driving, sprocket_flank_braking, sprocket_top, sprocket_side_left, sprocket_side_right}) {
    EXPECT_GT(seen[static_cast<std::size_t>(which)], 5) << k_contact_case_names[static_cast<std::size_t>(which)];
  }
}

TEST(Contacts, PowerIsTheLossOfContactEnergyLessDampingAndFriction) {
  ContactScene scene;
  TouchingPoses poses(12);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(scene, true);
    const double power = scene.power(), damping = scene.work.energy.contact_power;
    const double friction = scene.work.energy.friction_power;
    ASSERT_GE(damping, 0.0);
    ASSERT_GE(friction, 0.0);
    const State here = scene.state;
    constexpr double k_dt = 1e-8;
    const auto energy_after = [&](double dt) {
      scene.state = here;
      scene.drift(dt);
      scene.touch();
      return scene.work.energy.contact;
    };
    const double energy_rate = (energy_after(k_dt) - energy_after(-k_dt)) / (2.0 * k_dt);
    ASSERT_NEAR(power, -energy_rate - damping - friction, 1e-5 * (std::abs(power) + damping + friction) + 50.0)
        << "pose " << n;  // of up to MW; a kink within 0.05 um costs 50 W
  }
}

TEST(Contacts, LinkAndChassisFeelOppositeWrenches) {
  ContactScene scene;
  TouchingPoses poses(13);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(scene, true);
    const Vector3d force = get_vector(scene.work.force_W, 0);
    const Vector3d arm = get_vector(scene.state.position, 0) - scene.state.chassis.position;
    Vector6d sum;
    sum << get_vector(scene.work.torque_W, 0) + arm.cross(force), force;
    for (int i = 0; i < scene.system.num_revolute_joints(); ++i) sum += scene.work.chassis.force(i);
    ASSERT_LT(sum.norm(), 1e-13 * (force.norm() * 5.0 + 1.0)) << "pose " << n;  // arms of up to 5 m
  }
}

}  // namespace
}  // namespace grouser::test
