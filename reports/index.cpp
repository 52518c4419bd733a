#include <fmt/format.h>

#include <algorithm>

#include "model/errors.h"
#include "render/render.h"
#include "reports/assets.h"
#include "reports/channels.h"
#include "reports/encode.h"
#include "reports/figure_block.h"
#include "reports/fit_figures.h"
#include "reports/number_text.h"
#include "reports/pages.h"
#include "reports/report.h"
#include "reports/twin.h"

namespace grouser {
namespace {

using nlohmann::json;

std::string encoded(const Image& image) {
  const std::vector<std::uint8_t> bytes = encode_webp(image, k_photograph_quality);
  return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

json file_links(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  json links = json::array();
  for (const std::string& name : names)
    if (std::filesystem::exists(folder / name))
      links.push_back({{"href", folder.filename().string() + "/" + name}, {"text", name}});
  return links;
}

json card(const std::filesystem::path& folder, json facts) {
  facts["href"] = folder.filename().string() + "/report.html";
  facts["folder"] = folder.filename().string();
  return facts;
}

/// The vehicle halfway through its run.
std::string run_picture(const RunFolder& run) {
  RenderOptions options;
  options.width = 800;
  options.height = 450;
  return encoded(render_still(run, 0.5 * run.summary.simulated_time, options));
}

json run_card(const std::filesystem::path& folder) {
  const RunFolder run = open_run(folder);
  const RunSummary& summary = run.summary;
  json facts{
      {"kind", "Run"}, {"title", summary.name}, {"verdict", run_verdict(summary)}, {"numbers", run_headline(summary)}};
  facts["payload_picture"] = run_picture(run);
  facts["payload_dark"] = false;  // a photograph is the same by night
  facts["alt"] = "The vehicle in " + summary.name;
  facts["links"] = file_links(folder, {"report.html", "report.json", "film.mp4", "run.json", "run.h5"});
  facts["is_synthetic"] = run.scenario.bushing.synthetic || !summary.provenance.synthetic.empty();
  return card(folder, facts);
}

json fit_card(const std::filesystem::path& folder) {
  const FitFolder opened = open_fit(folder);
  const FitRecord& fit = opened.fit;
  json facts{{"kind", "Identification"},
             {"title", fit.specimen},
             {"verdict", fit_verdict(fit)},
             {"numbers", fit_headline(fit)}};
  facts["payload_picture"] = false;
  facts["payload_dark"] = false;
  if (!fit.axes.empty())
    if (std::optional<Figure> figure = figure_backbone(fit.axes.front())) {
      figure->title.clear();
      figure->width = 800;
      figure->height = 450;
      facts["payload_picture"] = encoded(draw(*figure, Theme::light, 1.5));
      facts["payload_dark"] = encoded(draw(*figure, Theme::dark, 1.5));
      facts["alt"] = text_alternative(*figure);
    }
  facts["links"] = file_links(folder, {"report.html", "report.json", "bushing.json", "fit.json"});
  facts["is_synthetic"] = fit.synthetic;
  return card(folder, facts);
}

json rig_card(const std::filesystem::path& folder) {
  const ReplayRecord replay = read_replay(folder / "replay.json");
  json facts{{"kind", "Virtual rig"},           {"title", replay.bushing},  {"verdict", rig_verdict(replay)},
             {"numbers", rig_headline(replay)}, {"payload_picture", false}, {"payload_dark", false}};
  const auto drawn = std::ranges::find_if(replay.tests, [](const TestFit& t) { return !t.curve.fitted.empty(); });
  if (drawn != replay.tests.end()) {
    Figure figure = *figure_loops({&*drawn}, "virtual rig");
    figure.title.clear();
    figure.columns = 1;
    figure.width = 800;
    figure.height = 450;
    facts["payload_picture"] = encoded(draw(figure, Theme::light, 1.5));
    facts["payload_dark"] = encoded(draw(figure, Theme::dark, 1.5));
    facts["alt"] = text_alternative(figure);
  }
  facts["links"] = file_links(folder, {"report.html", "report.json", "replay.json", "rig.json"});
  facts["is_synthetic"] = !replay.provenance.synthetic.empty();
  return card(folder, facts);
}

/// The first of the study's small multiples, from the numbers of its report.
std::optional<Figure> study_picture(const json& report) {
  if (!report.at("study").is_object()) return std::nullopt;
  const json& data = report.at("study").at("figure").at("tiles").at(0).at("data");
  const json& x = report.at("study").at("parameter").at("values");
  Panel panel{.title = data.at("title"), .x_label = data.at("x_label"), .y_label = data.at("y_label")};
  panel.log_x = x.at(0) > 0.0 && x.at(x.size() - 1) >= 4.0 * x.at(0).get<double>();
  for (const json& series : data.at("series"))
    panel.series.push_back({.name = series.at("name"),
                            .x = series.at("x"),
                            .y = series.at("y"),
                            .style = series.at("name") == "" ? SeriesStyle::points : SeriesStyle::line,
                            .width = series.at("name") == "" ? 3.5f : 1.8f,
                            .hue = static_cast<int>(panel.series.size() / 2)});
  Figure figure{.name = "study", .panels = {panel}};
  figure.width = 800;
  figure.height = 450;
  return figure;
}

/// The first folder below that holds a run.
std::optional<std::filesystem::path> run_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> runs;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / "run.json")) runs.push_back(entry.path());
  return runs.empty() ? std::nullopt : std::optional(*std::ranges::min_element(runs));
}

/// Runs that were compared in a folder of their own: a study of the demo.
json study_card(const std::filesystem::path& folder) {
  const json report = json::parse(read_whole(folder / "report.json"));
  const json& runs = report.at("comparison").at("runs");
  const auto passed = std::ranges::count_if(runs, [](const json& run) { return run.at("pass").get<bool>(); });
  const bool all = passed == static_cast<long>(runs.size());
  json facts{{"kind", "Study"}, {"title", report.at("page_title")}};
  facts["verdict"] = {
      {"pass", all},
      {"partial", passed > 0},
      {"text", all ? fmt::format("{} complete and pass their checks",
                                 runs.size() == 2 ? "both runs" : fmt::format("all {} runs", runs.size()))
                   : fmt::format("{} of {} runs complete and pass their checks", passed, runs.size())}};
  facts["numbers"] = json::array();
  for (const json& run : runs)
    facts["numbers"].push_back(
        {{"label", run.at("name")},
         {"text", run.at("pass").get<bool>() || run.at("status") != "completed" ? run.at("status")
                                                                                : json("not all checks pass")}});
  facts["payload_picture"] = facts["payload_dark"] = false;
  if (const std::optional<Figure> figure = study_picture(report)) {
    facts["payload_picture"] = encoded(draw(*figure, Theme::light, 1.5));
    facts["payload_dark"] = encoded(draw(*figure, Theme::dark, 1.5));
    facts["alt"] = text_alternative(*figure);
  } else if (const std::optional<std::filesystem::path> run = run_below(folder)) {
    facts["payload_picture"] = run_picture(open_run(*run));
    facts["alt"] = "The vehicle of the study";
  }
  facts["links"] = file_links(folder, {"report.html", "report.json"});
  facts["is_synthetic"] = report.at("comparison").at("is_synthetic");
  return card(folder, facts);
}

/// Throws FileError where the report says that it is of ours, and is not as this program writes it.
json checked_study_card(const std::filesystem::path& folder) {
  try {
    return study_card(folder);
  } catch (const json::exception& error) {
    throw FileError("cannot read " + (folder / "report.json").string() +
                    ": expected the numbers of compared runs, found " + error.what());
  }
}

/// A folder without a result of its own whose report compares the runs below it.
bool holds_study(const std::filesystem::path& folder) {
  for (const char* own : {"run.json", "fit.json", "replay.json"})
    if (std::filesystem::exists(folder / own)) return false;
  const json head = head_of_twin(folder / "report.json");
  return head.is_object() && head.value("compares", json()) == true;
}

}  // namespace

void write_index(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> children;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_directory()) children.push_back(entry.path());
  std::ranges::sort(children);
  json page{{"cards", json::array()}, {"version", program_version()}};
  for (const std::filesystem::path& child : children) {
    if (std::filesystem::exists(child / "fit.json")) page["cards"].push_back(fit_card(child));
    if (std::filesystem::exists(child / "replay.json")) page["cards"].push_back(rig_card(child));
    if (std::filesystem::exists(child / "run.json")) page["cards"].push_back(run_card(child));
    if (holds_study(child)) page["cards"].push_back(checked_study_card(child));
  }
  if (page["cards"].empty())
    throw InputError(InputFinding{folder.string(), "", "folders with a run.json or a fit.json", "none", ""});
  page["is_synthetic"] =
      std::ranges::any_of(page["cards"], [](const json& c) { return c["is_synthetic"].get<bool>(); });
  page["whole"] = std::filesystem::exists(folder / "report.html");
  write_whole(folder / "index.html", render_page("index", page));
}

}  // namespace grouser
