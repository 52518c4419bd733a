// How large a law the data ask for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "identification/axis_fit.h"
#include "identification/leave_one_out.h"
#include "identification/nnls.h"
#include "model/errors.h"
#include "tests/identification/bench.h"
#include "tests/identification/law_campaign.h"

namespace grouser {
namespace {

AxisLaw plain_law() {
  AxisLaw law;
  law.spring = SpringSpline::linear(6.0e7, 1e-3);
  law.stops = {{1.5e7, 0.03e-3}, {1.0e7, 0.15e-3}};
  law.branches = {{1.2e7, 0.05}};
  return law;
}

std::vector<RigTest> loops_of(const AxisLaw& law) {
  std::vector<RigTest> tests;
  std::uint64_t seed = 10;
  for (const double amplitude : {0.1e-3, 0.3e-3, 0.9e-3}) {
    for (const double frequency : {0.2, 2.0, 20.0})
      tests.push_back(loop_of(law, Axis::x, amplitude, frequency, seed++));
  }
  return tests;
}

// A gain of its own for every mounting: what makes tests, not samples, the replicates.
std::vector<RigTest> remounted(std::vector<RigTest> tests) {
  PortableRandom random(7);
  for (RigTest& test : tests) {
    const double gain = 1.0 + 0.003 * random.normal();
    for (double& force : test.force) force *= gain;
  }
  return tests;
}

TEST(LeaveOneOut, IsTheErrorOfAFitThatNeverSawTheTest) {
  const LawCampaign campaign(loops_of(plain_law()));
  const Dictionary dictionary{MonotoneBasis(campaign.data.low, campaign.data.high, 8), {0.02e-3, 0.1e-3}, {0.02}};
  const LeftOut left_out =
      leave_one_out(campaign.data, dictionary, split_moments(campaign.data, dictionary, false), {});
  AxisData rest = campaign.data;
  rest.blocks.erase(rest.blocks.begin() + 4);
  const Eigen::MatrixXd sum = weighted_sum(block_moments(rest, dictionary, false), {}, dictionary);
  const Eigen::Index n = dictionary.num_linear();
  const Eigen::VectorXd c = solve_nnls(sum.topLeftCorner(n, n), sum.col(n).head(n)).x;
  const PreparedTest& test = *campaign.data.blocks[4].test;
  const TestFit predicted = evaluate_fit(test, replay(make_law(dictionary, c), test.time, test.displacement));
  EXPECT_NEAR(left_out.nrmse[4], predicted.nrmse, 0.01 * predicted.nrmse);  // ends of cycles are counted once more
}

TEST(LawSelection, TakesNoMoreElementsThanTheRubberHas) {
  const LawCampaign campaign(remounted(loops_of(plain_law())));
  const AxisSolution solution = fit_axis(campaign.data);
  EXPECT_LE(solution.dictionary.yields.size(), 3u);
  EXPECT_LE(solution.dictionary.relaxation_times.size(), 2u);
  EXPECT_EQ(solution.dictionary.yield_growth, 0.0);
  EXPECT_EQ(solution.dictionary.spring.intervals(), 8);
  EXPECT_EQ(std::ranges::count_if(solution.selection, &LawCandidate::chosen), 1);
  const LawCandidate& chosen = *std::ranges::find_if(solution.selection, &LawCandidate::chosen);
  EXPECT_EQ(chosen.stops, static_cast<int>(solution.dictionary.yields.size()));
  EXPECT_LT(chosen.left_out_error, 0.01);
  EXPECT_GE(solution.summary.starts, 3);
}

TEST(LawSelection, FindsYieldsThatGrow) {
  AxisLaw law = plain_law();
  law.spring = SpringSpline::linear(3.0e7, 1e-3);
  law.stops = {{5.0e7, 0.03e-3}, {3.0e7, 0.15e-3}};
  law.yield_growth = 3.0 / (0.9e-3 * 0.9e-3);  // four times at the largest stroke
  const LawCampaign campaign(remounted(loops_of(law)));
  const AxisSolution solution = fit_axis(campaign.data);
  EXPECT_NEAR(solution.dictionary.yield_growth, law.yield_growth, 0.1 * law.yield_growth);
  const AxisLaw fitted = make_law(solution.dictionary, solution.coefficients);
  for (const PreparedTest& test : campaign.tests) {
    const TestFit fit = evaluate_fit(test, replay(fitted, test.time, test.displacement));
    EXPECT_LT(fit.nrmse, 2.0 * k_law_noise + 0.002);  // noise, and the gains of the mountings
    EXPECT_NEAR(fit.fitted.dissipated_energy, fit.measured.dissipated_energy, 0.02 * fit.measured.dissipated_energy);
  }
}

TEST(LawSelection, LeavesOutBlocksWhereThereIsOneTest) {
  const LawCampaign one({loop_of(plain_law(), Axis::x, 0.3e-3, 2.0, 1)});
  EXPECT_EQ(replicates(one.data).size(), one.data.blocks.size());
  EXPECT_GT(one.data.blocks.size(), 1u);  // its cycles
  const LawCampaign several(loops_of(plain_law()));
  EXPECT_EQ(replicates(several.data).size(), several.tests.size());
}

TEST(FitAxis, FailsRatherThanReturnWhatIsNotOptimal) {
  const LawCampaign campaign(loops_of(plain_law()));
  try {
    (void)fit_axis(campaign.data, {.max_iterations = 1});
    FAIL() << "one iteration cannot converge";
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("did not converge"));
  }
}

TEST(FitAxis, EndsAtAPointWhereNoParameterWantsToMove) {
  const LawCampaign campaign(remounted(loops_of(plain_law())));
  const AxisSolution solution = fit_axis(campaign.data);
  const auto cost = [&](const Dictionary& dictionary) {
    const Eigen::MatrixXd sum = weighted_sum(block_moments(campaign.data, dictionary, false), {}, dictionary);
    const Eigen::Index n = dictionary.num_linear();
    return sum(n, n) - solve_nnls(sum.topLeftCorner(n, n), sum.col(n).head(n)).x.dot(sum.col(n).head(n));
  };
  const double best = cost(solution.dictionary);
  for (const double factor : {0.97, 1.03}) {
    for (std::size_t j = 0; j < solution.dictionary.yields.size(); ++j) {
      Dictionary moved = solution.dictionary;
      moved.yields[j] *= factor;
      EXPECT_GE(cost(moved), best * (1.0 - 1e-5)) << j;  // 1e-5: where the search stops
    }
    for (std::size_t k = 0; k < solution.dictionary.relaxation_times.size(); ++k) {
      Dictionary moved = solution.dictionary;
      moved.relaxation_times[k] *= factor;
      EXPECT_GE(cost(moved), best * (1.0 - 1e-5)) << k;
    }
  }
}

}  // namespace
}  // namespace grouser
