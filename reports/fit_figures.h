#pragma once
#include <optional>
#include <string>

#include "model/fit.h"
#include "render/figure.h"

/// Figures of an identification, one axis at a time.
namespace grouser {

/// Units that a reader of rig data thinks in, and the factors from SI.
struct AxisUnits {
  std::string displacement, force, stiffness, energy;
  double displacement_scale = 1.0, force_scale = 1.0, stiffness_scale = 1.0;
};
[[nodiscard]] AxisUnits units_of(Axis axis);
/// "x · along the track", "ry · hinge", ...
[[nodiscard]] std::string axis_title(Axis axis);

/// Measured and fitted loop of every test of the axis, small multiples.
[[nodiscard]] std::optional<Figure> figure_loops(const FitRecord& fit, Axis axis);
/// Backbone and tangent stiffness with their 95 % bands.
[[nodiscard]] std::optional<Figure> figure_backbone(const AxisFit& axis);
/// Stiffness and loss factor, measured and fitted, over frequency and over amplitude of the cyclic tests.
[[nodiscard]] std::optional<Figure> figure_dynamic_stiffness(const FitRecord& fit, Axis axis);

}  // namespace grouser
