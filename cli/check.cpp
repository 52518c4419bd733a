#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.h"
#include "model/errors.h"
#include "model/fit.h"
#include "model/json_document.h"
#include "model/run.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

/// A kind of file and the reader that knows its rules.
struct Kind {
  std::string format;
  std::function<void(const fs::path&)> read;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"grouser.rig/1", [](const fs::path& file) { static_cast<void>(read_rig(file)); }},
      {"grouser.bushing/1", [](const fs::path& file) { static_cast<void>(read_bushing(file)); }},
      {"grouser.fit/1", [](const fs::path& file) { static_cast<void>(read_fit(file)); }},
      {"grouser.vehicle/1", [](const fs::path& file) { static_cast<void>(read_vehicle(file)); }},
      {"grouser.scenario/1", [](const fs::path& file) { static_cast<void>(read_scenario(file)); }},
      {"grouser.run/1", [](const fs::path& file) { static_cast<void>(read_run_summary(file)); }},
  };
  return all;
}

/// What the file says it is.
std::string stated_format(const fs::path& file) {
  Findings findings(file.string());
  const Json json = parse_json(read_whole(file), findings);
  findings.throw_if_any();
  if (!json.is_object() || !json.contains("format") || !json["format"].is_string()) {
    throw InputError(InputFinding{file.string(), "/format", "a text such as \"grouser.vehicle/1\"", "none", ""});
  }
  return json["format"].get<std::string>();
}

/// Returns the format of a file that is right; throws otherwise.
std::string check(const fs::path& file) {
  if (fs::is_directory(file)) {
    static_cast<void>(open_run(file));
    return "run folder";
  }
  const std::string format = stated_format(file);
  const auto kind =
      std::find_if(kinds().begin(), kinds().end(), [&](const Kind& each) { return each.format == format; });
  if (kind == kinds().end()) {
    std::vector<std::string> known;
    std::string expected = "one of";
    for (const Kind& each : kinds()) {
      known.push_back(each.format);
      expected += " " + each.format;
    }
    throw InputError(
        InputFinding{file.string(), "/format", expected, format, did_you_mean(nearest_word(format, known))});
  }
  kind->read(file);
  return format;
}

/// Every file is checked, whatever the ones before it hold; the worst exit code stands.
Result run(const std::vector<std::string>& files, Console& console) {
  Result all;
  for (const std::string& file : files) {
    Result one = guard(console, [&] {
      Result right;
      right.json["format"] = check(file);
      right.lines.push_back(fmt::format("{}: ok ({})", file, right.json["format"].get<std::string>()));
      return right;
    });
    nlohmann::ordered_json entry{{"file", file}, {"ok", one.code == ExitCode::done}};
    entry.update(one.json);
    all.json["files"].push_back(entry);
    all.lines.insert(all.lines.end(), one.lines.begin(), one.lines.end());
    all.code = std::max(all.code, one.code);
  }
  return all;
}

}  // namespace

Command add_check(CLI::App& root) {
  CLI::App* app = root.add_subcommand("check", "Read any input file; print ok, or every error with its place");
  const auto files = std::make_shared<std::vector<std::string>>();
  app->add_option("FILE", *files, "rig, bushing, fit, vehicle, scenario or run file (JSON), or a run folder")
      ->required();
  app->footer("A rig or scenario file is checked together with the files that it names.");
  return {app, [files](Console& console) { return run(*files, console); }};
}

}  // namespace grouser::cli
