#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/provenance.h"
#include "model/spline.h"

namespace grouser {

/// Bushing axes: x along the track (tension > 0), y along the pin, z normal to the link; ry is the hinge.
enum class Axis { x, y, z, rx, ry, rz };
inline constexpr int k_num_axes = 6;
inline constexpr std::array<const char*, k_num_axes> k_axis_names{"x", "y", "z", "rx", "ry", "rz"};
[[nodiscard]] inline int index_of(Axis axis) { return static_cast<int>(axis); }
[[nodiscard]] inline const char* name_of(Axis axis) { return k_axis_names[static_cast<std::size_t>(axis)]; }
[[nodiscard]] inline bool is_rotation(Axis axis) { return axis >= Axis::rx; }

/// Friction stop (Jenkins element, Prandtl-Ishlinskii operator): a spring that slips at |deflection| = yield.
struct FrictionStop {
  double stiffness = 0.0;  ///< N/m or N m/rad, >= 0
  double yield = 0.0;      ///< m or rad, > 0, at displacement 0 (see AxisLaw::yield_growth)
};

/// Spring and damper in series.
struct MaxwellBranch {
  double stiffness = 0.0;        ///< N/m or N m/rad, >= 0
  double relaxation_time = 0.0;  ///< s, > 0
};

/// Where the law was identified; nothing is known outside.
struct ValidRange {
  double amplitude = 0.0;       ///< m or rad, largest |displacement| seen
  double frequency_low = 0.0;   ///< Hz
  double frequency_high = 0.0;  ///< Hz
  double rate = 0.0;            ///< m/s or rad/s, largest rate seen
};

/// Restoring law of one axis; all coefficients >= 0 and the spring monotone: passive by construction.
struct AxisLaw {
  SpringSpline spring;
  std::vector<FrictionStop> stops;
  /// 1/m^2 or 1/rad^2, >= 0: at displacement x every stop slips at yield * (1 + yield_growth x^2), which thickens the
  /// loop towards its ends. Scaling the yield, not the force, keeps the law passive (I 1).
  double yield_growth = 0.0;
  std::vector<MaxwellBranch> branches;
  double viscous = 0.0;  ///< N s/m or N m s/rad, >= 0
  std::optional<ValidRange> valid;
};

/// What identify writes and simulate reads (bushing.json).
struct Bushing {
  std::string name;
  bool synthetic = false;  ///< made from generated, not measured, data; shown wherever the bushing is shown
  std::array<AxisLaw, k_num_axes> axes;
  Provenance provenance;

  [[nodiscard]] const AxisLaw& axis(Axis a) const { return axes[static_cast<std::size_t>(a)]; }
  [[nodiscard]] AxisLaw& axis(Axis a) { return axes[static_cast<std::size_t>(a)]; }
};

/// A factor on each axis.
using AxisScale = std::array<double, k_num_axes>;
/// The bushing whose every restoring force is `scale` times as large for the same motion: stiffness of spring, stops
/// and branches and the viscous coefficient take the factor, yields, relaxation times and the valid range stay. By this
/// the law is homogeneous of degree one: f(s k; x) = s f(k; x) for any path, and so are stored energy and loss.
[[nodiscard]] Bushing scaled(const Bushing& bushing, const AxisScale& scale);

/// Reads `grouser.bushing/1`; throws InputError with every finding. A Berg friction element is expanded into stops.
[[nodiscard]] Bushing read_bushing(const std::filesystem::path& file);
/// Writes whole or not at all.
void write_bushing(const Bushing& bushing, const std::filesystem::path& file);

}  // namespace grouser
