#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "model/errors.h"
#include "reports/assets.h"
#include "reports/figure_block.h"
#include "reports/pages.h"
#include "reports/report.h"

namespace grouser {
namespace {

using nlohmann::json;

/// Folders that hold a run, folders that hold a fit; a folder that holds neither is the user's mistake.
struct Opened {
  std::vector<RunFolder> runs;
  std::vector<FitFolder> fits;
};

/// Runs of one name are told apart by their folders, everywhere on the page.
void name_apart(std::vector<RunFolder>& runs) {
  std::map<std::string, int> count;
  for (const RunFolder& run : runs) ++count[run.summary.name];
  for (RunFolder& run : runs)
    if (count[run.summary.name] > 1) run.summary.name += " · " + run.path.filename().string();
}

Opened open_folders(const std::vector<std::filesystem::path>& folders) {
  Opened opened;
  std::vector<InputFinding> findings;
  for (const std::filesystem::path& folder : folders) {
    if (!std::filesystem::exists(folder)) throw FileError("cannot read " + folder.string() + ": no such folder");
    if (std::filesystem::exists(folder / "run.json"))
      opened.runs.push_back(open_run(folder));
    else if (std::filesystem::exists(folder / "fit.json"))
      opened.fits.push_back(open_fit(folder));
    else
      findings.push_back({folder.string(), "", "a run folder (run.json) or a fit folder (fit.json)", "neither", ""});
  }
  if (!findings.empty()) throw InputError(findings);
  name_apart(opened.runs);
  return opened;
}

/// Links of the contents list: the parts of a single folder, or the folders of a mix.
json contents(const json& page) {
  json links = json::array();
  const auto add = [&](const std::string& key, const std::string& text) {
    links.push_back({{"key", key}, {"text", text}});
  };
  const bool single = page["runs"].size() + page["fits"].size() == 1;
  if (!single) {
    if (page["compares"]) add("comparison", "Comparison");
    for (const char* kind : {"fits", "runs"})
      for (const json& part : page[kind]) add(part["id"], part["title"]);
    return links;
  }
  for (const json& run : page["runs"]) {
    const std::string id = run["id"];
    if (run["has_checks"]) add(id + "-checks", "Checks");
    if (run["motion"]) add(id + "-motion", "Motion");
    for (const json& section : run["sections"]) add(section["key"], section["title"]);
    add(id + "-numbers", "Numbers");
    add(id + "-provenance", "Provenance");
  }
  for (const json& fit : page["fits"]) {
    const std::string id = fit["id"];
    add(id + "-checks", "Verdict");
    if (fit["has_warnings"]) add(id + "-warnings", "Warnings");
    add(id + "-corrections", "Corrections");
    for (const json& axis : fit["axes"]) add(axis["key"], "Axis " + axis["axis_title"].get<std::string>());
    if (fit["draws"].is_object()) add(id + "-draws", "Draws");
    add(id + "-provenance", "Provenance");
  }
  return links;
}

json page_facts(const Opened& opened) {
  const std::size_t parts = opened.runs.size() + opened.fits.size();
  const int level = parts == 1 ? 1 : 2;
  json page{{"format", "grouser.report/1"}, {"runs", json::array()}, {"fits", json::array()}, {"several", parts > 1}};
  for (std::size_t i = 0; i < opened.fits.size(); ++i)
    page["fits"].push_back(fit_facts(opened.fits[i], fmt::format("fit{}", i + 1), level));
  for (std::size_t i = 0; i < opened.runs.size(); ++i)
    page["runs"].push_back(run_facts(opened.runs[i], fmt::format("run{}", i + 1), level));
  page["compares"] = opened.runs.size() > 1;
  page["comparison"] = opened.runs.size() > 1 ? comparison_facts(opened.runs, "comparison", level) : json(false);
  if (parts == 1) {
    const json& part = opened.runs.empty() ? page["fits"][0] : page["runs"][0];
    page["page_title"] = part["title"];
  } else {
    page["page_title"] = opened.runs.size() == 1 && opened.fits.size() == 1
                             ? opened.fits[0].fit.specimen + " and " + opened.runs[0].summary.name
                             : fmt::format("{} results side by side", parts);
  }
  page["version"] = program_version();
  page["contents"] = contents(page);
  return page;
}

}  // namespace

void write_report(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& html_file) {
  const json page = page_facts(open_folders(folders));
  const std::string html = render_page("report", page);
  std::filesystem::path twin = html_file;
  twin.replace_extension(".json");
  write_whole(twin, without_payloads(page).dump(1) + "\n");
  write_whole(html_file, html);
}

}  // namespace grouser
