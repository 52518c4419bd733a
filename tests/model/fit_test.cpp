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
    test.measured = {1e8, 12.5, 2e4, 0.1};
    test.fitted = {1.01e8, 12.4, 1.9e4, 0.098};
    test.r_squared = 0.999;
    test.per_cycle.push_back({1, false, "conditioning", 1e-3, test.measured, test.fitted, 0.01});
    test.curve = {{0.0, 1e-3}, {0.0, 1e5}, {0.0, 1.01e5}};
    AxisFit& fitted = fit.axes.emplace_back();
    fitted.axis = axis;
    fitted.parameters.push_back({"stop[0].stiffness", "N/m", 1e7, 2e5, 0.96e7, 1.04e7, true});
    fitted.covariance = {{4e10}};
    fitted.condition_number = std::numeric_limits<double>::infinity();
    fitted.solver = {"CONVERGENCE", 12, 2.0, 1.0, 1e-9};
    fitted.backbone = {{0.0, 0.0, -1.0, 1.0}, {1e-3, 1e5, 0.99e5, 1.01e5}};
    fitted.tangent = {{0.0, 1e8, 0.9e8, 1.1e8}};
    fitted.tangent_window = 1e-4;
  }
  fit.warnings.push_back({"drift", "loop x", "the zero moved by 3 % of the range"});
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
}

}  // namespace
}  // namespace grouser
