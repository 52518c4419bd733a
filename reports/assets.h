#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

/// Templates, style sheet and scripts, embedded at build.
namespace grouser {

/// True when uPlot was there at build; else reports show drawn plots in place of interactive charts.
[[nodiscard]] bool has_interactive_charts();

/// Fills an embedded template ("report", "index") with the facts; every {{name}} is HTML-escaped. Scripts and styles
/// are put in by the keys style, script, chart_script, chart_style, which the facts must not hold. Throws
/// std::logic_error when the template itself is broken.
[[nodiscard]] std::string render_page(std::string_view page, const nlohmann::json& facts);

}  // namespace grouser
