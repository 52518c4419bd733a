/// Time of a step of the reference vehicle and of each of its stages, at rest and in run A's cruise.
#include <benchmark/benchmark.h>

#include <limits>
#include <stdexcept>

#include "simulator/assembly.h"
#include "simulator/bushings.h"
#include "simulator/contacts.h"
#include "simulator/drive.h"
#include "simulator/links.h"
#include "simulator/step.h"
#include "simulator/suspension.h"

namespace {

using namespace grouser;

constexpr double k_step = 1e-4;           // s, about the mean step of run A
constexpr double k_cruise_rate = 45.0;    // rad/s of the sprockets, 50 km/h
constexpr double k_acceleration = 22.5;   // rad/s^2
constexpr double k_time_in_cruise = 0.3;  // s

/// A vehicle in one state, with everything that a stage reads already computed.
struct Scene {
  System system;
  AssemblyKnobs knobs;
  State before, state;
  Acceleration acceleration_before, acceleration;
  Workspace work;
};

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

/// Run A's cruise, reached sooner than run A does.
Scene cruise_scene() {
  Scenario scenario = run_a();
  const double t = k_cruise_rate / k_acceleration;
  scenario.drive.fill({{0.0, t}, {0.0, k_cruise_rate}});
  return scene_after(scenario, t + k_time_in_cruise);
}

/// 0: at rest; 1: in cruise.
const Scene& scene(const benchmark::State& loop) {
  static const Scene rest = scene_after(run_a(), k_step), cruise = cruise_scene();
  return loop.range(0) == 0 ? rest : cruise;
}

/// Runs one stage on a copy of the scene again and again.
template <typename Stage>
void repeat(benchmark::State& loop, Stage stage) {
  Scene copy = scene(loop);
  for ([[maybe_unused]] const auto each : loop) {
    stage(copy);
    benchmark::ClobberMemory();
  }
}

/// Accepted steps: forces, accelerations, error control, update.
void step(benchmark::State& loop) {
  const Scene& start = scene(loop);
  Stepper stepper(start.system, start.state, start.knobs);
  const double t = stepper.state().time;
  for ([[maybe_unused]] const auto each : loop) {
    if (stepper.step(std::numeric_limits<double>::infinity()) != StepStatus::ok) loop.SkipWithError("the run failed");
  }
  loop.counters["real_time_factor"] =
      benchmark::Counter(stepper.state().time - t, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void evaluation(benchmark::State& loop) {
  repeat(loop,
         [](Scene& s) { evaluate(s.system, s.knobs, s.before.history, k_step, s.state, s.work, s.acceleration); });
}
void chassis_placement(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { place_tree(s.system.tree, s.state.chassis, s.system.gravity_W, s.work.chassis); });
}
void link_placement(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { place_links(s.system, s.state, s.work); });
}
void bushings(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { bushing_forces(s.system, s.knobs, s.before.history, k_step, s.state, s.work); });
}
void discs(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { disc_contacts(s.system, s.knobs, s.state, s.work); });
}
void sprockets(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { sprocket_contacts(s.system, s.knobs, s.state, s.work); });
}
void ground(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { ground_contacts(s.system, s.before.history, k_step, s.state, s.work); });
}
void suspension(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { suspension_forces(s.system, s.knobs, s.state, s.work); });
}
void drive(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { drive_sprockets(s.system, s.state, s.work, s.acceleration); });
}
void joint_sums(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { sum_joint_forces(s.system, s.work); });
}
void chassis_accelerations(benchmark::State& loop) {
  repeat(loop, [](Scene& s) {
    tree_accelerations(s.system.tree, s.state.chassis, s.work.prescribed_acceleration, s.work.chassis,
                       s.acceleration.chassis);
  });
}
void link_accelerations(benchmark::State& loop) {
  repeat(loop, [](Scene& s) { link_accelerations(s.system, s.knobs, s.state, s.work, s.acceleration); });
}
void error_estimate(benchmark::State& loop) {
  const ErrorWeights weights = error_weights(28.0 / 27.0, k_step, k_step);
  repeat(loop, [&](Scene& s) {
    benchmark::DoNotOptimize(link_error(s.system, weights, s.acceleration, s.acceleration_before, s.acceleration));
  });
}
void update(benchmark::State& loop) {
  repeat(loop, [](Scene& s) {
    benchmark::DoNotOptimize(
        advance(s.system, k_step, k_step, s.before, s.acceleration, s.acceleration_before, s.state));
  });
}

constexpr struct {
  const char* name;
  void (*stage)(benchmark::State&);
} k_stages[] = {{"step", step},
                {"evaluation", evaluation},
                {"place chassis", chassis_placement},
                {"place links", link_placement},
                {"bushings", bushings},
                {"discs and guides", discs},
                {"sprockets", sprockets},
                {"ground", ground},
                {"suspension", suspension},
                {"drive", drive},
                {"sums over joints", joint_sums},
                {"chassis accelerations", chassis_accelerations},
                {"link accelerations", link_accelerations},
                {"error estimate", error_estimate},
                {"update", update}};

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [name, stage] : k_stages)
    benchmark::RegisterBenchmark(name, stage)->ArgName("cruise")->Arg(0)->Arg(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
