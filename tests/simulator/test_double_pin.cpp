#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "simulator/bushings.h"
#include "simulator/connector.h"
#include "tests/support/scenes.h"

/// One joint of a double pin: two bushings in series through a massless connector.
namespace grouser::test {
namespace {

constexpr double k_length = 0.063;  // m, of the connector
/// W: connectors are placed within 1 N and 0.4 N m of their balance, and these joints part at 5 m/s and 40 rad/s.
constexpr double k_balance_power = 20.0;

/// Two links and the joint from link 0 to link 1.
struct DoublePinPair {
  System system;
  State state;
  Workspace work;

  explicit DoublePinPair(const Bushing& bushing, double pre_torsion = 0.0)
      : system(make_system(bushing, pre_torsion)), state(strewn_state(system)), work(make_workspace(system)) {}

  static System make_system(const Bushing& bushing, double pre_torsion) {
    Vehicle vehicle = bare_vehicle(2);
    for (RunningGear& gear : vehicle.sides) {
      gear.track.connection = Connection::double_pin;
      gear.track.connector.length = k_length;
      gear.track.pre_torsion = pre_torsion;
    }
    System system = compile(parked(vehicle, bushing, 0.0));
    system.tracks[0].num_links = 1;
    system.tracks[1].num_links = 0;
    return system;
  }
  void set(const LinkMotion& a, const LinkMotion& b) {
    set_link(state, 0, a);
    set_link(state, 1, b);
  }
  [[nodiscard]] const CompiledTrack& track() const { return system.tracks[0]; }
  [[nodiscard]] int rear() const { return track().connector_offset; }
  void evaluate(const History& before, double h, bool memory = true) {
    AssemblyKnobs knobs;
    knobs.rubber_memory = memory;
    work.energy = {};
    place_links(system, state, work);
    bushing_forces(system, knobs, before, h, state, work);
  }
  /// Springs and dampers alone.
  void evaluate() {
    evaluate(state.history, 0.0, false);
    const History relaxed = state.history;
    evaluate(relaxed, 0.0);
  }
  [[nodiscard]] Vector3d force() const { return get_vector(work.joint_force_W, 0); }  ///< on link 1
  [[nodiscard]] Vector3d torque_on_next() const { return get_vector(work.joint_torque_next_W, 0); }
  [[nodiscard]] Vector3d torque_on_own() const { return -get_vector(work.joint_torque_own_W, 0); }
  [[nodiscard]] double power() const {
    const LinkMotion a = get_link(state, 0), b = get_link(state, 1);
    return force().dot(b.velocity - a.velocity) + torque_on_own().dot(a.orientation * a.angular_velocity) +
           torque_on_next().dot(b.orientation * b.angular_velocity);
  }
};

class RandomJoints {
 public:
  explicit RandomJoints(std::uint32_t seed) : random_(seed) {}
  double number() { return unit_(random_); }
  Vector3d vector(double size) { return size * Vector3d(number(), number(), number()); }
  /// Bores a connector's length apart but for mm, a hinge angle up to `hinge`, a swing up to 0.02 rad; any motion.
  void pose(DoublePinPair& pair, double hinge) {
    const double groove = pair.track().groove;
    const double angle = hinge * number();
    const LinkMotion a{vector(2.0), quaternion_exp(vector(2.0)), vector(3.0), vector(20.0)};
    const auto about_y = [](double turn) { return Quaterniond(Eigen::AngleAxisd(turn, Vector3d::UnitY())); };
    const Quaterniond half = a.orientation * about_y(0.5 * angle + 0.1 * number());
    LinkMotion b{Vector3d::Zero(),
                 a.orientation * quaternion_exp(vector(0.02).cwiseProduct(Vector3d(1.0, 0.0, 1.0))) * about_y(angle),
                 vector(3.0), vector(20.0)};
    b.position = a.position + a.orientation * Vector3d(groove, 0.0, 0.0) +
                 half * (Vector3d(k_length, 0.0, 0.0) + vector(2e-3)) + b.orientation * Vector3d(groove, 0.0, 0.0);
    pair.set(a, b);
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

TEST(DoublePin, PutsEqualAndOppositeWrenchesAtOneCommonPoint) {
  DoublePinPair pair(rubber_bushing(), 0.24);
  RandomJoints poses(1);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(pair, 1.0);
    pair.evaluate();
    const Vector3d a = get_vector(pair.state.position, 0), b = get_vector(pair.state.position, 1), f = pair.force();
    const Vector3d moment = (b - a).cross(f) + pair.torque_on_next() + pair.torque_on_own();
    ASSERT_TRUE(std::isfinite(f.norm())) << n;
    ASSERT_LT(moment.norm(), 1e-14 * f.norm()) << n;
  }
}

TEST(DoublePin, ElasticPowerIsTheLossOfStoredEnergy) {
  DoublePinPair pair(elastic_bushing(), 0.24);
  RandomJoints poses(2);
  for (int n = 0; n < 1000; ++n) {
    poses.pose(pair, 1.0);
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
    const double energy = stored(0.0), power = pair.power();
    // The difference quotient's cancellation as for the single pin.
    ASSERT_NEAR(power, -energy_rate, 1e-7 * (std::abs(power) + energy / 1e-3) + k_balance_power) << "pose " << n;
  }
}

TEST(DoublePin, WholeRubberTurnsPowerIntoStorageAndLossInEachOfItsBushings) {
  // The memories of the two bushings differ here, and so do their forces' histories; what the shoes get is the power
  // of all elements of both, for the motion that the connector has.
  DoublePinPair pair(rubber_bushing(), 0.24);
  RandomJoints poses(3);
  for (int n = 0; n < 300; ++n) {
    poses.pose(pair, 1.0);
    pair.evaluate();
    History before = pair.state.history;
    for (Field* rows : {&before.deflection, &before.stop, &before.branch}) {
      for (double& value : rows->data()) value *= 1.0 + 0.05 * poses.number();
    }
    const CompiledTrack& track = pair.track();
    auto branch_step = pair.work.branch_step[0];
    constexpr double k_h = 1e-4;
    for (std::size_t a = 0; a < k_num_axes; ++a) {
      prepare_branches(track.bushing[a], k_h, branch_step[a]);
    }
    const RubberStep step{track, branch_step, before, pair.state.history, k_h, true};
    BodyLanes link = load_bodies(pair.state, pair.work, 0), next = load_bodies(pair.state, pair.work, 1);
    const DoublePinJoints joints = balance_connectors(step, link, next, {0, pair.rear()}, 1);
    double work_of_rubber = 0.0, loss = 0.0;
    for (const PinBushings* bushing : {&joints.front, &joints.rear}) {
      for (std::size_t a = 0; a < k_num_axes; ++a)
        work_of_rubber += bushing->rubber.force[a][0] * bushing->kinematics.rate[a][0];
      loss += bushing->rubber.energy.power[0];
    }
    pair.evaluate(before, k_h);
    ASSERT_NEAR(pair.power(), -work_of_rubber, 1e-6 * std::abs(work_of_rubber) + k_balance_power) << "pose " << n;
    ASSERT_GE(loss, 0.0);
  }
}

TEST(DoublePin, IsBalancedOrNoNumber) {
  // Bores up to a metre from where a connector fits between them: some have a balance, none may pass without one.
  DoublePinPair pair(rubber_bushing(), 0.24);
  RandomJoints poses(5);
  int balanced = 0, without = 0;
  for (int n = 0; n < 300; ++n) {
    poses.pose(pair, 1.0);
    pair.state.position[n % 3][1] += poses.number();
    pair.evaluate();
    const History before = pair.state.history;
    const auto branch_step = pair.work.branch_step[0];
    const RubberStep step{pair.track(), branch_step, before, pair.state.history, 0.0, true};
    const DoublePinJoints joints = balance_connectors(step, load_bodies(pair.state, pair.work, 0),
                                                      load_bodies(pair.state, pair.work, 1), {0, pair.rear()}, 1);
    const Lanes3 left_over = joints.front.wrench.force + joints.rear.wrench.force;
    const double force = std::sqrt(dot(left_over, left_over)[0]);
    if (std::isnan(force)) {
      ++without;
      continue;
    }
    ++balanced;
    ASSERT_LT(force, 20.0) << "pose " << n;  // N, of some MN
  }
  EXPECT_GT(balanced, 50);
  EXPECT_GT(without, 0);
}

/// Stored energy of the joint for a connector anywhere, written out anew with matrices and angles: two bores, two pins.
double stored_energy_of(const DoublePinPair& pair, const Vector3d& center, const Matrix3d& connector,
                        const double (&stiffness)[k_num_axes]) {
  const double groove = pair.track().groove;
  const LinkMotion links[] = {get_link(pair.state, 0), get_link(pair.state, 1)};
  double energy = 0.0;
  for (const double end : {-1.0, 1.0}) {
    const LinkMotion& shoe = links[end < 0.0 ? 0 : 1];
    const Matrix3d R = shoe.orientation.toRotationMatrix();
    const Vector3d bore = shoe.position - end * groove * R.col(0),
                   pin = center + end * 0.5 * k_length * connector.col(0);
    const Vector3d d = R.transpose() * (pin - bore);
    const Matrix3d relative = R.transpose() * connector;
    // Twist about y first: the y axis of the connector shows the swing, what is left of x the twist.
    const Quaterniond q(relative);
    const double twist = 2.0 * std::atan2(q.y(), q.w());
    const Quaterniond swing = q * Quaterniond(Eigen::AngleAxisd(-twist, Vector3d::UnitY()));
    const double sign = swing.w() < 0.0 ? -1.0 : 1.0;
    const double turned = std::remainder(twist, 2.0 * k_pi) + (end < 0.0 ? -1.0 : 1.0) * pair.track().free_twist;
    const double x[] = {d.x(), d.y(), d.z(), 2.0 * sign * swing.x(), turned, 2.0 * sign * swing.z()};
    for (int a = 0; a < k_num_axes; ++a) energy += 0.5 * stiffness[a] * x[a] * x[a];
  }
  return energy;
}

TEST(DoublePin, ConnectorStandsWhereAllSixDerivativesOfTheStoredEnergyVanish) {
  const double stiffness[] = {1e8, 2e7, 1e8, 4e6, 1500.0, 4e6};
  DoublePinPair pair(elastic_bushing(), 0.24);
  RandomJoints poses(4);
  for (int n = 0; n < 200; ++n) {
    poses.pose(pair, 1.0);
    LinkMotion a = get_link(pair.state, 0), b = get_link(pair.state, 1);
    a.velocity = a.angular_velocity = b.velocity = b.angular_velocity = Vector3d::Zero();
    pair.set(a, b);
    pair.evaluate();
    const History relaxed = pair.state.history;
    const RubberStep step{pair.track(), pair.work.branch_step[0], relaxed, pair.state.history, 0.0, true};
    const DoublePinJoints joints = balance_connectors(step, load_bodies(pair.state, pair.work, 0),
                                                      load_bodies(pair.state, pair.work, 1), {0, pair.rear()}, 1);
    const auto of = [](const Lanes3& v) { return Vector3d(v.x[0], v.y[0], v.z[0]); };
    const Vector3d center = of(joints.connector.position);
    Matrix3d R;
    R << of(joints.connector.x), of(joints.connector.y), of(joints.connector.z);
    ASSERT_NEAR(stored_energy_of(pair, center, R, stiffness) / pair.work.energy.bushing, 1.0, 1e-9) << n;
    for (int c = 0; c < 3; ++c) {
      constexpr double k_d = 1e-6, k_turn = 1e-5;
      const Vector3d axis = Vector3d::Unit(c);
      const auto shifted = [&](double d) { return stored_energy_of(pair, center + d * axis, R, stiffness); };
      const auto turned = [&](double d) {
        return stored_energy_of(pair, center, quaternion_exp(d * axis).toRotationMatrix() * R, stiffness);
      };
      // Forces of some 1e5 N and moments of 1e4 N m: the difference quotients know them to 1e-5, the balance to 1 N.
      ASSERT_LT(std::abs(shifted(k_d) - shifted(-k_d)) / (2.0 * k_d), 2.0) << n;
      ASSERT_LT(std::abs(turned(k_turn) - turned(-k_turn)) / (2.0 * k_turn), 1.0) << n;
    }
  }
}

/// Two links in a row, the second `stretch` and `rise` off where the joint is free, turned by `angle` about the joint.
void place_row(DoublePinPair& pair, double stretch, double rise, double angle) {
  const double groove = pair.track().groove, half = 0.5 * angle;
  const Quaterniond q(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
  const Vector3d along(std::cos(half), 0.0, -std::sin(half)), up(std::sin(half), 0.0, std::cos(half));
  pair.set({},
           {Vector3d(groove, 0.0, 0.0) + (k_length + stretch) * along + rise * up + q * Vector3d(groove, 0.0, 0.0), q});
}

TEST(DoublePin, PulledJointHasHalfTheStiffnessAndItsConnectorTheTransverseStiffnessOfAString) {
  DoublePinPair pair(elastic_bushing());
  const double k = 1e8, hinge = 1500.0, tension = 1e5;
  constexpr double k_rise = 1e-5;  // m: the string turns by 1.6e-4 rad, its second order is 1e-8
  place_row(pair, tension / (0.5 * k), k_rise, 0.0);
  pair.evaluate();
  EXPECT_NEAR(pair.force().x(), -tension, 1e-4 * tension);
  // Moments on the connector: F l = (T l + 2 k_hinge) turn; the bushings' own shear adds 2 F / k.
  const double swing = tension / k_length + 2.0 * hinge / (k_length * k_length);
  const double transverse = 1.0 / (1.0 / swing + 2.0 / k);
  EXPECT_NEAR(-pair.force().z() / k_rise, transverse, 1e-3 * transverse);
  EXPECT_LT(transverse, 0.03 * k);  // a single pin: k
}

TEST(DoublePin, HingeAngleIsSharedByTheTwoBushings) {
  const double preset = 0.24, angle = -0.6;
  DoublePinPair pair(elastic_bushing(), preset);
  place_row(pair, 1e-3, 0.0, angle);
  pair.evaluate();
  for (const int row : {0, pair.rear()}) {
    EXPECT_NEAR(pair.state.history.deflection[4][row], 0.5 * angle, 1e-6);
    EXPECT_NEAR(pair.work.bushing_torque[1][row], 1500.0 * 0.5 * (angle + preset), 1e-2);
    EXPECT_NEAR(std::hypot(pair.work.bushing_force[0][row], pair.work.bushing_force[2][row]), 5e4, 1.0);
  }
  const double pull = pair.track().groove * 5e4 * std::sin(0.5 * angle);  // moment of the tension about link 1
  EXPECT_NEAR(pair.torque_on_next().y(), -1500.0 * 0.5 * (angle + preset) - pull, 1.0);
}

TEST(DoublePin, MirroredPoseGivesTheMirroredWrench) {
  DoublePinPair pair(rubber_bushing(), 0.24), mirrored(rubber_bushing(), 0.24);
  RandomJoints poses(5);
  const Vector3d polar(1.0, -1.0, 1.0), axial(-1.0, 1.0, -1.0);
  const auto image = [&](const LinkMotion& m) {
    const Quaterniond& q = m.orientation;
    return LinkMotion{polar.cwiseProduct(m.position), Quaterniond(q.w(), -q.x(), q.y(), -q.z()),
                      polar.cwiseProduct(m.velocity), axial.cwiseProduct(m.angular_velocity)};
  };
  for (int n = 0; n < 100; ++n) {
    poses.pose(pair, 1.0);
    mirrored.set(image(get_link(pair.state, 0)), image(get_link(pair.state, 1)));
    pair.evaluate();
    mirrored.evaluate();
    // To the last bit: a symmetric vehicle must stay symmetric.
    ASSERT_EQ(mirrored.force(), Vector3d(polar.cwiseProduct(pair.force())));
    ASSERT_EQ(mirrored.torque_on_next(), Vector3d(axial.cwiseProduct(pair.torque_on_next())));
    ASSERT_EQ(mirrored.torque_on_own(), Vector3d(axial.cwiseProduct(pair.torque_on_own())));
  }
}

TEST(DoublePin, JointSeenFromItsOtherEndIsTheSame) {
  // Half a turn about z and the links exchanged: the front bushing becomes the rear one.
  DoublePinPair pair(elastic_bushing(), 0.24), other(elastic_bushing(), 0.24);
  RandomJoints poses(6);
  const Quaterniond turn(0.0, 0.0, 0.0, 1.0);
  for (int n = 0; n < 100; ++n) {
    poses.pose(pair, 1.0);
    const auto turned = [&](LinkMotion m) {
      m.orientation = m.orientation * turn;
      m.angular_velocity = turn.conjugate() * m.angular_velocity;
      return m;
    };
    other.set(turned(get_link(pair.state, 1)), turned(get_link(pair.state, 0)));
    pair.evaluate();
    other.evaluate();
    ASSERT_LT((other.force() + pair.force()).norm(), 1e-5 * pair.force().norm());
    ASSERT_LT((other.torque_on_next() - pair.torque_on_own()).norm(), 1e-4 * pair.torque_on_own().norm() + 1.0);
    for (int axis = 0; axis < k_num_axes; ++axis)
      ASSERT_NEAR(other.state.history.deflection[axis][0], pair.state.history.deflection[axis][pair.rear()], 2e-7);
  }
}

TEST(DoublePin, ForceDoesNotCareWhereInTheWorldTheJointStands) {
  DoublePinPair pair(elastic_bushing()), moved(elastic_bushing());
  RandomJoints poses(7);
  const Quaterniond turn = quaternion_exp({0.7, -0.4, 2.0});
  for (int n = 0; n < 100; ++n) {
    poses.pose(pair, 1.0);
    const auto carried = [&](LinkMotion m) {
      m.position = turn * m.position + Vector3d(100.0, -50.0, 3.0);
      m.velocity = turn * m.velocity + Vector3d(13.9, 0.0, 0.0);
      m.orientation = turn * m.orientation;
      return m;
    };
    moved.set(carried(get_link(pair.state, 0)), carried(get_link(pair.state, 1)));
    pair.evaluate();
    moved.evaluate();
    ASSERT_LT((moved.force() - turn * pair.force()).norm(), 1.0);  // the tolerance of the balance
  }
}

}  // namespace
}  // namespace grouser::test
