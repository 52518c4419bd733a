#include "model/check.h"

#include "model/camera_view.h"
#include "model/file_json.h"
#include "model/fit.h"
#include "model/replay.h"
#include "model/rig.h"
#include "model/run.h"

namespace grouser {
namespace {

std::string count(std::size_t number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

std::string check_rig(const std::filesystem::path& file) {
  const RigRecord rig = read_rig(file);
  std::size_t samples = 0, protocols = 0;
  for (const RigTest& test : rig.tests) {
    samples += test.force.size();
    protocols += test.protocol ? 1 : 0;
  }
  return "rig data of " + rig.specimen + ", " + count(rig.tests.size(), "test") + ", " + count(samples, "sample") +
         (protocols > 0 ? ", " + count(protocols, "protocol") + " without a measurement" : "");
}

std::string check_bushing(const std::filesystem::path& file) {
  const Bushing bushing = read_bushing(file);
  std::string axes;
  for (int i = 0; i < k_num_axes; ++i) {
    if (!bushing.axes[static_cast<std::size_t>(i)].spring.displacement.empty()) {
      axes.append(" ").append(name_of(static_cast<Axis>(i)));
    }
  }
  return "bushing " + bushing.name + ", axes" + axes;
}

std::string check_fit(const std::filesystem::path& file) {
  const FitRecord fit = read_fit(file);
  return "fit of " + fit.specimen + ", " + count(fit.tests.size(), "test");
}

std::string check_replay(const std::filesystem::path& file) {
  const ReplayRecord replay = read_replay(file);
  return "replay on the bushing " + replay.bushing + ", " + count(replay.tests.size(), "test");
}

std::string check_vehicle(const std::filesystem::path& file) {
  const Vehicle vehicle = read_vehicle(file);
  const RunningGear& left = vehicle.side(Side::left);
  return "vehicle " + vehicle.name + ", " + count(left.stations.size(), "station") + " and " +
         count(static_cast<std::size_t>(left.track.num_links), "link") + " on the left";
}

std::string check_scenario(const std::filesystem::path& file) {
  const Scenario scenario = read_scenario(file);
  return "scenario " + scenario.name + ", " + Json(scenario.duration).dump() + " s";
}

std::string check_run(const std::filesystem::path& file) {
  const RunSummary run = read_run_summary(file);
  return "run " + run.name + ", " + name_of(run.status);
}

std::string check_camera(const std::filesystem::path& file) { return "camera " + read_camera_view(file).name; }

struct Kind {
  const char* format;
  std::string (*check)(const std::filesystem::path&);
};
constexpr Kind k_kinds[] = {{k_rig_format, check_rig},         {k_bushing_format, check_bushing},
                            {k_fit_format, check_fit},         {k_replay_format, check_replay},
                            {k_vehicle_format, check_vehicle}, {k_scenario_format, check_scenario},
                            {k_run_format, check_run},         {k_camera_format, check_camera}};

/// The file's `format`; throws InputError when it has no readable one.
std::string format_of(const std::filesystem::path& file) {
  Findings findings(file.string());
  const Json document = parse_json(read_whole(file), findings);
  if (document.is_null()) findings.throw_if_any();
  const char* const expected = "the key format, as in \"format\": \"grouser.vehicle/1\"";
  if (!document.is_object()) throw InputError(InputFinding{file.string(), "", expected, shown(document), ""});
  const auto format = document.find("format");
  if (format == document.end()) throw InputError(InputFinding{file.string(), "", expected, "no such key", ""});
  if (format->is_string()) return format->get<std::string>();
  throw InputError(InputFinding{file.string(), "/format", "a text, as in \"grouser.vehicle/1\"", shown(*format), ""});
}

}  // namespace

std::string check_file(const std::filesystem::path& file) {
  const std::string format = format_of(file);
  std::vector<std::string> formats;
  for (const Kind& kind : k_kinds) {
    if (format == kind.format) return "ok: " + kind.check(file);
    formats.emplace_back(kind.format);
  }
  std::string expected;
  for (const std::string& known : formats) expected += (expected.empty() ? "\"" : " | \"") + known + "\"";
  throw InputError(InputFinding{file.string(), "/format", expected, "\"" + format + "\"",
                                did_you_mean(nearest_word(format, formats))});
}

}  // namespace grouser
