#include "tests/benchmarks/stages.h"

#include <benchmark/benchmark.h>

#include <stdexcept>

#include "simulator/bushings.h"
#include "simulator/contacts.h"
#include "simulator/drive.h"
#include "simulator/links.h"
#include "simulator/suspension.h"

namespace grouser::benchmarks {
namespace {

Scenario run_a() { return read_scenario(GROUSER_SOURCE_DIR "/test_data/scenarios/run_a.json"); }

Scene scene_after(const Scenario& scenario, double duration) {
  const System system = compile(scenario);
  const Assembled rest = assemble(system);
  Stepper stepper(system, rest.state, rest.knobs);
  do {
    if (stepper.step(duration) != StepStatus::ok) throw std::runtime_error("the run failed");
  } while (stepper.state().time < duration);
  return {system,
          rest.knobs,
          stepper.previous_state(),
          stepper.state(),
          stepper.previous_acceleration(),
          stepper.acceleration(),
          stepper.work()};
}

constexpr Stage k_stages[] = {
    {"evaluation",
     [](Scene& s) { evaluate(s.system, s.knobs, s.before.history, k_step, s.state, s.work, s.acceleration); }},
    {"place chassis", [](Scene& s) { place_tree(s.system.tree, s.state.chassis, s.system.gravity_W, s.work.chassis); }},
    {"place links", [](Scene& s) { place_links(s.system, s.state, s.work); }},
    {"bushings", [](Scene& s) { bushing_forces(s.system, s.knobs, s.before.history, k_step, s.state, s.work); }},
    {"discs and guides", [](Scene& s) { disc_contacts(s.system, s.knobs, s.state, s.work); }},
    {"sprockets", [](Scene& s) { sprocket_contacts(s.system, s.knobs, s.state, s.work); }},
    {"ground", [](Scene& s) { ground_contacts(s.system, s.before.history, k_step, s.state, s.work); }},
    {"suspension", [](Scene& s) { suspension_forces(s.knobs, s.state, s.work); }},
    {"drive", [](Scene& s) { drive_sprockets(s.system, s.state, s.work, s.acceleration); }},
    {"chassis accelerations",
     [](Scene& s) {
       tree_accelerations(s.system.tree, s.state.chassis, s.work.prescribed_acceleration, s.work.chassis,
                          s.acceleration.chassis);
     }},
    {"link accelerations", [](Scene& s) { link_accelerations(s.system, s.knobs, s.state, s.work, s.acceleration); }},
    {"errors and losses",
     [](Scene& s) {
       const double beta = s.system.scenario.integrator.beta;
       benchmark::DoNotOptimize(judge_links(s.system, error_weights(beta, k_step, k_step),
                                            step_weights(beta, k_step, k_step),
                                            {s.work, s.work, s.acceleration_before, s.acceleration, s.acceleration}));
     }},
    {"update", [](Scene& s) {
       benchmark::DoNotOptimize(
           advance(s.system, k_step, k_step, s.before, s.acceleration, s.acceleration_before, s.state));
     }}};

}  // namespace

const Scene& rest_scene() {
  static const Scene scene = scene_after(run_a(), k_step);
  return scene;
}

const Scene& cruise_scene() {
  constexpr double k_rate = 45.0, k_rise = 2.0, k_held = 0.3;  // rad/s of the sprockets, s, s: sooner than run A does
  static const Scene scene = [] {
    Scenario scenario = run_a();
    scenario.drive.fill({{0.0, k_rise}, {0.0, k_rate}});
    return scene_after(scenario, k_rise + k_held);
  }();
  return scene;
}

std::span<const Stage> stages() { return k_stages; }

}  // namespace grouser::benchmarks
