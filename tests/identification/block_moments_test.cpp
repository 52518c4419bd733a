// Normal equations in one pass against the rows written out.
#include "identification/block_moments.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "identification/nnls.h"
#include "identification/thin_axis.h"
#include "tests/identification/bench.h"
#include "tests/identification/law_campaign.h"

namespace grouser {
namespace {

AxisLaw small_law() {
  AxisLaw law;
  law.spring = SpringSpline::linear(5.0e7, 1e-3);
  law.stops = {{2.0e7, 0.02e-3}, {1.0e7, 0.1e-3}};
  law.branches = {{1.0e7, 0.03}};
  return law;
}

Dictionary small_dictionary(const AxisData& data, double growth) {
  return {MonotoneBasis(data.low, data.high, 9, data.symmetry), {0.015e-3, 0.12e-3}, {0.02, 0.3}, growth};
}

// Force of a law along the test at its used rows, offset and drift projected out.
Eigen::VectorXd projected(const DataBlock& block, const std::vector<double>& force) {
  std::vector<double> rows, position;
  for (std::size_t c = 0; c < block.cycles.size(); ++c) {
    const CycleSpan span = block.cycles[c];
    const bool touches = c > 0 && block.cycles[c - 1].end == span.begin;
    for (std::size_t i = span.begin + (touches ? 1 : 0); i <= span.end; ++i) {
      rows.push_back(force[i]);
      position.push_back(static_cast<double>(i));
    }
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd nuisance = Eigen::MatrixXd::Ones(n, block.with_drift ? 2 : 1);
  if (block.with_drift) nuisance.col(1) = Eigen::Map<Eigen::VectorXd>(position.data(), n);
  const Eigen::VectorXd f = Eigen::Map<Eigen::VectorXd>(rows.data(), n);
  return f - nuisance * nuisance.colPivHouseholderQr().solve(f);
}

TEST(BlockMoments, AreThoseOfTheRowsWrittenOut) {
  for (const Axis axis : {Axis::x, Axis::y}) {  // a free and an odd spring
    const LawCampaign campaign({loop_of(small_law(), axis, 0.4e-3, 3.0, 1)});
    const DataBlock& block = campaign.data.blocks.front();
    const Dictionary dictionary = small_dictionary(campaign.data, 2.0e6);
    const BlockMoments moments = split_moments(campaign.data, dictionary, true).front();
    const Eigen::Index n = dictionary.num_linear(), force = moments.force.cols() - 1;
    std::vector<Eigen::VectorXd> columns;
    for (Eigen::Index j = 0; j < n; ++j) {
      const AxisLaw one = make_law(dictionary, Eigen::VectorXd::Unit(n, j));
      columns.push_back(projected(block, replay(one, block.test->time, block.test->displacement)));
    }
    columns.push_back(projected(block, block.test->force));
    const double scale = columns.back().squaredNorm();
    for (Eigen::Index i = 0; i <= n; ++i) {
      for (Eigen::Index j = 0; j <= n; ++j) {
        const double direct = columns[static_cast<std::size_t>(i)].dot(columns[static_cast<std::size_t>(j)]);
        const double streamed = moments.force(i == n ? force : i, j == n ? force : j) / block.row_weight();
        const double size = columns[static_cast<std::size_t>(i)].norm() * columns[static_cast<std::size_t>(j)].norm();
        EXPECT_NEAR(streamed, direct, 1e-8 * size + 1e-20 * scale) << i << ", " << j;  // round-off of the projection
      }
    }
  }
}

TEST(BlockMoments, KnowTheDerivativesByEveryNonlinearParameter) {
  const LawCampaign campaign({loop_of(small_law(), Axis::x, 0.4e-3, 3.0, 2)});
  const DataBlock& block = campaign.data.blocks.front();
  const Dictionary dictionary = small_dictionary(campaign.data, 2.0e6);
  Eigen::VectorXd c = Eigen::VectorXd::Constant(dictionary.num_linear(), 1.0e3);
  c.tail(4) << 2.0e7, 1.0e7, 1.0e7, 0.5e7;
  const BlockMoments moments = split_moments(campaign.data, dictionary, true).front();
  const Eigen::MatrixXd weights = derivative_weights(dictionary, c);
  const Eigen::VectorXd streamed =
      weights.transpose() * moments.force.col(moments.force.cols() - 1).segment(c.size(), weights.rows());
  const auto forces = [&](int parameter, double nudge) {
    Dictionary moved = dictionary;
    const double factor = std::exp(nudge);
    if (parameter < 2) moved.yields[static_cast<std::size_t>(parameter)] *= factor;
    if (parameter == 2 || parameter == 3) moved.relaxation_times[static_cast<std::size_t>(parameter) - 2] *= factor;
    if (parameter == 4) moved.yield_growth *= factor;
    return projected(block, replay(make_law(moved, c), block.test->time, block.test->displacement));
  };
  const Eigen::VectorXd force = projected(block, block.test->force);
  ASSERT_EQ(streamed.size(), 5);
  for (int p = 0; p < 5; ++p) {
    const Eigen::VectorXd slope = (forces(p, 1e-5) - forces(p, -1e-5)) / 2e-5;
    const double direct = block.row_weight() * slope.dot(force);
    // samples that start to slip between the two sides: a share of 1e-5 of the loop
    EXPECT_NEAR(streamed(p), direct, 1e-4 * block.row_weight() * slope.norm() * force.norm()) << p;
    EXPECT_GT(slope.norm(), 1e-3 * force.norm());
  }
}

TEST(ThinAxis, IsOfOneSizeForAnyRateOfSampling) {
  const LawCampaign coarse({loop_of(small_law(), Axis::x, 0.4e-3, 3.0, 3, 200)});
  const LawCampaign fine({loop_of(small_law(), Axis::x, 0.4e-3, 3.0, 3, 390)});
  const ThinAxis few = thin(coarse.data), also_few = thin(fine.data);
  EXPECT_LT(also_few.data.blocks.front().num_samples(), 1.3 * few.data.blocks.front().num_samples());
  EXPECT_LT(few.data.blocks.front().num_samples(), 0.6 * coarse.data.blocks.front().num_samples());
  EXPECT_EQ(few.data.low, coarse.data.low);
}

// Coefficients found on the thinned data are those of all samples, to what the noise leaves open.
TEST(ThinAxis, LeadsToTheSameLaw) {
  const LawCampaign campaign(
      {loop_of(small_law(), Axis::x, 0.4e-3, 3.0, 4), loop_of(small_law(), Axis::x, 0.1e-3, 3.0, 5)});
  const ThinAxis few = thin(campaign.data);
  Dictionary dictionary = small_dictionary(campaign.data, 0.0);
  dictionary.yields = {0.02e-3, 0.1e-3};
  dictionary.relaxation_times = {0.03};
  const auto friction_work = [&](const AxisData& data) {
    const Eigen::MatrixXd sum = weighted_sum(block_moments(data, dictionary, false), {}, dictionary);
    const Eigen::Index n = dictionary.num_linear();
    const Eigen::VectorXd c = solve_nnls(sum.topLeftCorner(n, n), sum.col(n).head(n)).x;
    return 4.0 * (c(n - 3) * 0.02e-3 * 0.38e-3 + c(n - 2) * 0.1e-3 * 0.3e-3);  // of the large loop
  };
  const double all = friction_work(campaign.data);
  EXPECT_NEAR(friction_work(few.data), all, 0.02 * all);  // noise of .2 % on a quarter of the samples
}

}  // namespace
}  // namespace grouser
