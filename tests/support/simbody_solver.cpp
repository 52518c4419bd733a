#include "tests/support/simbody_solver.h"

#include <Simbody.h>

#include "tests/support/floating_point_traps.h"

namespace grouser::test {
namespace {

SimTK::Vec3 to_vec(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d from_vec(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

SimTK::Body::Rigid rigid(double mass, const Vector3d& center, const Matrix3d& about_center) {
  const SimTK::Inertia central(about_center(0, 0), about_center(1, 1), about_center(2, 2), about_center(0, 1),
                               about_center(0, 2), about_center(1, 2));
  return SimTK::Body::Rigid(
      SimTK::MassProperties(mass, to_vec(center), central.shiftFromMassCenter(to_vec(center), mass)));
}

/// Frame whose z axis is the hinge, seen in the body that carries it.
SimTK::Transform hinge_frame(const Vector3d& axis, const Vector3d& origin) {
  return {SimTK::Rotation(SimTK::UnitVec3(to_vec(axis)), SimTK::ZAxis), to_vec(origin)};
}

}  // namespace

SimbodyAnswer solve_with_simbody(const SimbodyProblem& problem) {
  const WithoutTraps of_ground;  // Simbody's ground has an infinite mass
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  const SimTK::Force::UniformGravity gravity(forces, matter, to_vec(problem.gravity_W));
  const SimTK::MobilizedBody::Free base(matter.Ground(),
                                        rigid(problem.base_mass, Vector3d::Zero(), problem.base_inertia));
  std::vector<SimTK::MobilizedBody> bodies;
  for (const SimbodyHinge& hinge : problem.hinges) {
    SimTK::MobilizedBody parent = base;
    if (hinge.parent >= 0) parent = bodies[static_cast<std::size_t>(hinge.parent)];
    bodies.push_back(SimTK::MobilizedBody::Pin(parent, hinge_frame(hinge.axis, hinge.origin),
                                               rigid(hinge.mass, hinge.center_of_mass, hinge.inertia),
                                               hinge_frame(hinge.axis, Vector3d::Zero())));
    SimTK::Force::MobilityConstantForce(forces, bodies.back(), hinge.torque);
  }
  SimTK::State state = system.realizeTopology();
  const Quaterniond& q = problem.orientation;
  base.setQToFitTransform(state,
                          {SimTK::Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z())), to_vec(problem.position)});
  base.setUToFitVelocity(state, {to_vec(problem.angular_velocity_W), to_vec(problem.velocity)});
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].setOneQ(state, 0, problem.hinges[i].angle);
    bodies[i].setOneU(state, 0, problem.hinges[i].rate);
  }
  system.realize(state, SimTK::Stage::Acceleration);
  const SimTK::SpatialVec& of_base = base.getBodyAcceleration(state);
  SimbodyAnswer answer{from_vec(of_base[1]), from_vec(of_base[0]), {}};
  for (const SimTK::MobilizedBody& body : bodies) answer.joint.push_back(body.getOneUDot(state, 0));
  return answer;
}

}  // namespace grouser::test
