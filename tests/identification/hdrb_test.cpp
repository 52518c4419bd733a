// Measured rubber: quasi-static shear of a full-scale high damping bearing (Gallardo et al. 2023, Eng. Struct.
// 289:116234), with the reference table of its 27 cycles. The data stay outside the repository.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "identification/identify.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

constexpr double k_tonf = 9806.65, k_cm = 1e-2;

const fs::path k_data = fs::path(GROUSER_SOURCE_DIR) / "../shared/references/measurements/hdrb_bearing";

struct ReferenceCycle {
  double amplitude = 0.0, secant = 0.0, energy = 0.0;  // SI
  bool transition = false;
};

std::vector<ReferenceCycle> reference_table() {
  std::ifstream file(k_data / "reference_cycles.csv");
  std::string line;
  std::getline(file, line);
  std::vector<ReferenceCycle> table;
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    table.push_back({std::stod(cells[4]) * k_cm, std::stod(cells[6]) * k_tonf / k_cm,
                     std::stod(cells[7]) * k_tonf * k_cm, cells[3] == "transition"});
  }
  return table;
}

class Hdrb : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(k_data / "hdrb_cyclic_shear.csv")) GTEST_SKIP() << "measured data are absent: " << k_data;
    folder_ = fs::temp_directory_path() /
              ("grouser_hdrb_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
    fs::copy_file(k_data / "hdrb_cyclic_shear.csv", folder_ / "shear.csv", fs::copy_options::overwrite_existing);
    std::ofstream(folder_ / "rig.json")
        << R"({"format": "grouser.rig/1", "specimen": {"name": "high damping rubber bearing"},
      "tests": [{"name": "shear", "axis": "x", "kind": "cyclic", "file": "shear.csv",
                 "columns": {"displacement": "d_cm", "force": "f_tonf"}}]})";
    result_ = identify(read_rig(folder_ / "rig.json"));
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
  IdentifyResult result_;
};

TEST_F(Hdrb, LoopsAreMeasuredAsInTheReferenceTable) {
  const std::vector<ReferenceCycle> table = reference_table();
  const std::vector<CycleFit>& cycles = result_.fit.tests[0].per_cycle;
  ASSERT_EQ(cycles.size(), 27u);
  ASSERT_EQ(table.size(), 27u);
  for (std::size_t k = 0; k < 27; ++k) {
    EXPECT_NEAR(cycles[k].measured.dissipated_energy, table[k].energy, 0.005 * table[k].energy) << "cycle " << k + 1;
    // The table takes the force at the single samples of extreme displacement; their noise is most of what remains.
    EXPECT_NEAR(cycles[k].measured.secant_stiffness, table[k].secant, 0.01 * table[k].secant) << "cycle " << k + 1;
    EXPECT_NEAR(cycles[k].amplitude, table[k].amplitude, 5e-4 * table[k].amplitude) << "cycle " << k + 1;
    EXPECT_EQ(cycles[k].note == "transition", table[k].transition) << "cycle " << k + 1;
  }
}

// One parameter set for all amplitudes; the published bar of force is 3 % an amplitude, that of energy 5 %.
TEST_F(Hdrb, OneParameterSetFitsForceAndEnergyOfEveryAmplitude) {
  struct Sums {
    double nrmse = 0.0, energy = 0.0, cycles = 0.0;
  };
  std::map<long, Sums> amplitudes;  // used cycles, by amplitude in cm
  for (const CycleFit& cycle : result_.fit.tests[0].per_cycle) {
    if (!cycle.used) continue;
    Sums& sums = amplitudes[std::lround(1e2 * cycle.amplitude)];
    sums.nrmse += cycle.nrmse;
    sums.energy += cycle.fitted.dissipated_energy / cycle.measured.dissipated_energy - 1.0;
    sums.cycles += 1.0;
  }
  ASSERT_EQ(amplitudes.size(), 4u);
  for (const auto& [amplitude, sums] : amplitudes) {
    EXPECT_LT(sums.nrmse / sums.cycles, 0.03) << amplitude << " cm";             // 1.9 to 2.6 % measured
    EXPECT_LT(std::abs(sums.energy / sums.cycles), 0.05) << amplitude << " cm";  // 1.3 % at most measured
  }
}

TEST_F(Hdrb, WantsYieldsThatGrowWithStrain) {
  EXPECT_GT(result_.bushing.axis(Axis::x).yield_growth, 0.0);
  EXPECT_LE(result_.bushing.axis(Axis::x).stops.size(), 4u);
}

TEST_F(Hdrb, IsFittedWithoutRateAndSaysSo) {
  EXPECT_TRUE(result_.bushing.axis(Axis::x).branches.empty());
  EXPECT_FALSE(result_.bushing.axis(Axis::x).stops.empty());
  EXPECT_TRUE(std::ranges::any_of(result_.fit.warnings, [](const FitWarning& w) { return w.code == "rate_unknown"; }));
}

}  // namespace
}  // namespace grouser
