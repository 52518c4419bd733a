#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/errors.h"
#include "render/render.h"
#include "reports/channels.h"
#include "reports/encode.h"
#include "reports/figure_block.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/report.h"
#include "reports/result_names.h"

namespace grouser {
namespace {

using nlohmann::json;

/// A section of the page and the figures that stand in it.
struct Section {
  const char* key;
  const char* title;
  const char* lead;
  std::array<const char*, 4> figures;
};
constexpr std::array<Section, 7> k_sections{{
    {"drive",
     "Drive, speed and path",
     "What the run asked of the vehicle and what the vehicle did.",
     {"speed", "path", "yaw_rate", "sprocket_torque"}},
    {"paper",
     "Step size, tension and contacts",
     "Figures 4, 5 and 6 of the paper, of this run.",
     {"step_size", "tension", "contact_forces", "contact_forces_zoom"}},
    {"track",
     "Tension of all links",
     "The bushings carry the pull of the track from link to link.",
     {"tension_map", "tension_histogram", "bushing_loops", nullptr}},
    {"spectra",
     "Spectra",
     "Links meet the sprocket one by one, and torque and tension answer at that frequency.",
     {"torque_spectrum", "tension_spectrum", nullptr, nullptr}},
    {"wheels",
     "Wheel loads and travel",
     "What each wheel carries, and how far it moves.",
     {"wheel_loads", "wheel_travel", nullptr, nullptr}},
    {"integration",
     "Limits of the step",
     "What bounded the explicit integrator, and how often.",
     {"step_limits", "step_histogram", nullptr, nullptr}},
    {"energy",
     "Energy book",
     "Every joule that the sprockets put in is looked for again.",
     {"energy", "energy_residual", nullptr, nullptr}},
}};

json check_facts(const RunSummary& summary) {
  json checks = json::array();
  for (const RunCheck& check : summary.checks) {
    json facts = labelled_quantity(check.name, check.value, check.unit);
    facts["limit"] = check.limit;
    facts["pass"] = check.pass;
    checks.push_back(facts);
  }
  return checks;
}

/// Results that a reader looks for first, in this order, with room for a few words.
struct Headline {
  const char* result;
  const char* label;
};
constexpr std::array<Headline, 6> k_headlines{{{"cruise_speed_m_per_s", "cruise speed"},
                                               {"distance_m", "distance"},
                                               {"yaw_rate_rad_per_s", "steady yaw rate"},
                                               {"yaw_turned_rad", "turned"},
                                               {"largest_tension_N", "largest bushing tension"},
                                               {"link_passing_torque_N_m", "torque at link passing"}}};

json count_row(const std::string& label, long value) {
  return {{"label", label}, {"value", value}, {"text", count_text(value)}};
}

json table_facts(const RunSummary& summary) {
  json tables = json::array();
  const auto& counts = summary.counts;
  tables.push_back(
      {{"caption", "Model, counted from the compiled system"},
       {"rows",
        json::array({count_row("bodies", counts.bodies), count_row("revolute joints", counts.revolute_joints),
                     count_row("bushings", counts.bushings), count_row("degrees of freedom", counts.degrees_of_freedom),
                     count_row("prescribed", counts.prescribed)})}});
  const auto& steps = summary.steps;
  tables.push_back(
      {{"caption", "Steps and time"},
       {"rows", json::array({count_row("accepted steps", steps.accepted), count_row("rejected steps", steps.rejected),
                             count_row("force evaluations", steps.force_evaluations),
                             labelled_quantity("smallest step", steps.min, "s", 3),
                             labelled_quantity("mean step", steps.mean, "s", 3),
                             labelled_quantity("largest step", steps.max, "s", 3),
                             labelled_quantity("wall time of the run", summary.wall_time, "s", 3),
                             labelled_quantity("wall time of the assembly", summary.assembly_wall_time, "s", 3)})}});
  const auto& energy = summary.energy;
  tables.push_back(
      {{"caption", "Energy"},
       {"rows", json::array({labelled_quantity("sprocket work", energy.input, "J"),
                             labelled_quantity("dissipated", energy.dissipated, "J"),
                             labelled_quantity("residual", energy.residual, "J", 3),
                             labelled_quantity("residual over ∫|P| dt", energy.residual_fraction, "1", 3)})}});
  return tables;
}

/// The results but for the mean numbers of contacts.
json result_rows(const RunSummary& summary) {
  json rows = json::array();
  for (const RunResult& result : summary.results) {
    if (is_contact_count(result)) continue;
    json row = result_facts(result.value, result.unit);
    row["label"] = result_label(result);
    row["name"] = result.name;
    row["meaning"] = result.meaning;
    rows.push_back(row);
  }
  return rows;
}

/// Cases of contact with the mean number of each at a time, those that the run never met too.
json contact_facts(const RunSummary& summary) {
  json rows = json::array();
  std::string head;
  for (const RunResult& result : summary.results) {
    if (!is_contact_count(result)) continue;
    const ContactCase contact = contact_case(result);
    json row = quantity_facts(result.value, result.unit, 3);
    row["partner"] = head == contact.partner ? "" : contact.partner;
    row["case"] = contact.meaning;
    row["name"] = result.name;
    row["met"] = result.value > 0.0;
    rows.push_back(row);
    head = contact.partner;
  }
  return rows;
}

/// The sections with the figures that the run can show, and a sentence for each that it cannot.
json section_facts(const RunFolder& run, const std::string& id) {
  json sections = json::array();
  for (const Section& section : k_sections) {
    json figures = json::array(), left_out = json::array();
    for (const char* name : section.figures) {
      if (name == nullptr) continue;
      try {
        figures.push_back(figure_block(make_run_figure(run, name), id + "-figure-" + name));
      } catch (const InputError& error) {
        const InputFinding& finding = error.findings().front();
        left_out.push_back(fmt::format("The figure “{}” is left out: the run holds no {}.", name, finding.place));
      }
    }
    sections.push_back({{"key", id + "-" + section.key},
                        {"title", section.title},
                        {"lead", section.lead},
                        {"figures", figures},
                        {"left_out", left_out}});
  }
  return sections;
}

/// A page holds its film whole, as text.
bool has_huge_film(const RunFolder& run) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(run.path / "film.mp4", none);
  return !none && size > k_most_whole_bytes;
}

/// A film of an earlier run of the folder does not bear this one's mark.
json film_facts(const RunFolder& run) {
  const std::filesystem::path film = run.path / "film.mp4";
  std::error_code error;
  if (!std::filesystem::is_regular_file(film, error) || has_huge_film(run)) return false;
  const std::string bytes = read_whole(film);
  if (bytes.find(film_mark(run)) == std::string::npos) return false;
  return {{"payload_mp4", base64(bytes)},
          {"caption", "The run as rendered headless, frame by frame. Every tenth link is amber, probe links are red."}};
}

/// The vehicle as a picture {payload_still, alt, caption}.
json still_of(const RunFolder& run, double time) {
  RenderOptions options;
  options.width = 1120;
  options.height = 630;
  const std::vector<std::uint8_t> picture = encode_webp(render_still(run, time, options), k_photograph_quality);
  const std::string at = quantity_text(time, "s", 3);
  return {{"payload_still", base64({reinterpret_cast<const char*>(picture.data()), picture.size()})},
          {"alt", fmt::format("{} in {} at {}", run.summary.vehicle_name, run.summary.name, at)},
          {"caption", fmt::format("The vehicle at {}.", at)}};
}

/// At the end of the steady drive, else halfway.
json still_facts(const RunFolder& run) {
  if (!run.channels.has("/chassis/position")) return false;
  const std::optional<TimeWindow> steady = steady_window(run);
  return still_of(run, steady ? steady->end : 0.5 * run.summary.simulated_time);
}

/// Where neither the player nor a film can show the motion, its begin and its end beside the still.
json more_stills(const RunFolder& run) { return {still_of(run, 0.0), still_of(run, run.summary.simulated_time)}; }

/// What makes this result again from its inputs, typed where the run was: its folder is the one that it was asked for.
std::vector<std::string> repeating_commands(const RunFolder& run, bool filmed) {
  const std::string& command = run.summary.provenance.command;
  constexpr std::string_view k_output = " -o ";
  const std::size_t output = command.find(k_output);
  const std::string folder =
      output == std::string::npos
          ? run.path.filename().string()
          : command.substr(output + k_output.size(),
                           command.find(' ', output + k_output.size()) - output - k_output.size());
  std::vector<std::string> commands{command};
  if (filmed) commands.push_back(fmt::format("grouser render {} --film {}/film.mp4", folder, folder));
  commands.push_back(fmt::format("grouser report {} -o {}/report.html", folder, folder));
  return commands;
}

/// Notes on generated data from the run and its bushing, each once.
json synthetic_notes(const RunFolder& run) {
  std::vector<std::string> notes = run.summary.provenance.synthetic;
  if (notes.empty() && run.scenario.bushing.synthetic)
    notes.push_back("The bushing was identified from generated, not measured, rig data.");
  return notes;
}

}  // namespace

json run_verdict(const RunSummary& summary) {
  const auto passed = std::ranges::count_if(summary.checks, &RunCheck::pass);
  const auto total = static_cast<long>(summary.checks.size());
  const bool completed = summary.status == RunStatus::completed;
  std::string text =
      fmt::format("Run {} after {}", name_of(summary.status), quantity_text(summary.simulated_time, "s"));
  if (total > 0)
    text += passed == total ? fmt::format("; all {} checks pass", total)
                            : fmt::format("; {} of {} checks fail", total - passed, total);
  if (!completed && !summary.message.empty()) text += ": " + summary.message;
  return {{"pass", completed && passed == total}, {"partial", false}, {"text", text}};
}

json run_headline(const RunSummary& summary) {
  json tiles = json::array();
  tiles.push_back(labelled_quantity("simulated", summary.simulated_time, "s", 3));
  for (const Headline& headline : k_headlines) {
    const auto result = std::ranges::find(summary.results, headline.result, &RunResult::name);
    if (result != summary.results.end())
      tiles.push_back(labelled_quantity(headline.label, result->value, result->unit, 3));
  }
  tiles.push_back(labelled_quantity("mean step", summary.steps.mean, "s", 3));
  tiles.push_back(labelled_quantity("energy residual of ∫|P| dt", summary.energy.residual_fraction, "1", 2));
  if (summary.simulated_time > 0.0)
    tiles.push_back(
        labelled_quantity("wall seconds a simulated second", summary.wall_time / summary.simulated_time, "1", 2));
  return tiles;
}

json run_facts(const RunFolder& run, const std::string& id, int level) {
  const RunSummary& summary = run.summary;
  json facts{{"id", id}, {"kind", "run"}, {"level", level}, {"sublevel", level + 1}, {"figure_level", level + 2}};
  facts["title"] = summary.name;
  facts["subtitle"] = fmt::format("{} · {}", summary.vehicle_name, summary.bushing_name);
  facts["status"] = name_of(summary.status);
  // Of a completed run the verdict says it all, but for what the run adds after a semicolon.
  const bool completed = summary.status == RunStatus::completed;
  const std::size_t remark = summary.message.find("; ");
  facts["remark"] = completed && remark != std::string::npos ? summary.message.substr(remark + 2) : "";
  facts["verdict"] = run_verdict(summary);
  facts["checks"] = check_facts(summary);
  facts["has_checks"] = !summary.checks.empty();
  facts["headline"] = run_headline(summary);
  facts["tile_columns"] = tile_columns(facts["headline"].size());
  facts["synthetic"] = synthetic_notes(run);
  facts["is_synthetic"] = !facts["synthetic"].empty();
  facts["playback"] = playback_facts(run);
  facts["film"] = film_facts(run);
  facts["huge_film"] = has_huge_film(run);
  facts["motion"] = facts["playback"].is_object() || facts["film"].is_object() || facts["huge_film"];
  facts["still"] = still_facts(run);
  facts["stills"] = facts["playback"].is_object() && !facts["film"].is_object() ? more_stills(run) : json::array();
  facts["has_stills"] = !facts["stills"].empty();
  facts["sections"] = section_facts(run, id);
  facts["tables"] = table_facts(summary);
  facts["results"] = result_rows(summary);
  facts["has_results"] = !facts["results"].empty();
  facts["contacts"] = contact_facts(summary);
  facts["has_contacts"] = !facts["contacts"].empty();
  facts["provenance"] = provenance_facts(summary.provenance, repeating_commands(run, facts["film"].is_object()));
  return facts;
}

}  // namespace grouser
