#include <algorithm>

#include "tests/support/simbody_trees.h"
#include "tests/support/tree_references.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

void add_falls(Chapter& chapter) {
  chapter.section(
      "Release at rest",
      "Unit bodies on hinges, released at rest in gravity along -y: joint accelerations of the first moment.");
  for (const FallReference& fall : published_falls()) {
    const TreeState rest = make_state(fall.tree);
    const TreeAnswer answer = accelerate(fall.tree, rest, {0.0, -9.81, 0.0}, no_torque(rest));
    const Worst worst = worst_of(answer.acceleration.joint, fall.acceleration);
    chapter.add({fall.name + ": joint acceleration", "rad/s²", worst.reference, worst.measured,
                 within(1e-12, "round-off"), "published: RBDL, tests/DynamicsTests.cc, 15 digits"});
  }
}

void add_generic_state(Chapter& chapter) {
  chapter.section(
      "A state where nothing vanishes",
      "Five branching bodies with angles, rates and joint torques all different from zero: forward dynamics, "
      "and inverse dynamics with every joint prescribed.");
  const char* source = "dense mass matrix of an independent program (numpy), 14 digits";
  const GenericState g;
  const TreeAnswer answer = accelerate(g.tree, g.state, g.gravity, g.torque);
  const auto add = [&](const char* quantity, const char* unit, const Worst& worst) {
    chapter.add({quantity, unit, worst.reference, worst.measured, within(1e-11, "round-off"), source});
  };
  add("joint acceleration", "rad/s²", worst_of(answer.acceleration.joint, g.acceleration));
  add("kinetic energy", "J", {g.kinetic, answer.work.kinetic_energy});
  add("potential energy", "J", {g.potential, gravity_energy(g.tree, g.state, g.gravity, answer.work)});
  add("torque of prescribed joints", "N m",
      worst_of(inverse_dynamics(g.tree, g.state, g.gravity, g.acceleration), g.torque));
  TreeState still = g.state;
  still.rate.setZero();
  add("first column of the mass matrix", "kg m²",
      worst_of(inverse_dynamics(g.tree, still, Vector3d::Zero(), Eigen::VectorXd::Unit(5, 0)), g.mass_matrix_column));
}

void add_motion(Chapter& chapter, const MotionReference& reference) {
  TreeState state = reference.start;
  double time = 0.0;
  Worst angle, rate;
  for (const MotionReference::At& known : reference.known) {
    const double ahead = known.time - time;
    state = runge_kutta(reference.tree, state, reference.gravity, reference.torque, ahead,
                        static_cast<int>(ahead * 4000.0));
    time = known.time;
    angle = worse(angle, worst_of(state.angle, known.angle));
    rate = worse(rate, worst_of(state.rate, known.rate));
  }
  chapter.add({reference.name + ": joint angle", "rad", angle.reference, angle.measured,
               within(reference.tolerance, reference.reason), reference.source});
  chapter.add({reference.name + ": joint rate", "rad/s", rate.reference, rate.measured,
               within(30.0 * reference.tolerance, reference.reason), reference.source});
}

void add_heavy_top(Chapter& chapter) {
  const HeavyTop top;
  TreeState state = top.start;
  double time = 0.0;
  Worst center, spin;
  for (const HeavyTop::At& known : top.known) {
    const double ahead = known.time - time;
    state = runge_kutta(top.tree, state, top.gravity, no_torque, ahead, static_cast<int>(ahead * 4000.0));
    time = known.time;
    const TreeWorkspace work = accelerate(top.tree, state, top.gravity, no_torque(state)).work;
    center = worse(center, worst_of(work.center_W(2), known.center));
    spin = worse(spin, worst_of(work.rotation(2).transpose() * work.angular_velocity_W(2), known.spin));
  }
  const char* source = "Euler's equations and DOP853 (scipy)";
  chapter.add({"heavy top of 150 rad/s: place of the centre of mass", "m", center.reference, center.measured,
               within(1e-7, "reference integrator at 0.25 ms"), source});
  chapter.add({"heavy top of 150 rad/s: angular velocity in the body", "rad/s", spin.reference, spin.measured,
               within(1e-5, "its phase of 1e-7 rad in 150 rad/s"), source});
}

void add_motions(Chapter& chapter) {
  chapter.section(
      "Motion",
      "The recursion's accelerations through a Runge-Kutta reference integrator of fourth order, compared at "
      "up to five times within 1 to 3 s.");
  for (const MotionReference& reference : {five_body_fall(), double_pendulum(), sprung_chain(), tilted_hinge_chain()})
    add_motion(chapter, reference);
  const MotionReference tilted = tilted_hinge_chain();
  const TreeState end = runge_kutta(tilted.tree, tilted.start, tilted.gravity, no_torque, 1.0, 4000);
  chapter.add({"five bars on tilted hinges: sum of the joint angles at 1 s", "rad", -1.3093839514061, end.angle.sum(),
               within(1e-10, "reference integrator at 0.25 ms"), "published: EXUDYN, TestModels/kinematicTreeTest.py"});
  const MotionReference chain = sprung_chain();
  TreeState still = chain.start;
  still.angle = sprung_chain_at_rest();
  const TreeAnswer answer = accelerate(chain.tree, still, chain.gravity, chain.torque(still));
  chapter.add({"ten links on sprung hinges, hanging still: joint acceleration", "rad/s²", 0.0,
               answer.acceleration.joint.cwiseAbs().maxCoeff(), within(1e-8, "angles given to 1e-14 rad"),
               "static solution of an independent program (scipy)"});
  add_heavy_top(chapter);
}

void add_rods(Chapter& chapter) {
  chapter.section(
      "A hinged rod in a commercial solver",
      "1 kg, 2 m from its hinge, released level; free on a level and on a tilted hinge, and with a linear and a "
      "stiffening torsional spring, each with a damper. Compared at 0.25, 0.5, 1, 2.5 and 5 s; what the rod "
      "puts on the ground is the joint's reaction.");
  for (const HingedRod& rod : adams_rods()) {
    TreeState state = rod.start;
    double time = 0.0;
    Worst center, force, moment;
    for (const HingedRod::At& known : rod.known) {
      const double ahead = known.time - time;
      state = runge_kutta(rod.tree, state, rod.gravity, rod.torque, ahead, static_cast<int>(ahead * 1000.0));
      time = known.time;
      const HingedRod::At found = observe(rod, state, time);
      center = worse(center, worst_of(found.center, known.center));
      force = worse(force, worst_of(found.force, known.force));
      moment = worse(moment, worst_of(found.moment, known.moment));
    }
    const std::string name = rod.name.substr(rod.name.find('/') + 1) + ": ";
    const std::string source = "MSC ADAMS, curve " + rod.name + " of Project Chrono's test data, 6 to 7 digits";
    chapter.add({name + "place of the centre of mass", "m", center.reference, center.measured,
                 within(1e-5, "what the curve was integrated to"), source});
    chapter.add({name + "reaction force", "N", force.reference, force.measured,
                 within(3e-3, "what the curve was integrated to"), source});
    chapter.add({name + "reaction moment", "N m", moment.reference, moment.measured,
                 within(rod.moment_tolerance, "what the curve was integrated to"), source});
  }
}

void add_simbody(Chapter& chapter) {
  constexpr std::uint32_t k_trees = 200;
  chapter.section(
      "Random trees against Simbody",
      "200 floating trees of 1 to 36 bodies with random topology, axes, masses, inertias, states and torques: "
      "largest difference of any acceleration of base and joints, over 1 + the tree's largest joint acceleration.");
  double worst = 0.0;
  for (std::uint32_t seed = 1; seed <= k_trees; ++seed) worst = std::max(worst, difference_to_simbody(seed));
  chapter.add({"accelerations of all trees", "", 0.0, worst,
               within(1e-9, "round-off through 36 bodies of 1:100 in inertia"),
               "Simbody 3.7, solved when this page was made"});
}

}  // namespace

void add_trees(Chapter& chapter) {
  add_falls(chapter);
  add_generic_state(chapter);
  add_motions(chapter);
  add_rods(chapter);
  add_simbody(chapter);
}

}  // namespace grouser::validation
