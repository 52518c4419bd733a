#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

#include "model/errors.h"
#include "model/replace_file.h"
#include "reports/against_page.h"
#include "reports/assets.h"
#include "reports/figure_block.h"
#include "reports/pages.h"
#include "reports/report.h"
#include "reports/twin.h"

namespace grouser {
namespace {

using nlohmann::json;

constexpr std::ptrdiff_t k_longest_path = 64;  // parts; one folder given twice cannot be told apart

/// Folders that hold a run, a fit or a virtual rig's replay; a folder that holds none is the user's mistake.
struct Opened {
  std::vector<RunFolder> runs;
  std::vector<FitFolder> fits;
  std::vector<RigFolder> rigs;
};

/// The last `depth` parts of a path.
std::string path_end(const std::filesystem::path& path, std::ptrdiff_t depth) {
  const auto parts = std::distance(path.begin(), path.end());
  std::filesystem::path end;
  for (auto part = std::next(path.begin(), std::max<std::ptrdiff_t>(parts - depth, 0)); part != path.end(); ++part)
    end /= *part;
  return end.string();
}

/// Results of one name are told apart by as much of their folders as it takes, everywhere on the page.
template <typename Folder, typename Name>
void name_apart(std::vector<Folder>& folders, const Name& name) {
  std::map<std::string, std::vector<Folder*>> alike;
  for (Folder& folder : folders) alike[name(folder)].push_back(&folder);
  for (const auto& [shared, group] : alike) {
    if (group.size() < 2) continue;
    std::set<std::string> ends;
    for (std::ptrdiff_t depth = 1; ends.size() < group.size() && depth <= k_longest_path; ++depth) {
      ends.clear();
      for (Folder* folder : group) {
        const std::string end = path_end(std::filesystem::absolute(folder->path).lexically_normal(), depth);
        ends.insert(end);
        name(*folder) = shared + " · " + end;
      }
    }
  }
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
    else if (std::filesystem::exists(folder / "replay.json"))
      opened.rigs.push_back({folder, read_replay(folder / "replay.json")});
    else
      findings.push_back({folder.string(), "",
                          "a run folder (run.json), a fit folder (fit.json) or a virtual rig (replay.json)", "neither",
                          ""});
  }
  if (!findings.empty()) throw InputError(findings);
  name_apart(opened.runs, [](RunFolder& run) -> std::string& { return run.summary.name; });
  name_apart(opened.fits, [](FitFolder& folder) -> std::string& { return folder.fit.specimen; });
  name_apart(opened.rigs, [](RigFolder& folder) -> std::string& { return folder.replay.bushing; });
  return opened;
}

/// Runs of a study stand in the order of its parameter and are called after it.
std::optional<InputDifference> arrange_study(std::vector<RunFolder>& runs) {
  std::optional<InputDifference> parameter = study_parameter(runs);
  if (!parameter) return parameter;
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return parameter->numbers[k].value(); });
  std::vector<RunFolder> sorted;
  InputDifference rising{parameter->label, parameter->unit, {}, {}};
  for (const std::size_t k : order) {
    rising.numbers.push_back(parameter->numbers[k]);
    rising.texts.push_back(parameter->texts[k]);
    sorted.push_back(std::move(runs[k]));
    sorted.back().summary.name = parameter->label + " " + parameter->texts[k];
  }
  runs = std::move(sorted);
  return rising;
}

/// Links of the contents list: the parts of a single folder, or the folders of a mix.
json contents(const json& page) {
  json links = json::array();
  const auto add = [&](const std::string& key, const std::string& text) {
    links.push_back({{"key", key}, {"text", text}});
  };
  const bool single = !page["compares"] && page["runs"].size() + page["fits"].size() + page["rigs"].size() == 1;
  if (!single) {
    if (page["study"].is_object()) add("study", page["study"]["title"]);
    if (page["compares"]) add("comparison", "Comparison");
    if (page["fit_comparison"].is_object()) add("fit-comparison", "Fits side by side");
    for (const char* kind : {"fits", "rigs", "runs"})
      for (const json& part : page[kind]) add(part["id"], part["title"]);
    return links;
  }
  for (const json& run : page["runs"]) {
    const std::string id = run["id"];
    if (run["has_checks"]) add(id + "-checks", "Checks");
    for (const json& section : run["sections"]) add(section["key"], section["title"]);
    if (run["motion"]) add(id + "-motion", "Motion");
    add(id + "-numbers", "Numbers");
    add(id + "-provenance", "How to repeat it");
  }
  for (const char* kind : {"fits", "rigs"})
    for (const json& part : page[kind]) {
      const std::string id = part["id"];
      add(id + "-checks", "Verdict");
      if (part["has_warnings"]) add(id + "-warnings", "Warnings");
      if (kind == std::string("fits") || part["has_corrections"]) add(id + "-corrections", "Corrections");
      for (const json& axis : part["axes"]) add(axis["key"], "Axis " + axis["axis_title"].get<std::string>());
      if (part.contains("draws") && part["draws"].is_object()) add(id + "-draws", "Draws");
      add(id + "-provenance", "How to repeat it");
    }
  return links;
}

/// Tells how far a page is, part by part, and stops there when asked to.
class PartsDone {
 public:
  PartsDone(const Progress& progress, std::size_t parts) : progress_(progress), parts_(parts) {}
  void begin(const std::string& what) {
    const double fraction = static_cast<double>(done_++) / static_cast<double>(parts_);
    if (progress_ && !progress_({fraction, what})) throw Interrupted("before the report was whole");
  }

 private:
  const Progress& progress_;
  std::size_t parts_, done_ = 0;
};

/// Each run of a study has a page of its own; here it would bury the study.
void add_runs(Opened& opened, int level, PartsDone& parts, json& page) {
  const std::optional<InputDifference> parameter = arrange_study(opened.runs);
  page["study"] = parameter ? study_facts(opened.runs, *parameter, "study", level) : json(false);
  if (parameter) return;
  for (std::size_t i = 0; i < opened.runs.size(); ++i) {
    parts.begin(opened.runs[i].summary.name);
    page["runs"].push_back(run_facts(opened.runs[i], fmt::format("run{}", i + 1), level));
  }
}

std::string title_of(const json& page, const Opened& opened, std::size_t parts) {
  if (parts == 1)
    for (const char* kind : {"fits", "rigs", "runs"})
      if (!page[kind].empty()) return page[kind][0]["title"];
  if (page["study"].is_object() && parts == opened.runs.size()) return page["study"]["title"];
  if (page["comparison"].is_object() && page["comparison"]["connection"].is_object() && parts == 2)
    return page["comparison"]["connection"]["title"];
  return parts == 2 && opened.runs.size() == 1 && opened.fits.size() == 1
             ? opened.fits[0].fit.specimen + " and " + opened.runs[0].summary.name
             : fmt::format("{} results side by side", parts);
}

/// A page without any part.
json empty_page(bool several) {
  return {{"format", k_report_format}, {"against", json::array()},
          {"runs", json::array()},     {"fits", json::array()},
          {"rigs", json::array()},     {"study", false},
          {"compares", false},         {"comparison", false},
          {"fit_comparison", false},   {"version", program_version()},
          {"several", several}};
}

RatingLimits limits_of(const ReportOptions& options) {
  RatingLimits limits;
  for (const std::string& limit : options.limits) limits.set(limit);
  return limits;
}

json page_facts(Opened opened, const ReportOptions& options) {
  const std::size_t parts = opened.runs.size() + opened.fits.size() + opened.rigs.size();
  const int level = parts == 1 ? 1 : 2;
  json page = empty_page(parts > 1);
  PartsDone done(options.progress, parts);
  for (std::size_t i = 0; i < opened.fits.size(); ++i) {
    done.begin(opened.fits[i].fit.specimen);
    page["fits"].push_back(fit_facts(opened.fits[i], fmt::format("fit{}", i + 1), level));
  }
  for (std::size_t i = 0; i < opened.rigs.size(); ++i) {
    done.begin(opened.rigs[i].replay.bushing);
    page["rigs"].push_back(rig_facts(opened.rigs[i], fmt::format("rig{}", i + 1), level));
  }
  add_runs(opened, level, done, page);
  page["compares"] = opened.runs.size() > 1;
  if (opened.runs.size() > 1)
    page["comparison"] =
        comparison_facts(opened.runs, {{options.from, options.to}, limits_of(options)}, "comparison", level);
  if (opened.fits.size() > 1) page["fit_comparison"] = fit_comparison_facts(opened.fits, "fit-comparison", level);
  page["page_title"] = title_of(page, opened, parts);
  page["contents"] = contents(page);
  return page;
}

/// Links of a page of runs against a measurement.
json against_contents(const json& page) {
  json links = json::array();
  for (const json& part : page["against"]) {
    const std::string id = part["id"];
    if (page["several"].get<bool>()) {
      links.push_back({{"key", id}, {"text", part["title"]}});
      continue;
    }
    links.push_back({{"key", id + "-ratings"}, {"text", "Ratings"}});
    for (const json& figure : part["figures"])
      if (!figure["name"].get<std::string>().ends_with("_zoom"))
        links.push_back({{"key", figure["id"]}, {"text", figure["title"]}});
    if (part["cross"].is_object()) links.push_back({{"key", part["cross"]["id"]}, {"text", part["cross"]["title"]}});
    links.push_back({{"key", id + "-channels"}, {"text", "Channels"}});
    links.push_back({{"key", id + "-provenance"}, {"text", "How to repeat it"}});
  }
  return links;
}

/// Runs against a measurement, and nothing else: each has a page of its own for the rest.
json against_page(const Opened& opened, const ReportOptions& options, std::vector<ChannelVerdict>& verdicts) {
  if (!opened.fits.empty() || !opened.rigs.empty())
    throw InputError(InputFinding{(opened.fits.empty() ? opened.rigs.front().path : opened.fits.front().path).string(),
                                  "", "a run folder, as of everything that is held against a measurement",
                                  "a folder without a run", ""});
  const RatingLimits limits = limits_of(options);
  const bool several = opened.runs.size() > 1;
  json page = empty_page(several);
  PartsDone done(options.progress, opened.runs.size());
  for (std::size_t i = 0; i < opened.runs.size(); ++i) {
    const RunFolder& run = opened.runs[i];
    done.begin(run.summary.name);
    const Measurement measurement = read_measurement(options.against, channels_of(run), options);
    const std::vector<RatedChannel> rated = rate_against(run, measurement, options);
    for (const RatedChannel& channel : rated)
      verdicts.push_back({run.summary.name, channel.name, channel.unrated.empty() && meets_limits(channel, limits),
                          rating_verdict(channel, limits)});
    page["against"].push_back(
        against_facts(run, measurement, rated, limits, options, fmt::format("against{}", i + 1), several ? 2 : 1));
  }
  page["page_title"] = several
                           ? fmt::format("{} runs against {}", opened.runs.size(), options.against.filename().string())
                           : page["against"][0]["title"].get<std::string>();
  page["contents"] = against_contents(page);
  return page;
}

}  // namespace

std::string limit_problem(const std::string& limit) {
  try {
    RatingLimits().set(limit);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::vector<ChannelEntry> run_channels(const std::filesystem::path& folder) {
  constexpr std::size_t k_each = 8;  // of a dataset, more are told by the first and the last
  std::vector<ChannelEntry> entries;
  const std::vector<RunChannel> channels = channels_of(open_run(folder));
  for (std::size_t i = 0; i < channels.size();) {
    const RunChannel& first = channels[i];
    std::size_t end = i + 1;
    while (end < channels.size() && !first.column.dataset.empty() &&
           channels[end].column.dataset == first.column.dataset)
      ++end;
    const bool many = end - i > k_each;
    if (many) entries.push_back({first.name + " … " + channels[end - 1].name, first.unit, first.meaning});
    for (std::size_t k = i; !many && k < end; ++k)
      entries.push_back({channels[k].name, channels[k].unit, channels[k].meaning});
    i = end;
  }
  return entries;
}

namespace {

std::filesystem::path twin_of(std::filesystem::path html_file) { return html_file.replace_extension(".json"); }

/// What bears the name of the numbers beside a page is their like, a link, whose place they take, or nothing: never a
/// file that somebody else made.
void require_twin(const std::filesystem::path& twin) {
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(twin)) || head_of_twin(twin).is_object())
    return;
  throw FileError("cannot write " + twin.string() + ": expected the numbers of an earlier report there (" +
                  k_report_format + ") or nothing, found another file");
}

}  // namespace

void require_place_of_report(const std::filesystem::path& html_file) {
  for (const std::filesystem::path& made : {html_file, twin_of(html_file)}) require_place_of_file(made);
  require_twin(twin_of(html_file));
}

std::vector<ChannelVerdict> write_report(const std::vector<std::filesystem::path>& folders,
                                         const std::filesystem::path& html_file, const ReportOptions& options) {
  require_place_of_report(html_file);
  std::vector<ChannelVerdict> verdicts;
  const json page = options.against.empty() ? page_facts(open_folders(folders), options)
                                            : against_page(open_folders(folders), options, verdicts);
  const std::string html = render_page("report", page);
  if (options.progress && !options.progress({1.0, ""})) throw Interrupted("before the report was whole");
  write_whole(twin_of(html_file), twin_text(page));
  write_whole(html_file, html);
  return verdicts;
}

}  // namespace grouser
