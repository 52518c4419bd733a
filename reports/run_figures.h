#pragma once
#include <optional>
#include <string>

#include "model/run.h"
#include "render/figure.h"

/// The figures of the catalogue, one function each. Each throws InputError when the run does not hold its data.
namespace grouser {

// Motion and drive.
[[nodiscard]] Figure figure_speed(const RunFolder& run);
[[nodiscard]] Figure figure_path(const RunFolder& run);
[[nodiscard]] Figure figure_yaw_rate(const RunFolder& run);
// Wheels and suspension.
[[nodiscard]] Figure figure_wheel_loads(const RunFolder& run);
[[nodiscard]] Figure figure_wheel_travel(const RunFolder& run);
[[nodiscard]] Figure figure_suspension(const RunFolder& run);
// Track.
[[nodiscard]] Figure figure_tension(const RunFolder& run);
[[nodiscard]] Figure figure_contact_forces(const RunFolder& run);
[[nodiscard]] Figure figure_contact_forces_zoom(const RunFolder& run);
[[nodiscard]] Figure figure_sprocket_torque(const RunFolder& run);
// Spectra at steady speed.
[[nodiscard]] Figure figure_torque_spectrum(const RunFolder& run);
[[nodiscard]] Figure figure_tension_spectrum(const RunFolder& run);
// All bushings of a track, and the rubber of one.
[[nodiscard]] Figure figure_tension_map(const RunFolder& run);
[[nodiscard]] Figure figure_tension_histogram(const RunFolder& run);
[[nodiscard]] Figure figure_bushing_loops(const RunFolder& run);
// Integration and energy.
[[nodiscard]] Figure figure_step_size(const RunFolder& run);
[[nodiscard]] Figure figure_step_histogram(const RunFolder& run);
[[nodiscard]] Figure figure_step_limits(const RunFolder& run);
[[nodiscard]] Figure figure_energy(const RunFolder& run);
[[nodiscard]] Figure figure_energy_residual(const RunFolder& run);

/// Several panels one under the other on the same time axis, the usual shape of a figure here.
[[nodiscard]] Figure stacked_figure(const std::string& name, const std::string& title, const std::string& caption,
                                    std::vector<Panel> panels, int panel_height = 210);
/// A panel over time with its series still to come.
[[nodiscard]] Panel time_panel(const std::string& title, const std::string& y_label);
/// The second curve is dashed: where the sides coincide, both are seen.
[[nodiscard]] SeriesStyle side_style(Side side);
/// Shares [%] of the values in equal bins between two bounds.
[[nodiscard]] Series histogram(const std::string& name, const std::vector<double>& values, double low, double high,
                               std::size_t bins);

}  // namespace grouser
