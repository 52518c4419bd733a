// Cost of an identification over all six axes, intervals included, for 1e4 .. 1e7 samples: counters show nanoseconds a
// sample and, at the end, the order of growth. Beside it: the same number of samples read from CSV, and one spline
// fitted by brute force (one Ceres residual a sample, bounds on the increments), which is what one would write first.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>

#include "identification/identify.h"
#include "identification/monotone_basis.h"
#include "model/bushing_law.h"

namespace grouser {
namespace {

// Loops of a law on all axes: three amplitudes and three frequencies each, ten cycles a test.
RigTest loop(Axis axis, double amplitude, double frequency, std::size_t samples) {
  constexpr int cycles = 10;
  RigTest test;
  test.name = fmt::format("{}_{}_{}", name_of(axis), amplitude, frequency);
  test.axis = axis;
  test.frequency = frequency;
  test.time_measured = true;
  double stop = 0.0, branch = 0.0, before = 0.0;
  const double step = cycles / frequency / static_cast<double>(samples);
  const MaxwellStep maxwell = maxwell_step({1e7, 0.02}, step);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = step * static_cast<double>(i);
    const double x = amplitude * std::sin(2.0 * std::numbers::pi * frequency * t);
    stop = advance_stop(stop, x - before, 0.05e-3);
    branch = maxwell.decay * branch + maxwell.gain * (x - before);
    before = x;
    test.time.push_back(t);
    test.displacement.push_back(x);
    test.force.push_back(6e7 * x + 2e13 * x * x * x + 2e7 * stop + branch);
  }
  return test;
}

const RigRecord& campaign(std::size_t samples) {
  static std::map<std::size_t, RigRecord> made;
  RigRecord& rig = made[samples];
  if (!rig.tests.empty()) return rig;
  for (int a = 0; a < k_num_axes; ++a) {
    for (const double amplitude : {0.1e-3, 0.3e-3, 1e-3}) {
      for (const double frequency : {0.1, 2.0, 30.0}) {
        rig.tests.push_back(loop(static_cast<Axis>(a), amplitude, frequency, samples / (9 * k_num_axes)));
      }
    }
  }
  return rig;
}

void per_sample(benchmark::State& state, std::int64_t samples) {
  // inverted rate of samples: seconds a sample, shown with its SI prefix
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(samples), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetComplexityN(samples);
}

void identify_six_axes(benchmark::State& state) {
  const RigRecord& rig = campaign(static_cast<std::size_t>(state.range(0)));
  for ([[maybe_unused]] const auto each : state) benchmark::DoNotOptimize(identify(rig).draws.size());
  per_sample(state, state.range(0));
}
BENCHMARK(identify_six_axes)
    ->RangeMultiplier(10)
    ->Range(10'000, 10'000'000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

// time, displacement, force, as a rig writes them
std::filesystem::path csv_campaign(std::int64_t samples) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("grouser_csv_{}", samples);
  std::filesystem::create_directories(folder);
  std::ofstream csv(folder / "loop.csv");
  csv << "time_s,displacement_mm,force_kN\n";
  const RigTest test = loop(Axis::x, 1e-3, 1.0, static_cast<std::size_t>(samples));
  for (std::size_t i = 0; i < test.time.size(); ++i) {
    csv << fmt::format("{:.6f},{:.6f},{:.5f}\n", test.time[i], 1e3 * test.displacement[i], 1e-3 * test.force[i]);
  }
  std::ofstream rig(folder / "rig.json");
  rig << R"({"format": "grouser.rig/1", "specimen": {"name": "s"}, "tests": [)"
      << R"({"name": "loop", "axis": "x", "kind": "cyclic", "file": "loop.csv", "frequency_Hz": 1.0}]})";
  return folder;
}

void read_csv(benchmark::State& state) {
  const std::filesystem::path folder = csv_campaign(state.range(0));
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(folder / "loop.csv"));
  for ([[maybe_unused]] const auto each : state) benchmark::DoNotOptimize(read_rig(folder / "rig.json").tests.size());
  state.SetBytesProcessed(state.iterations() * bytes);
  per_sample(state, state.range(0));
  std::filesystem::remove_all(folder);
}
BENCHMARK(read_csv)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

// Force less sum_j increment_j I_j(x) of one sample.
class SplineResidual : public ceres::SizedCostFunction<1, 16> {
 public:
  SplineResidual(const MonotoneBasis& basis, double x, double force) : force_(force) { basis.evaluate(x, row_.data()); }
  bool Evaluate(double const* const* increments, double* residual, double** jacobians) const override {
    residual[0] = force_;
    for (std::size_t j = 0; j < row_.size(); ++j) residual[0] -= row_[j] * increments[0][j];
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    for (std::size_t j = 0; j < row_.size(); ++j) jacobians[0][j] = -row_[j];
    return true;
  }

 private:
  std::array<double, 16> row_{};
  double force_;
};

void brute_force_spline(benchmark::State& state) {
  const RigTest test = loop(Axis::x, 1e-3, 1.0, static_cast<std::size_t>(state.range(0)));
  const MonotoneBasis basis(-1e-3, 1e-3, 14);
  for ([[maybe_unused]] const auto each : state) {
    std::array<double, 16> increments;
    increments.fill(1e4);
    ceres::Problem problem;
    for (std::size_t i = 0; i < test.force.size(); ++i) {
      problem.AddResidualBlock(new SplineResidual(basis, test.displacement[i], test.force[i]), nullptr,
                               increments.data());
    }
    for (int j = 0; j < 16; ++j) problem.SetParameterLowerBound(increments.data(), j, 0.0);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    benchmark::DoNotOptimize(summary.final_cost);
  }
  per_sample(state, state.range(0));
}
BENCHMARK(brute_force_spline)->Arg(10'000)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace grouser

BENCHMARK_MAIN();
