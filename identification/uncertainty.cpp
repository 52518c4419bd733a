#include "identification/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "identification/nnls.h"

namespace grouser {
namespace {

constexpr int k_draws = 60;         // 60 to 120 (I 2)
constexpr int k_dictionaries = 12;  // (I 2)
constexpr unsigned k_seed = 20261122;
constexpr double k_grid_spread = 0.4;  // lognormal width of the grid ends
constexpr double k_normal_95 = 1.959964;
constexpr double k_identified =
    0.5;  // standard error over value above which data and parameter have little to do with each other
constexpr int k_band_intervals = 40, k_steps_per_interval = 5;
constexpr double k_tangent_window =
    0.15;  // of the range: narrower windows show the stops' corners, not the rubber (I 2)

// Uniform in (0, 1), the same on every platform.
double uniform(std::mt19937_64& random) { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; }
double normal(std::mt19937_64& random) {
  return std::sqrt(-2.0 * std::log(uniform(random))) * std::cos(6.283185307179586 * uniform(random));
}

// Range over which the backbone is shown: that of the slowest ramp, or of the largest loops where there is none.
std::pair<double, double> backbone_range(const AxisData& data) {
  const PreparedTest* chosen = nullptr;
  double low = data.low, high = data.high;
  for (const DataBlock& block : data.blocks) {
    if (block.test->source->kind != TestKind::static_ramp || chosen != nullptr) continue;
    chosen = block.test;
    const CycleSpan& span = block.cycles.back();
    const auto [a, b] = std::minmax_element(chosen->displacement.begin() + static_cast<std::ptrdiff_t>(span.begin),
                                            chosen->displacement.begin() + static_cast<std::ptrdiff_t>(span.end) + 1);
    low = *a;
    high = *b;
  }
  return {low, high};
}

// Mean of the loading and unloading branch of every column on a settled slow triangle over the range, at the band's
// points.
Eigen::MatrixXd backbone_columns(const AxisData& data, const Dictionary& dictionary, double low, double high) {
  constexpr int ramp = k_band_intervals * k_steps_per_interval;
  std::vector<double> path;
  for (int leg = 0; leg < 4; ++leg) {
    for (int i = leg == 0 ? 0 : 1; i <= ramp; ++i) {
      const double fraction = static_cast<double>(leg % 2 == 0 ? i : ramp - i) / ramp;
      path.push_back(low + (high - low) * fraction);
    }
  }
  const double period = data.lowest_frequency > 0.0 ? 1.0 / data.lowest_frequency : 1.0;
  const Eigen::MatrixXd columns = columns_along(path, period / (2 * ramp), dictionary);
  Eigen::MatrixXd mean(k_band_intervals + 1, columns.cols());
  for (int i = 0; i <= k_band_intervals; ++i) {
    const int up = 2 * ramp + i * k_steps_per_interval, down = 4 * ramp - i * k_steps_per_interval;
    mean.row(i) = 0.5 * (columns.row(up) + columns.row(down));
  }
  return mean;
}

// The columns know no force zero: curves are compared about their means.
Eigen::VectorXd level(const Eigen::VectorXd& backbone) {
  return backbone - Eigen::VectorXd::Constant(backbone.size(), backbone.mean());
}

struct Spread {
  Eigen::VectorXd centre, squared;  // of the fit; accumulated squared deviations
  int count = 0;
  explicit Spread(Eigen::VectorXd c) : centre(std::move(c)), squared(Eigen::VectorXd::Zero(centre.size())) {}
  void add(const Eigen::VectorXd& draw) {
    squared += (draw - centre).cwiseAbs2();
    ++count;
  }
  [[nodiscard]] Eigen::VectorXd variance() const { return squared / std::max(count, 1); }
};

Eigen::VectorXd tangent_of(const Eigen::VectorXd& backbone, double spacing, int half_window) {
  const Eigen::Index n = backbone.size() - 2 * half_window;
  return (backbone.tail(n) - backbone.head(n)) / (2.0 * half_window * spacing);
}

std::vector<BandPoint> band(const Eigen::VectorXd& x, const Eigen::VectorXd& value, const Eigen::VectorXd& variance) {
  std::vector<BandPoint> points;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    const double half = k_normal_95 * std::sqrt(variance(i));
    points.push_back({x(i), value(i), value(i) - half, value(i) + half});
  }
  return points;
}

Eigen::VectorXd solve(const Eigen::MatrixXd& moments, int n) {
  return solve_nnls(moments.topLeftCorner(n, n), moments.col(moments.cols() - 1).head(n)).x;
}

// Rms of what each test's whole force is larger or smaller than the law's: every mounting has a gain of its own, and a
// backbone that rests on one ramp inherits the gain of that mounting.
double gain_scatter(const std::vector<Eigen::MatrixXd>& blocks, const Eigen::VectorXd& c) {
  double squared = 0.0;
  for (const Eigen::MatrixXd& moments : blocks) {
    const double fitted = c.dot(moments.topLeftCorner(c.size(), c.size()) * c);
    const double gain = fitted > 0.0 ? c.dot(moments.col(moments.cols() - 1).head(c.size())) / fitted - 1.0 : 0.0;
    squared += gain * gain / static_cast<double>(blocks.size());
  }
  return std::sqrt(squared);
}

void estimate_bands(const AxisData& data, const AxisSolution& solution, AxisFit& fit) {
  const auto [low, high] = backbone_range(data);
  const double spacing = (high - low) / k_band_intervals;
  const int half_window = static_cast<int>(std::lround(k_tangent_window * k_band_intervals));
  const Eigen::MatrixXd columns = backbone_columns(data, solution.dictionary, low, high);
  const Eigen::VectorXd fitted = columns * solution.coefficients;
  Spread boot_force(level(fitted)), boot_tangent(tangent_of(fitted, spacing, half_window));
  Spread grid_force = boot_force, grid_tangent = boot_tangent;
  const auto add = [&](const Eigen::VectorXd& backbone, Spread& force, Spread& tangent) {
    force.add(level(backbone));
    tangent.add(tangent_of(backbone, spacing, half_window));
  };

  std::mt19937_64 random(k_seed + static_cast<unsigned>(index_of(fit.axis)));
  const std::vector<Eigen::MatrixXd> blocks = block_moments(data, solution.dictionary, false);
  for (int draw = 0; draw < k_draws; ++draw) {
    std::vector<double> weights;
    for (std::size_t b = 0; b < blocks.size(); ++b) weights.push_back(-std::log(uniform(random)));
    add(columns * solve(weighted_sum(blocks, weights, solution.dictionary), solution.dictionary.num_linear()),
        boot_force, boot_tangent);
  }
  for (int k = 0; k < k_dictionaries; ++k) {
    const double yields = std::exp(k_grid_spread * normal(random)), times = std::exp(k_grid_spread * normal(random));
    const Dictionary other = full_dictionary(data, yields, times, static_cast<int>(uniform(random) * 5.0) - 2);
    const Eigen::MatrixXd moments = weighted_sum(block_moments(data, other, false), {}, other);
    add(backbone_columns(data, other, low, high) * solve(moments, other.num_linear()), grid_force, grid_tangent);
  }
  const auto n = static_cast<double>(blocks.size());
  const double few_tests = n / std::max(n - 6.0, 0.5 * n);  // I 2: n / (n - 6), bounded where tests are few
  const double gain = gain_scatter(blocks, solution.coefficients);
  const auto variance = [&](const Spread& boot, const Spread& grid) -> Eigen::VectorXd {
    return few_tests * (boot.variance() + (gain * boot.centre).cwiseAbs2()) + grid.variance();
  };
  const double at_rest =
      solution.dictionary.spring.force_at_rest(solution.coefficients.head(solution.dictionary.spring.size()));
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(k_band_intervals + 1, low, high);
  fit.backbone = band(x, fitted - Eigen::VectorXd::Constant(fitted.size(), at_rest), variance(boot_force, grid_force));
  fit.tangent = band(x.segment(half_window, x.size() - 2 * half_window), boot_tangent.centre,
                     variance(boot_tangent, grid_tangent));
  fit.tangent_window = half_window * spacing;
}

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
}

// Covariance H^-1 (sum over tests g g') H^-1 in units of each parameter's scale; parameters at their bound 0 are held
// there.
void estimate_parameters(const AxisData& data, const AxisSolution& solution, AxisFit& fit) {
  const Dictionary& dictionary = solution.dictionary;
  const Eigen::VectorXd& c = solution.coefficients;
  const int n = dictionary.num_linear(), s = dictionary.num_nonlinear(), all = n + s;
  const std::vector<Eigen::MatrixXd> blocks = block_moments(data, dictionary, true);
  const Eigen::MatrixXd total = weighted_sum(blocks, {}, dictionary);
  Eigen::VectorXd scale(all);  // d force = column * scale * d(relative parameter)
  scale << c, c.tail(s);
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
  const bool one_test =
      std::ranges::all_of(data.blocks, [&](const DataBlock& b) { return b.test == data.blocks.front().test; });
  if (one_test) {
    fit.not_identified.push_back(
        "one test only: intervals come from its own cycles or amplitudes and miss the error of mounting the specimen "
        "again");
  }
}

}  // namespace

void estimate_uncertainty(const AxisData& data, const AxisSolution& solution, AxisFit& fit) {
  name_parameters(solution.dictionary, solution.coefficients, fit);
  estimate_parameters(data, solution, fit);
  set_intervals(fit);
  state_limits(data, fit);
  estimate_bands(data, solution, fit);
}

}  // namespace grouser
