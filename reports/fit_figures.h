#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/fit.h"
#include "render/figure.h"

/// Figures of an identification, one axis at a time. Each is absent where the fit holds nothing to show.
namespace grouser {

/// Units that a reader of rig data thinks in, and the factors from SI.
struct AxisUnits {
  std::string displacement, force, stiffness, energy;
  double displacement_scale = 1.0, force_scale = 1.0, stiffness_scale = 1.0;
};
[[nodiscard]] AxisUnits units_of(Axis axis);
/// "Force [kN]" or "Torque [kN m]", "Displacement [mm]" or "Angle [deg]".
[[nodiscard]] std::string force_label(Axis axis, const AxisUnits& units);
[[nodiscard]] std::string displacement_label(Axis axis, const AxisUnits& units);
/// "x · along the track", "ry · hinge", ...
[[nodiscard]] std::string axis_title(Axis axis);

/// Measured loop of every test, with the response of a law over it; a panel each, in the order of `tests`. `law` is
/// what the legend calls it: "fit", "virtual rig". Tests without a curve are passed over.
[[nodiscard]] std::optional<Figure> figure_loops(const std::vector<const TestFit*>& tests, const std::string& law);
/// Measured less computed force over displacement, in per cent of the force range of the test, all on one scale.
[[nodiscard]] std::optional<Figure> figure_residuals(const std::vector<const TestFit*>& tests);
/// By how much each test's force is larger than the law's, over frequency and over amplitude (I 5.10).
[[nodiscard]] std::optional<Figure> figure_gain(const std::vector<const TestFit*>& tests);

/// Stiffness and loss factor over frequency and over amplitude: the law with its 95 % bands, and the measured loops.
[[nodiscard]] std::optional<Figure> figure_stiffness(const AxisFit& axis, const std::vector<const TestFit*>& tests);
/// Dissipated energy over amplitude, and the measured loops' deviation from the law beside the law's 95 % band.
[[nodiscard]] std::optional<Figure> figure_energy(const AxisFit& axis, const std::vector<const TestFit*>& tests);
/// Backbone and tangent stiffness with their 95 % bands; play, hard stops and preset marked.
[[nodiscard]] std::optional<Figure> figure_backbone(const AxisFit& axis);
/// Left-out error over the number of elements, the chosen size marked.
[[nodiscard]] std::optional<Figure> figure_selection(const AxisFit& axis);

}  // namespace grouser
