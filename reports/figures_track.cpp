#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/errors.h"
#include "reports/channels.h"
#include "reports/number_text.h"
#include "reports/run_figures.h"

namespace grouser {
namespace {

constexpr double k_kilo = 1e-3;

struct Partner {
  const char* dataset;
  const char* title;
  const char* name;
};
constexpr std::array<Partner, 6> k_partners{{{"road_wheel", "Road wheels", "road wheels"},
                                             {"support_roller", "Support rollers", "support rollers"},
                                             {"idler", "Idler", "the idler"},
                                             {"sprocket", "Sprocket", "the sprocket"},
                                             {"ground", "Ground", "the ground"},
                                             {"guide", "Centre guide", "the centre guide"}}};

bool drives_by_torque(const RunFolder& run) {
  return std::ranges::any_of(run.scenario.drive, [](const DriveTable& t) { return t.kind == DriveKind::torque; });
}

/// Contact force magnitudes of the probe over a window, one stacked panel for each partner that it meets.
Figure contact_panels(const RunFolder& run, const Probe& probe, const TimeWindow& window) {
  const std::vector<double> time = require_column(run, "/probes/time");
  std::vector<Panel> panels, silent;
  std::string untouched;
  for (const Partner& partner : k_partners) {
    const std::string path = probe.path + "/contact_force/" + partner.dataset;
    if (!run.channels.has(path)) continue;
    const std::vector<double> force = row_lengths(run.channels.read(path));
    Panel panel = time_panel(partner.title, "|F| [kN]");
    Series series{.name = partner.title, .x = {}, .y = {}, .width = 1.2f};
    for (std::size_t i = 0; i < std::min(time.size(), force.size()); ++i) {
      if (time[i] < window.begin || time[i] > window.end) continue;
      series.x.push_back(time[i]);
      series.y.push_back(k_kilo * force[i]);
    }
    const bool touched = std::ranges::any_of(series.y, [](double f) { return f > 0.0; });
    panel.series.push_back(std::move(series));
    (touched ? panels : silent).push_back(std::move(panel));
    if (!touched) untouched += (untouched.empty() ? "" : ", ") + std::string(partner.name);
  }
  if (panels.empty()) {  // a link that meets nothing still has its curves
    panels = std::move(silent);
    untouched.clear();
  }
  if (panels.empty()) (void)require_channel(run, probe.path + "/contact_force/" + k_partners.front().dataset);
  return stacked_figure("contact_forces", "", untouched.empty() ? "" : " No contact with: " + untouched + ".",
                        std::move(panels), 130);
}

}  // namespace

Figure figure_tension(const RunFolder& run) {
  std::vector<Panel> panels;
  std::string caption;
  if (const std::vector<Probe> all = probes(run); !all.empty()) {
    const Probe& probe = all.front();
    Panel panel = time_panel(
        fmt::format("Bushing between links {} and {}, {} track", probe.link, probe.link + 1, name_of(probe.side)),
        "Tension [kN]");
    panel.series.push_back({.name = "longitudinal force",
                            .x = require_column(run, "/probes/time"),
                            .y = scaled(require_column(run, probe.path + "/bushing_force", {0}), k_kilo),
                            .width = 1.1f});
    panels.push_back(std::move(panel));
    caption =
        "Longitudinal force in one bushing between track links as the link runs round the track (the paper's Fig. 5). ";
  }
  Panel upper = time_panel("Upper run, mean", "Tension [kN]");
  const std::vector<double> time = require_column(run, "/probes/time");
  for (const Side side : {Side::left, Side::right})
    upper.series.push_back({.name = name_of(side),
                            .x = time,
                            .y = scaled(upper_run_tension(run, side), k_kilo),
                            .style = side_style(side),
                            .width = 1.2f});
  panels.push_back(std::move(upper));
  return stacked_figure("tension", "Track tension",
                        caption + "Mean over the bushings of the upper run of each track; positive is tension.",
                        std::move(panels));
}

Figure figure_contact_forces(const RunFolder& run) {
  const Probe probe = first_probe(run);
  Figure figure = contact_panels(run, probe, {0.0, run.summary.simulated_time});
  figure.title = "Contact forces on " + probe_text(probe);
  figure.caption =
      "Magnitude of the force that each partner puts on the link while it runs round the track (the paper's Fig. 6)." +
      figure.caption;
  return figure;
}

Figure figure_contact_forces_zoom(const RunFolder& run) {
  const Probe probe = first_probe(run);
  const TimeWindow steady = require_steady_window(run);
  const double speed = std::abs(track_feed_speed(run, probe.side, asked_speed(run, probe.side, steady.begin).value()));
  const double lap = lap_time(run, probe.side, steady);
  // The lap ends with the steady stretch, when transients of the drive have died away.
  Figure figure = contact_panels(run, probe, {std::max(steady.begin, steady.end - lap), steady.end});
  figure.name = "contact_forces_zoom";
  figure.title = "One lap of " + probe_text(probe);
  figure.caption = fmt::format("The same forces over the last lap at steady speed ({} at {}).",
                               quantity_text(lap, "s", 3), quantity_text(speed, "m/s", 3)) +
                   figure.caption;
  return figure;
}

Figure figure_sprocket_torque(const RunFolder& run) {
  const std::vector<double> time = require_column(run, "/probes/time");
  Panel panel = time_panel("", "Drive torque [kN m]");
  for (const Side side : {Side::left, Side::right})
    panel.series.push_back({.name = name_of(side),
                            .x = time,
                            .y = scaled(sprocket_torque(run, side), k_kilo),
                            .style = side_style(side),
                            .width = 1.1f});
  return stacked_figure("sprocket_torque", "Sprocket torque",
                        drives_by_torque(run)
                            ? "Torque between chassis and sprocket; positive drives forward."
                            : "Torque that holds each sprocket to its speed; positive drives forward.",
                        {std::move(panel)}, 260);
}

}  // namespace grouser
