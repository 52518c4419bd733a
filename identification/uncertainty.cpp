#include "identification/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identification/bands.h"
#include "identification/draws.h"

namespace grouser {
namespace {

constexpr unsigned k_seed = 20261122;
constexpr double k_normal_95 = 1.959964;
constexpr double k_identified =
    0.5;  // standard error over value above which data and parameter have little to do with each other

void name_parameters(const Dictionary& dictionary, const Eigen::VectorXd& coefficients, AxisFit& fit) {
  const bool turns = is_rotation(fit.axis);
  const char* force = turns ? "N m" : "N";
  const char* stiffness = turns ? "N m/rad" : "N/m";
  const char* length = turns ? "rad" : "m";
  const auto add = [&](std::string name, const char* unit, double value) {
    FitParameter parameter;
    parameter.name = std::move(name);
    parameter.unit = unit;
    parameter.value = value;
    fit.parameters.push_back(parameter);
  };
  Eigen::Index at = 0;
  for (int i = 0; i < dictionary.spring.size(); ++i)
    add(fmt::format("spring.increment[{}]", i), force, coefficients(at++));
  for (std::size_t i = 0; i < dictionary.yields.size(); ++i)
    add(fmt::format("stop[{}].stiffness", i), stiffness, coefficients(at++));
  for (std::size_t i = 0; i < dictionary.relaxation_times.size(); ++i) {
    add(fmt::format("maxwell[{}].stiffness", i), stiffness, coefficients(at++));
  }
  for (std::size_t i = 0; i < dictionary.yields.size(); ++i)
    add(fmt::format("stop[{}].yield", i), length, dictionary.yields[i]);
  for (std::size_t i = 0; i < dictionary.relaxation_times.size(); ++i) {
    add(fmt::format("maxwell[{}].relaxation_time", i), "s", dictionary.relaxation_times[i]);
  }
  if (dictionary.yield_growth > 0.0) add("friction.yield_growth", turns ? "1/rad^2" : "1/m^2", dictionary.yield_growth);
}

// Covariance H^-1 (sum over tests g g') H^-1 in units of each parameter's scale; parameters at their bound 0 are held
// there.
void estimate_parameters(const AxisSolution& solution, AxisFit& fit) {
  const Dictionary& dictionary = solution.dictionary;
  const Eigen::VectorXd& c = solution.coefficients;
  const int n = dictionary.num_linear(), s = dictionary.num_nonlinear(), all = n + s;
  // derivative columns added up to d force / d log parameter
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(solution.moments.front().rows(), all + 1);
  const Eigen::MatrixXd nonlinear = derivative_weights(dictionary, c);
  weights.topLeftCorner(n, n).setIdentity();
  weights.block(n, n, nonlinear.rows(), s) = nonlinear;
  weights(weights.rows() - 1, all) = 1.0;
  std::vector<Eigen::MatrixXd> blocks;
  for (const Eigen::MatrixXd& moments : solution.moments) blocks.push_back(weights.transpose() * moments * weights);
  const Eigen::MatrixXd total = weighted_sum(blocks, {}, dictionary);
  Eigen::VectorXd scale(all);  // d force = column * scale * d(relative parameter)
  scale << c, Eigen::VectorXd::Ones(s);
  std::vector<int> free;
  for (int j = 0; j < all; ++j) {
    if (scale(j) > 0.0) free.push_back(j);
  }
  const Eigen::VectorXd free_scale = scale(free);
  const Eigen::MatrixXd block = total(free, free);
  const Eigen::MatrixXd hessian = free_scale.asDiagonal() * block * free_scale.asDiagonal();
  const Eigen::VectorXd unit = hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * hessian * unit.asDiagonal());
  const double largest = eigen.eigenvalues().maxCoeff(), floor = 1e-12 * largest;
  fit.condition_number = largest / std::max(eigen.eigenvalues().minCoeff(), floor);
  const Eigen::MatrixXd inverse = unit.asDiagonal() * eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseMax(floor).cwiseInverse().asDiagonal() *
                                  eigen.eigenvectors().transpose() * unit.asDiagonal();
  Eigen::MatrixXd scatter(hessian.rows(), hessian.cols());
  scatter.setZero();
  for (const Eigen::MatrixXd& moments : blocks) {
    const Eigen::VectorXd error = moments.col(all).head(all) - moments.topLeftCorner(all, n) * c;
    const Eigen::VectorXd gradient = free_scale.cwiseProduct(error(free));
    scatter += gradient * gradient.transpose();
  }
  const auto tests = static_cast<double>(blocks.size());
  const Eigen::MatrixXd relative = tests / std::max(tests - 1.0, 1.0) * inverse * scatter * inverse;

  Eigen::VectorXd value(static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i)
    value(static_cast<Eigen::Index>(i)) = fit.parameters[static_cast<std::size_t>(free[i])].value;
  const Eigen::MatrixXd covariance = value.asDiagonal() * relative * value.asDiagonal();
  fit.covariance.assign(static_cast<std::size_t>(all), std::vector<double>(static_cast<std::size_t>(all), 0.0));
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j) {
      fit.covariance[static_cast<std::size_t>(free[i])][static_cast<std::size_t>(free[j])] =
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
}

void set_intervals(AxisFit& fit) {
  std::string loose;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    FitParameter& parameter = fit.parameters[i];
    parameter.standard_error = std::sqrt(std::max(fit.covariance[i][i], 0.0));
    parameter.low = std::max(0.0, parameter.value - k_normal_95 * parameter.standard_error);
    parameter.high = parameter.value + k_normal_95 * parameter.standard_error;
    parameter.identified = parameter.value > 0.0 && parameter.standard_error <= k_identified * parameter.value;
    if (!parameter.identified) loose += (loose.empty() ? "" : ", ") + parameter.name;
  }
  if (!loose.empty()) {
    fit.not_identified.push_back(
        "the data do not tell these from their neighbours (the response is known, its split is not): " + loose);
  }
}

void state_limits(const AxisData& data, AxisFit& fit) {
  if (!data.closed) {
    fit.not_identified.push_back("one ramp without a way back: friction and damping are unknown, the law is a spring");
  } else if (data.highest_frequency == 0.0) {
    fit.not_identified.push_back(
        "no rate or frequency is known: nothing can be said about dependence on rate (no Maxwell branches)");
  } else if (data.highest_frequency <= 1.5 * data.lowest_frequency) {
    fit.not_identified.push_back(fmt::format(
        "all data run at {:.3g} cycles a second: rate dependence is unknown and all damping is written as friction",
        data.highest_frequency));
  }
  if (data.closed && data.largest_amplitude <= 1.05 * data.smallest_amplitude) {
    fit.not_identified.push_back(
        "all loops have one amplitude: how stiffness and damping depend on amplitude is unknown");
  }
  const bool one_test =
      std::ranges::all_of(data.blocks, [&](const DataBlock& b) { return b.test == data.blocks.front().test; });
  if (one_test) {
    fit.not_identified.push_back(
        "one test only: intervals come from its own cycles or amplitudes and miss the error of mounting the specimen "
        "again");
  }
}

// Scatter of the tests' gains: rms of the fraction by which each test's force is larger than the law's, weighted by the
// test's say.
double gain_scatter(const AxisData& data, const AxisSolution& solution) {
  const Eigen::VectorXd& c = solution.coefficients;
  double squared = 0.0, weights = 0.0;
  for (const std::vector<std::size_t>& test : replicates(data)) {
    double measured = 0.0, fitted = 0.0;
    for (const std::size_t block : test) {
      const Eigen::MatrixXd& moments = solution.moments[block];
      measured += c.dot(moments.col(moments.cols() - 1).head(c.size()));
      fitted += c.dot(moments.topLeftCorner(c.size(), c.size()) * c);
    }
    const double gain = fitted > 0.0 ? measured / fitted - 1.0 : 0.0, weight = data.blocks[test.front()].robust_weight;
    squared += weight * gain * gain;
    weights += weight;
  }
  return weights > 0.0 ? std::sqrt(squared / weights) : 0.0;
}

}  // namespace

std::vector<AxisLaw> estimate_uncertainty(const AxisData& data, const AxisSolution& solution, const AxisLaw& law,
                                          AxisFit& fit) {
  name_parameters(solution.dictionary, solution.coefficients, fit);
  estimate_parameters(solution, fit);
  set_intervals(fit);
  state_limits(data, fit);
  std::vector<AxisLaw> draws = draw_laws(data, solution.dictionary, gain_scatter(data, solution),
                                         k_seed + static_cast<unsigned>(index_of(fit.axis)));
  state_intervals(data, law, draws, fit);
  for (AxisLaw& draw : draws) draw.valid = law.valid;
  return draws;
}

}  // namespace grouser
