#include <algorithm>
#include <array>

#include "model/errors.h"
#include "reports/report.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

struct Entry {
  const char* name;
  const char* meaning;
  Figure (*make)(const RunFolder&);
};

constexpr std::array<Entry, 20> k_catalogue{{
    {"speed", "vehicle speed against track feed, and the sprocket speeds", figure_speed},
    {"path", "path of the chassis over the ground", figure_path},
    {"yaw_rate", "yaw rate against the turn without slip", figure_yaw_rate},
    {"step_size", "step size of the integrator over time, with speed (the paper's Fig. 4)", figure_step_size},
    {"tension", "longitudinal force in one bushing, and the mean of the upper runs (Fig. 5)", figure_tension},
    {"contact_forces", "contact forces on one link, by partner (Fig. 6)", figure_contact_forces},
    {"contact_forces_zoom", "the same over one lap at steady speed", figure_contact_forces_zoom},
    {"tension_map", "tension of every link over time, as colours", figure_tension_map},
    {"tension_histogram", "distribution of the tension over all bushings of a track", figure_tension_histogram},
    {"bushing_loops", "load over deflection of one bushing during a lap", figure_bushing_loops},
    {"sprocket_torque", "drive torque of the sprockets", figure_sprocket_torque},
    {"torque_spectrum", "spectrum of the drive torque, link-passing frequency marked", figure_torque_spectrum},
    {"tension_spectrum", "spectrum of the upper runs' tension, link-passing frequency marked", figure_tension_spectrum},
    {"wheel_loads", "vertical force of each road wheel on its track", figure_wheel_loads},
    {"wheel_travel", "height of each road wheel in the chassis against design", figure_wheel_travel},
    {"suspension", "angles of the road arms", figure_suspension},
    {"energy", "work, stored and dissipated energy, losses by cause", figure_energy},
    {"energy_residual", "what the energy book leaves unexplained", figure_energy_residual},
    {"step_limits", "share of the steps by what bounded them", figure_step_limits},
    {"step_histogram", "distribution of the step size", figure_step_histogram},
}};

}  // namespace

std::vector<FigureEntry> run_figures() {
  std::vector<FigureEntry> entries;
  for (const Entry& entry : k_catalogue) entries.push_back({entry.name, entry.meaning});
  return entries;
}

Figure make_run_figure(const RunFolder& run, const std::string& name) {
  const auto entry = std::ranges::find_if(k_catalogue, [&](const Entry& e) { return name == e.name; });
  if (entry != k_catalogue.end()) return entry->make(run);
  std::string known;
  for (const Entry& e : k_catalogue) known += (known.empty() ? "" : ", ") + std::string(e.name);
  throw InputError(InputFinding{"", "figure", "one of " + known, name, ""});
}

}  // namespace grouser
