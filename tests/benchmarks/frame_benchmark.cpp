/// Time of a frame of the reference vehicle at 1280 x 720 with shadow and 4 x multisampling, without a run and without
/// encoding. The column CPU is that of all threads: the measure on a machine that does other work too.
#include <benchmark/benchmark.h>

#include "render/ground_section.h"
#include "render/scene_renderer.h"

namespace {

using namespace grouser;

constexpr int k_width = 1280, k_height = 720;

void frame(benchmark::State& loop, const char* camera) {
  const Vehicle vehicle = read_vehicle(GROUSER_SOURCE_DIR "/test_data/vehicles/reference.json");
  const VehicleModel model(vehicle);
  const GlContext context(k_width * k_height);
  SceneRenderer renderer(context, k_width, k_height);
  double travel = 0.0;
  constexpr float k_aspect = static_cast<float>(k_width) / k_height;
  const auto draw = [&] {
    const VehiclePose pose = design_pose(vehicle, travel += 0.02);
    Scene scene = model.place(pose);
    scene.camera = make_camera(camera, model.subject(pose, 0.0), k_aspect);
    if (scene.camera.shows_section()) scene.section = ground_section(GroundSurface({}, 2.8), scene.camera, k_aspect);
    renderer.draw(scene);
    benchmark::DoNotOptimize(renderer.read().bgr.data());
  };
  draw();  // compiles the shaders
  for ([[maybe_unused]] const auto each : loop) draw();
  loop.counters["triangles"] = static_cast<double>(renderer.num_triangles());
  loop.counters["frames_per_second"] =
      benchmark::Counter(static_cast<double>(loop.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(frame, chase, "chase")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, side, "side")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, front, "front")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, sprocket, "sprocket")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, road_wheel, "road_wheel")
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, top, "top")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, orbit, "orbit")->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
