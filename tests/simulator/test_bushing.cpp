#include "simulator/bushings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/bushing_element.h"
#include "tests/support/scenes.h"

namespace grouser::test {
namespace {

/// A chain of two links: joint 0 leads from link 0 to link 1, joint 1 back, so that nothing else moves.
struct Pair {
  System system;
  State state;
  Workspace work;

  explicit Pair(const Bushing& bushing, double pre_torsion = 0.0) : system(make_system(bushing, pre_torsion)) {
    state = strewn_state(system);
    work = make_workspace(system);
  }
  static System make_system(const Bushing& bushing, double pre_torsion) {
    Vehicle vehicle = bare_vehicle(2);
    for (RunningGear& gear : vehicle.sides) gear.track.pre_torsion = pre_torsion;
    System system = compile(parked(vehicle, bushing, 0.0));
    system.tracks[1].num_links = 0;  // one track is enough: energies below are those of the left one
    return system;
  }
  void set(const LinkMotion& a, const LinkMotion& b) {
    set_link(state, 0, a);
    set_link(state, 1, b);
    close_chains(system, state);
  }
  void evaluate(const History& before, double h) {
    work.energy = {};
    place_links(system, state, work);
    bushing_forces(system, {}, before, h, state, work);
  }
  /// Springs and dampers alone: the state's own deflections are its memory.
  void evaluate() {
    relax_rubber(system, state);
    const History relaxed = state.history;
    evaluate(relaxed, 0.0);
  }
  [[nodiscard]] double power() const {
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
      sum += get_vector(work.force_W, i).dot(get_vector(state.velocity, i)) +
             get_vector(work.torque_W, i).dot(get_vector(work.angular_velocity_W, i));
    }
    return sum;
  }
};

class RandomPoses {
 public:
  explicit RandomPoses(std::uint32_t seed) : random_(seed) {}
  Vector3d vector(double size) { return size * Vector3d(unit_(random_), unit_(random_), unit_(random_)); }
  /// Link 1 near link 0's end: deflections of mm, a hinge angle up to `hinge`, a swing up to 0.1 rad; any motion.
  void pose(Pair& pair, double hinge) {
    const double half = 0.5 * pair.system.tracks[0].pitch;
    LinkMotion a{vector(2.0), quaternion_exp(vector(2.0)), vector(3.0), vector(20.0)};
    const Quaterniond twist(Eigen::AngleAxisd(hinge * unit_(random_), Vector3d::UnitY()));
    const Quaterniond swing = quaternion_exp(vector(0.1).cwiseProduct(Vector3d(1.0, 0.0, 1.0)));
    LinkMotion b{Vector3d::Zero(), a.orientation * swing * twist, vector(3.0), vector(20.0)};
    b.position = a.position + a.orientation * (Vector3d(half, 0.0, 0.0) + vector(3e-3)) +
                 b.orientation * Vector3d(half, 0.0, 0.0);
    pair.set(a, b);
  }
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

TEST(Bushing, PutsEqualAndOppositeWrenchesAtOneCommonPoint) {
  Pair pair(rubber_bushing(), 0.24);
  RandomPoses poses(1);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(pair, 2.5);
    pair.evaluate();
    Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
    double scale = 0.0;
    for (int i = 0; i < 2; ++i) {
      const Vector3d f = get_vector(pair.work.force_W, i);
      force += f;
      moment += get_vector(pair.state.position, i).cross(f) + get_vector(pair.work.torque_W, i);
      scale = std::max(scale, f.norm());
    }
    ASSERT_LT(force.norm(), 1e-15 * scale);          // the very same number with two signs
    ASSERT_LT(moment.norm(), 4e-15 * scale * 10.0);  // round-off at arms of some metres
  }
}

TEST(Bushing, PowerIsTheLossOfStoredEnergyLessDissipation) {
  Pair pair(viscous_bushing(), 0.24);
  RandomPoses poses(2);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(pair, 2.5);
    const LinkMotion a = get_link(pair.state, 0), b = get_link(pair.state, 1);
    const auto stored = [&](double dt) {
      const auto moved = [dt](LinkMotion link) {
        link.position += dt * link.velocity;
        link.orientation = link.orientation * quaternion_exp(dt * link.angular_velocity);
        return link;
      };
      pair.set(moved(a), moved(b));
      pair.evaluate();
      return pair.work.energy.bushing;
    };
    constexpr double k_dt = 1e-7;
    const double energy_rate = (stored(k_dt) - stored(-k_dt)) / (2.0 * k_dt);
    const double energy = stored(0.0);
    const double lost = pair.work.energy.bushing_power, power = pair.power();
    ASSERT_GE(lost, 0.0);
    // The difference quotient loses nine digits of the energy to cancellation, against powers of the same size.
    ASSERT_NEAR(power, -energy_rate - lost, 1e-7 * (std::abs(power) + energy / 1e-3)) << "pose " << n;
  }
}

TEST(Bushing, FollowsTheLawOfTheBushingFileOnEveryAxis) {
  const Bushing bushing = viscous_bushing();
  Pair pair(bushing);
  RandomPoses poses(3);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(pair, 2.5);
    // At rest: springs alone. Joint 1 stands far outside the knots, on the straight ends.
    LinkMotion a = get_link(pair.state, 0), b = get_link(pair.state, 1);
    a.velocity = a.angular_velocity = b.velocity = b.angular_velocity = Vector3d::Zero();
    pair.set(a, b);
    pair.evaluate();
    double energy = 0.0;
    for (int joint = 0; joint < 2; ++joint) {
      for (int axis = 0; axis < k_num_axes; ++axis) {
        const SpringSpline& spring = bushing.axes[static_cast<std::size_t>(axis)].spring;
        const double x = pair.state.history.deflection[axis][joint];
        const double force =
            axis < 3 ? pair.work.bushing_force[axis][joint] : pair.work.bushing_torque[axis - 3][joint];
        // Round-off of a curve whose ends stand this far from zero.
        const double round_off = 1e-15 * std::abs(spring.force.back());
        ASSERT_NEAR(force, evaluate(spring, x).force, 1e-12 * std::abs(force) + round_off) << "axis " << axis;
        ASSERT_NEAR(pair.work.joint_stiffness[axis][joint], evaluate(spring, x).slope, 1e-3);
        energy += stored_energy(spring, x);
      }
    }
    ASSERT_NEAR(pair.work.energy.bushing, energy, 1e-12 * energy);
  }
}

TEST(Bushing, HingeTurnsTo170DegreesWithoutAJump) {
  Pair pair(elastic_bushing());
  const double half = 0.5 * pair.system.tracks[0].pitch;
  double last_moment = 0.0;
  Vector3d last_couple = Vector3d::Zero();
  for (int tenth = -1700; tenth <= 1700; ++tenth) {
    const double angle = 0.1 * tenth * k_pi / 180.0;
    const Quaterniond swing = quaternion_exp({0.05, 0.0, -0.03});
    const Quaterniond q = swing * Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
    pair.set({}, {Vector3d(half, 0.0, 0.0) + q * Vector3d(half, 0.0, 0.0), q});
    pair.evaluate();
    ASSERT_NEAR(pair.state.history.deflection[4][0], angle, 1e-12);  // the twist, whatever the swing
    // The swing vector is 2 sin(angle / 2) long and lies where the swing's axis lies.
    const double length = 2.0 * std::sin(0.5 * std::hypot(0.05, 0.03)) / std::hypot(0.05, 0.03);
    ASSERT_NEAR(pair.state.history.deflection[3][0], 0.05 * length, 1e-12);
    ASSERT_NEAR(pair.state.history.deflection[5][0], -0.03 * length, 1e-12);
    const double moment = pair.work.bushing_torque[1][0];
    const Vector3d couple = get_vector(pair.work.joint_torque_own_W, 0);
    if (tenth > -1700) {
      ASSERT_NEAR(moment - last_moment, 1500.0 * 0.1 * k_pi / 180.0, 1e-8);
      ASSERT_LT((couple - last_couple).norm(), 4e-3 * couple.norm());  // 0.1 degree is 1.7e-3 rad
    }
    last_moment = moment;
    last_couple = couple;
  }
}

TEST(Bushing, PreTorsionShiftsTheHingeMomentAlone) {
  const double preset = 14.0 * k_pi / 180.0;
  Pair plain(elastic_bushing()), preset_pair(elastic_bushing(), preset);
  RandomPoses poses(4), same(4);
  for (int n = 0; n < 100; ++n) {
    poses.pose(plain, 1.0);
    same.pose(preset_pair, 1.0);
    plain.evaluate();
    preset_pair.evaluate();
    for (int c = 0; c < 3; ++c) {
      // Free when wrapped inward, which turns link 1 by a negative angle: f = k (angle + preset).
      const double shift = c == 1 ? 1500.0 * preset : 0.0;
      ASSERT_NEAR(preset_pair.work.bushing_torque[c][0] - plain.work.bushing_torque[c][0], shift, 1e-7);
      ASSERT_DOUBLE_EQ(preset_pair.work.bushing_force[c][0], plain.work.bushing_force[c][0]);
    }
  }
}

TEST(Bushing, MirroredPoseGivesTheMirroredWrench) {
  Pair pair(viscous_bushing(), 0.24), mirrored(viscous_bushing(), 0.24);
  RandomPoses poses(5);
  const Vector3d polar(1.0, -1.0, 1.0), axial(-1.0, 1.0, -1.0);
  const auto image = [&](const LinkMotion& m) {
    const Quaterniond& q = m.orientation;
    return LinkMotion{polar.cwiseProduct(m.position), Quaterniond(q.w(), -q.x(), q.y(), -q.z()),
                      polar.cwiseProduct(m.velocity), axial.cwiseProduct(m.angular_velocity)};
  };
  for (int n = 0; n < 100; ++n) {
    poses.pose(pair, 2.5);
    mirrored.set(image(get_link(pair.state, 0)), image(get_link(pair.state, 1)));
    pair.evaluate();
    mirrored.evaluate();
    for (int i = 0; i < 2; ++i) {
      const Vector3d f = get_vector(pair.work.force_W, i), t = get_vector(pair.work.torque_W, i);
      ASSERT_LT((get_vector(mirrored.work.force_W, i) - polar.cwiseProduct(f)).norm(), 1e-13 * f.norm());
      ASSERT_LT((get_vector(mirrored.work.torque_W, i) - axial.cwiseProduct(t)).norm(), 1e-12 * t.norm());
    }
  }
}

TEST(Bushing, ForceDoesNotCareWhereInTheWorldTheJointStands) {
  Pair pair(viscous_bushing()), moved(viscous_bushing());
  RandomPoses poses(6);
  const Quaterniond turn = quaternion_exp({0.7, -0.4, 2.0});
  for (int n = 0; n < 100; ++n) {
    poses.pose(pair, 2.5);
    const auto carried = [&](LinkMotion m) {
      m.position = turn * m.position + Vector3d(100.0, -50.0, 3.0);
      m.velocity = turn * m.velocity + Vector3d(13.9, 0.0, 0.0);
      m.orientation = turn * m.orientation;
      return m;
    };
    moved.set(carried(get_link(pair.state, 0)), carried(get_link(pair.state, 1)));
    pair.evaluate();
    moved.evaluate();
    for (int i = 0; i < 2; ++i) {
      const Vector3d f = get_vector(pair.work.force_W, i);
      // 100 m from the origin a position is known to 1.4e-14 m: 3e-6 N of a joint of 1e8 N/m.
      ASSERT_LT((get_vector(moved.work.force_W, i) - turn * f).norm(), 2e-5);
    }
  }
}

TEST(ArcTangent, IsWithinTwoUnitsInTheLastPlace) {
  for (int n = -6600; n < 6600; n += k_lanes) {  // the bushing asks for tan(angle / 8): up to 0.4143
    Lanes x;
    for (int lane = 0; lane < k_lanes; ++lane) x.set(lane, (n + lane) * 1e-4);
    const Lanes angle = arc_tangent(x);
    for (int lane = 0; lane < k_lanes; ++lane) {
      const double exact = std::atan(x[lane]);
      ASSERT_NEAR(angle[lane], exact, 2.0 * 2.3e-16 * std::abs(exact)) << x[lane];
    }
  }
}

}  // namespace
}  // namespace grouser::test
