#pragma once
#include <nlohmann/json.hpp>

#include "model/fit.h"

/// What an identification must reach to be signed, axis by axis.
namespace grouser {

/// Stated limits. The first three are what the best law of this kind leaves on measured rubber when one set of
/// parameters serves all amplitudes (I 1: nrmse 3.0 %, energy 4.6 %, stiffness 9 %). An interval may be no wider than
/// the error that is allowed, or it would say nothing about it.
struct FitLimits {
  double nrmse = 0.03;                 ///< of a test, fraction of its force range
  double energy_error = 0.05;          ///< of a loop's energy
  double stiffness_error = 0.10;       ///< of a loop's stiffness
  double energy_interval = 0.05;       ///< half width of the 95 % interval, fraction of the value
  double stiffness_interval = 0.10;    ///< the same, of storage stiffness and of the tangent
  double backbone_interval = 0.03;     ///< the same, fraction of the backbone's largest force
  double left_out_error = 0.06;        ///< rms error of tests not fitted to: twice what is allowed for fitted ones
  double weight = 0.5;                 ///< of a test: with less, the test contradicts the others
  double kkt_residual = 1e-6;          ///< largest violation of the optimality conditions, relative
  double calibration_residual = 0.01;  ///< of a sensor, fraction of full scale
};
inline constexpr FitLimits k_fit_limits{};

/// {axes[], rows[]}: `axes` with name and pass; each row is a quantity with its limit and a cell an axis, {value, text,
/// pass, known}; `known` is false where the fit does not hold the quantity. Quantities that no axis knows are left out.
[[nodiscard]] nlohmann::json axis_checks(const FitRecord& fit);
/// Checks of the campaign as a whole, as a list of {label, value, text, limit, pass}; may be empty.
[[nodiscard]] nlohmann::json campaign_checks(const FitRecord& fit);

/// Error of a computed value relative to the measured one; 0 where nothing was measured.
[[nodiscard]] inline double relative_error(double computed, double measured) {
  return measured != 0.0 ? computed / measured - 1.0 : 0.0;
}

}  // namespace grouser
