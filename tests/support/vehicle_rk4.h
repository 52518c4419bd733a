#pragma once
#include "simulator/step.h"

/// The whole vehicle under the classical Runge-Kutta method: an integrator that shares nothing with the program's but
/// the equations of motion.
namespace grouser::test {

/// Four evaluations a step (Kutta 1901); orientations as quaternions with q' = q (0, w) / 2, unit again after every
/// stage. Rubber and ground friction move on from the memory of the last whole step in every stage, so that it is
/// committed once a step, as in a run; at their kinks the order falls to 2.
class VehicleRk4 {
 public:
  VehicleRk4(const System& system, State start, const AssemblyKnobs& knobs);
  void step(double h);
  [[nodiscard]] const State& state() const { return now_; }

 private:
  /// Evaluates `state`, h after the last whole step.
  void evaluate_at(double h, State& state, Acceleration& acceleration);

  const System& system_;
  AssemblyKnobs knobs_;
  State now_, stage_, next_;
  History before_;
  Workspace work_;
  Acceleration a_now_, a_stage_;
};

}  // namespace grouser::test
