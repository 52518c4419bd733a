#pragma once
#include <cmath>
#include <stdexcept>

#include "simulator/bushings.h"
#include "tests/support/scenes.h"

namespace grouser::test {

/// Two links in a row, pulled apart by x(t). Joint 1 closes the chain backwards and moves by -x, so that energies and
/// losses are twice those of one joint; it stands two pitches from its groove, though, where a growing yield is out of
/// reach: then it slips nowhere.
class PulledPair {
 public:
  explicit PulledPair(const Bushing& bushing)
      : system_(compile(parked(bare_vehicle(2), bushing, 0.0))),
        state(strewn_state(system_)),
        work(make_workspace(system_)) {
    system_.tracks[1].num_links = 0;
    place(0.0, 0.0);
    relax_rubber(system_, state);
    history_ = state.history;
  }
  /// One step of length h to stretch x at rate v; books the losses.
  void step(double x, double v, double h) {
    place(x, v);
    work.energy = {};
    place_links(system_, state, work);
    bushing_forces(system_, {}, history_, h, state, work);
    history_ = state.history;
    step_loss += 0.5 * work.energy.bushing_step_loss;
    if (work.energy.bushing_step_loss < -1e-12) throw std::runtime_error("a step of the rubber gained energy");
  }
  [[nodiscard]] double force(int joint = 0) const { return work.bushing_force[0][joint]; }

 private:
  void place(double x, double v) {
    LinkMotion b;
    b.position.x() = system_.tracks[0].pitch + x;
    b.velocity.x() = v;
    set_link(state, 0, {});
    set_link(state, 1, b);
    close_chains(system_, state);
  }
  System system_;
  History history_;

 public:
  State state;
  Workspace work;
  double step_loss = 0.0;  ///< J, of one joint
};

/// Loss of one cycle [J] and force in phase with the stretch and with its rate, over the amplitude [N/m].
struct Harmonic {
  double loss, in_phase, out_of_phase;
};
/// The sixtieth cycle of x = amplitude sin(omega t).
inline Harmonic shake(const Bushing& bushing, double omega, double amplitude, int steps_a_cycle) {
  PulledPair pair(bushing);
  const double h = 2.0 * k_pi / omega / steps_a_cycle;
  Harmonic result{0.0, 0.0, 0.0};
  constexpr int k_cycles = 60;
  for (int i = 1; i <= k_cycles * steps_a_cycle; ++i) {
    if (i == (k_cycles - 1) * steps_a_cycle + 1) pair.step_loss = 0.0;
    const double phase = 2.0 * k_pi * i / steps_a_cycle;
    pair.step(amplitude * std::sin(phase), amplitude * omega * std::cos(phase), h);
    if (i <= (k_cycles - 1) * steps_a_cycle) continue;
    result.in_phase += 2.0 / steps_a_cycle / amplitude * pair.force() * std::sin(phase);
    result.out_of_phase += 2.0 / steps_a_cycle / amplitude * pair.force() * std::cos(phase);
  }
  result.loss = pair.step_loss;
  return result;
}

}  // namespace grouser::test
