#include "model/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "model/provenance.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

FitRecord record() {
  FitRecord fit;
  fit.specimen = "track bushing";
  fit.synthetic = true;
  fit.synthetic_note = "generated, seed 20261122";
  for (const Axis axis : {Axis::x, Axis::ry}) {
    TestFit& test = fit.tests.emplace_back();
    test.name = std::string("loop ") + name_of(axis);
    test.axis = axis;
    test.samples = 4000;
    test.cycles = 8;
    test.cycles_used = 5;
    test.measured = {1e8, 12.5, 2e4, 0.1, 0.97e8, 0.98e8, 0.99e7};
    test.fitted = {1.01e8, 12.4, 1.9e4, 0.098, 0.96e8, 0.95e8, 0.94e7};
    test.r_squared = 0.999;
    test.gain = 0.003;
    test.weight = 0.7;
    test.force_zero = 300.0;
    test.force_drift = -200.0;
    test.left_out_nrmse = 0.013;
    test.per_cycle.push_back({1, false, "conditioning", 1e-3, test.measured, test.fitted, 0.01});
    test.curve = {{0.0, 1e-3}, {0.0, 1e5}, {0.0, 1.01e5}};
    AxisFit& fitted = fit.axes.emplace_back();
    fitted.axis = axis;
    fitted.parameters.push_back({"stop[0].stiffness", "N/m", 1e7, 2e5, 0.96e7, 1.04e7, true});
    fitted.covariance = {{4e10}};
    fitted.condition_number = std::numeric_limits<double>::infinity();
    fitted.solver = {"CONVERGENCE", 12, 2.0, 1.0, 1e-9, 5};
    fitted.responses.push_back(
        {2e-4, 5.0, {2.0, 1.9, 2.1}, {1e8, 0.9e8, 1.1e8}, {1e7, 0.9e7, 1.1e7}, {0.1, 0.09, 0.11}});
    fitted.selection = {{12, 4, 3, false, 0.011, false}, {14, 4, 4, true, 0.009, true}};
    fitted.clearance = Clearance{-1e-4, 2e-4, 0.03};
    fitted.hard_stops = {{-0.9e-3, 12.0}, {0.9e-3, 11.0}};
    fitted.preset = 0.25;
    fitted.draws = 120;
    fitted.backbone = {{0.0, 0.0, -1.0, 1.0}, {1e-3, 1e5, 0.99e5, 1.01e5}};
    fitted.tangent = {{0.0, 1e8, 0.9e8, 1.1e8}};
    fitted.tangent_window = 1e-4;
  }
  fit.warnings.push_back({"drift", "loop x", "the zero moved by 3 % of the range"});
  fit.corrections.push_back({"reverse_force", "loop x", "the sign of 4000 samples was changed"});
  return fit;
}

TEST(FitFile, SurvivesWritingAndReading) {
  const TemporaryFolder folder;
  write_fit(record(), folder.path() / "fit.json");
  const FitRecord again = read_fit(folder.path() / "fit.json");
  ASSERT_EQ(again.tests.size(), 2u);
  EXPECT_EQ(again.tests[1].measured.effective_stiffness, 1e8);
  EXPECT_EQ(again.tests[1].fitted.loss_factor, 0.098);
  EXPECT_EQ(again.tests[0].per_cycle.at(0).note, "conditioning");
  EXPECT_EQ(again.tests[0].curve.fitted, record().tests[0].curve.fitted);
  ASSERT_EQ(again.axes.size(), 2u);
  EXPECT_EQ(again.axes[1].axis, Axis::ry);
  EXPECT_EQ(again.axes[0].parameters.at(0).high, 1.04e7);
  EXPECT_EQ(again.axes[0].covariance.at(0).at(0), 4e10);
  EXPECT_EQ(again.axes[0].backbone.at(1).low, 0.99e5);
  EXPECT_TRUE(std::isnan(again.axes[0].condition_number));  // JSON knows no infinity: written as null
  EXPECT_EQ(again.warnings.at(0).code, "drift");
  EXPECT_EQ(again.corrections.at(0).code, "reverse_force");
  EXPECT_EQ(again.corrections.at(0).text, record().corrections.at(0).text);
}

TEST(FitFile, GivesTheSameBytesWhenWrittenAgain) {
  // Every member that is written is also read: one that the reader drops would come back as its default.
  const TemporaryFolder folder;
  write_fit(record(), folder.path() / "a.json");
  write_fit(read_fit(folder.path() / "a.json"), folder.path() / "b.json");
  EXPECT_EQ(read_whole(folder.path() / "b.json"), read_whole(folder.path() / "a.json"));
}

TEST(FitFile, KeepsTheResponseAndWhatTheJointShows) {
  const TemporaryFolder folder;
  write_fit(record(), folder.path() / "fit.json");
  const AxisFit axis = read_fit(folder.path() / "fit.json").axes.at(1);
  EXPECT_EQ(axis.solver.starts, 5);
  EXPECT_EQ(axis.responses.at(0).frequency, 5.0);
  EXPECT_EQ(axis.responses.at(0).energy.high, 2.1);
  EXPECT_EQ(axis.responses.at(0).storage_stiffness.low, 0.9e8);
  EXPECT_EQ(axis.responses.at(0).loss_stiffness.value, 1e7);
  EXPECT_EQ(axis.responses.at(0).loss_factor.value, 0.1);
  EXPECT_EQ(axis.selection.at(1).branches, 4);
  EXPECT_TRUE(axis.selection.at(1).strain_dependent_yield);
  EXPECT_TRUE(axis.selection.at(1).chosen);
  ASSERT_TRUE(axis.clearance);
  EXPECT_EQ(axis.clearance->high, 2e-4);
  EXPECT_EQ(axis.hard_stops.at(1).stiffness_ratio, 11.0);
  EXPECT_EQ(axis.preset, 0.25);
  EXPECT_EQ(axis.draws, 120);
}

TEST(FitFile, KeepsWhatTheFitTookOutOfATest) {
  const TemporaryFolder folder;
  write_fit(record(), folder.path() / "fit.json");
  const TestFit test = read_fit(folder.path() / "fit.json").tests.at(0);
  EXPECT_EQ(test.gain, 0.003);
  EXPECT_EQ(test.weight, 0.7);
  EXPECT_EQ(test.force_zero, 300.0);
  EXPECT_EQ(test.force_drift, -200.0);
  EXPECT_EQ(test.left_out_nrmse, 0.013);
}

TEST(FitFile, NamesTheMeasuresByTheirAxis) {
  const TemporaryFolder folder;
  write_fit(record(), folder.path() / "fit.json");
  const auto json = nlohmann::json::parse(read_whole(folder.path() / "fit.json"));
  EXPECT_EQ(json["tests"][0]["effective_stiffness_N_per_m"], 1e8);
  EXPECT_EQ(json["tests"][0]["equivalent_damping_N_s_per_m"], 2e4);
  EXPECT_EQ(json["tests"][1]["effective_stiffness_N_m_per_rad"], 1e8);
  EXPECT_EQ(json["tests"][1]["per_cycle"][0]["equivalent_damping_N_m_s_per_rad"], 2e4);
  EXPECT_EQ(json["tests"][1]["dissipated_energy_J"], 12.5);
  EXPECT_EQ(json["tests"][0]["secant_stiffness_N_per_m"], 0.97e8);
  EXPECT_EQ(json["tests"][0]["storage_stiffness_N_per_m"], 0.98e8);
  EXPECT_EQ(json["tests"][1]["fitted"]["loss_stiffness_N_m_per_rad"], 0.94e7);
  EXPECT_EQ(json["tests"][1]["force_drift_N_m"], -200.0);
  EXPECT_EQ(json["axes"]["ry"]["responses"][0]["storage_stiffness_N_m_per_rad"]["value"], 1e8);
  EXPECT_EQ(json["axes"]["ry"]["preset_rad"], 0.25);
}

}  // namespace
}  // namespace grouser
