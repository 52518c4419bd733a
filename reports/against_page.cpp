#include "reports/against_page.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "reports/figure_block.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;

constexpr const char* k_measured = "measured";
constexpr const char* k_computed = "run";

json verdict_facts(const std::vector<RatedChannel>& rated, const RatingLimits& limits) {
  std::size_t judged = 0, passed = 0;
  for (const RatedChannel& channel : rated) {
    if (!channel.unrated.empty()) continue;
    ++judged;
    if (meets_limits(channel, limits)) ++passed;
  }
  const std::size_t unrated = rated.size() - judged;
  std::string text = judged == 0   ? "No channel can be rated"
                     : judged == 1 ? fmt::format("The channel {} every limit", passed == 1 ? "meets" : "does not meet")
                                   : fmt::format("{} {} channels meet every limit",
                                                 passed == judged ? "All" : fmt::format("{} of", passed), judged);
  if (judged > 0 && unrated > 0) text += fmt::format("; {} cannot be rated", unrated);
  return {{"pass", judged > 0 && passed == judged && unrated == 0}, {"partial", passed > 0}, {"text", text}};
}

json column_facts(const Measurement& measurement) {
  json rows = json::array();
  for (const MeasuredChannel& channel : measurement.channels)
    rows.push_back({{"column", channel.column},
                    {"channel", channel.channel.name},
                    {"unit", channel.channel.unit},
                    {"reversed", channel.reversed},
                    {"sign", channel.reversed ? "turned round" : "as measured"},
                    {"meaning", channel.channel.meaning},
                    {"samples",
                     {{"value", channel.series.time.size()},
                      {"text", count_text(static_cast<long>(channel.series.time.size()))}}}});
  return rows;
}

/// An argument as a shell wants it.
std::string quoted(const std::string& text) {
  const bool plain = !text.empty() && text.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=./:,") == std::string::npos;
  if (plain) return text;
  std::string words = "'";
  for (const char c : text) words += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return words + "'";
}

json repeat_facts(const RunFolder& run, const Measurement& measurement, const ReportOptions& options) {
  Provenance provenance = run.summary.provenance;
  provenance.options.clear();
  std::string command = fmt::format("grouser report {} --against {}", quoted(run.path.filename().string()),
                                    quoted(measurement.file.string()));
  const auto add = [&](const std::string& name, const std::string& value) {
    command += fmt::format(" {} {}", name, quoted(value));
  };
  for (const auto& [column, channel] : options.channels) add("--channel", column + "=" + channel);
  if (options.shift != 0.0) add("--shift", fmt::format("{}", options.shift));
  if (std::isfinite(options.from)) add("--from", fmt::format("{}", options.from));
  if (std::isfinite(options.to)) add("--to", fmt::format("{}", options.to));
  for (const std::string& limit : options.limits) add("--limit", limit);
  provenance.inputs.insert(provenance.inputs.begin(), {{"measurement", measurement.file.string(), measurement.sha256},
                                                       {"run", "run.json", sha256_of_file(run.path / "run.json")}});
  return provenance_facts(provenance, {run.summary.provenance.command, command});
}

}  // namespace

std::vector<RatedChannel> rate_against(const RunFolder& run, const Measurement& measurement,
                                       const ReportOptions& options) {
  std::vector<RatedChannel> rated;
  for (const MeasuredChannel& measured : measurement.channels)
    rated.push_back(rate_channel(measured.channel, measured.series, read_channel(run, measured.channel),
                                 {options.from, options.to}));
  return rated;
}

json against_facts(const RunFolder& run, const Measurement& measurement, const std::vector<RatedChannel>& rated,
                   const RatingLimits& limits, const ReportOptions& options, const std::string& id, int level) {
  json facts{{"id", id}, {"level", level}, {"sublevel", level + 1}, {"figure_level", level + 2}};
  facts["title"] = fmt::format("{} against {}", run.summary.name, measurement.file.filename().string());
  facts["subtitle"] = fmt::format("{} · {}", run.summary.vehicle_name, run.summary.bushing_name);
  facts["verdict"] = verdict_facts(rated, limits);
  facts["run_verdict"] = run_verdict(run.summary);
  facts["synthetic"] = run.summary.provenance.synthetic;
  facts["is_synthetic"] = !run.summary.provenance.synthetic.empty();
  facts["ratings"] = ratings_facts(rated, limits, true);
  facts["ratings"]["caption"] = "Each channel of the run against the measured one";
  facts["columns"] = column_facts(measurement);
  facts["left_out"] = measurement.left_out;
  facts["has_left_out"] = !measurement.left_out.empty();
  facts["shift"] = options.shift == 0.0 ? json(false) : quantity_facts(options.shift, "s");
  facts["figures"] = json::array();
  for (const RatedChannel& channel : rated) {
    const std::string figure = id + "-figure-" + channel.name;
    facts["figures"].push_back(
        figure_block(overlay_figure({&channel}, k_measured, {k_computed}, rated_span(channel)), figure));
    if (const std::optional<Figure> close = close_figure(channel, k_measured, k_computed))
      facts["figures"].push_back(figure_block(*close, figure + "-close"));
  }
  const Figure cross = cross_figure(rated, k_measured, k_computed);
  facts["cross"] = cross.panels.empty() ? json(false) : figure_block(cross, id + "-figure-cross");
  facts["provenance"] = repeat_facts(run, measurement, options);
  return facts;
}

}  // namespace grouser
