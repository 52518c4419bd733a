#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "cli/command.h"
#include "cli/stages.h"
#include "identification/corrections.h"
#include "identification/evaluate_fit.h"
#include "model/errors.h"
#include "model/provenance.h"
#include "model/replace_file.h"
#include "model/rig_writer.h"
#include "reports/report.h"
#include "simulator/virtual_rig.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string rig_file, bushing_file;
  std::string folder = "out/virtual_rig";
};

/// The virtual rig drives a test only along an axis for which the bushing has a law.
void require_laws(const RigRecord& rig, const Bushing& bushing, const std::string& bushing_file) {
  std::vector<InputFinding> findings;
  std::set<Axis> told;
  for (const RigTest& test : rig.tests) {
    if (!bushing.axis(test.axis).spring.displacement.empty() || !told.insert(test.axis).second) continue;
    findings.push_back({bushing_file, fmt::format("/axes/{}", name_of(test.axis)),
                        fmt::format("a law for the test \"{}\" of {}", test.name, rig.path.string()), "none", ""});
  }
  if (!findings.empty()) throw InputError(findings);
}

constexpr const char* k_computed = "computed by the virtual rig, not measured";

/// A rig.json that no virtual rig wrote: its note tells, also where a kill left it without its replay.json.
bool is_campaign_of_others(const fs::path& rig_file) {
  return fs::is_regular_file(rig_file) && read_whole(rig_file).find(k_computed) == std::string::npos;
}

/// The output has a folder of its own: never the campaign's, nor that of a fit or a run, whose report it would replace.
void require_own_folder(const RigRecord& rig, const fs::path& folder) {
  const auto refuse = [&](const std::string& found) {
    throw FileError(fmt::format("{}: expected a folder of its own for the output, found {}", folder.string(), found));
  };
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) refuse("a file");
  const fs::path campaign = fs::absolute(rig.path).parent_path();
  if (fs::equivalent(campaign, folder)) refuse("that of " + rig.path.string());
  for (const RigTest& test : rig.tests) {
    if (fs::equivalent((campaign / test.file).parent_path(), folder)) refuse("that of " + test.file);
  }
  for (const char* name : {"fit.json", "run.json"}) {
    if (fs::exists(folder / name)) refuse(name);
  }
  if (is_campaign_of_others(folder / "rig.json")) refuse("rig.json of another campaign");
}

/// The name of a test as a file name that no other test has: plain letters, fewer than file systems take.
std::string file_of(const std::string& test, std::set<std::string>& taken) {
  std::string name = test.substr(0, 100);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.' && c != '-'; }, '_');
  while (!taken.insert(name).second) name += '_';
  return name + ".csv";
}

/// The same test on the virtual rig, as a campaign of its own would hold it.
RigTest virtual_test(const PreparedTest& prepared, std::vector<double> force, std::set<std::string>& taken) {
  const RigTest& source = *prepared.source;
  RigTest test;
  test.name = source.name;
  test.axis = source.axis;
  test.kind = source.kind;
  test.file = file_of(source.name, taken);
  test.preset = source.preset;
  if (source.discard_cycles) {
    // Cycles long before the first used one were not driven.
    const auto skipped = std::ranges::count_if(prepared.cycles, [](const Cycle& cycle) { return !cycle.followed(); });
    test.discard_cycles = std::max(0, *source.discard_cycles - static_cast<int>(skipped));
  }
  test.time = prepared.time;
  test.time_measured = prepared.rate_known;
  test.displacement = prepared.displacement;
  test.force = std::move(force);
  return test;
}

void warn_of_rate(const PreparedTest& test, std::vector<FitWarning>& warnings) {
  if (test.rate_known) return;
  warnings.push_back({"rate_unknown", test.source->name,
                      "the record tells no rate: its samples are driven one second apart, so that the Maxwell "
                      "branches answer to a rate that nobody measured"});
}

/// Where the law is driven beyond what it was identified for.
void warn_of_reach(const RigTest& test, const std::vector<double>& displacement, const AxisLaw& law,
                   std::vector<FitWarning>& warnings) {
  if (!law.valid || displacement.empty()) return;
  const auto [low, high] = std::ranges::minmax(displacement);
  const double reach = std::max(std::abs(low), std::abs(high));
  constexpr double k_rounding = 1e-3;  // a limit that was rounded by its file
  if (reach > law.valid->amplitude * (1.0 + k_rounding)) {
    warnings.push_back({"outside_valid_range", test.name,
                        fmt::format("driven to {:.4g} {}, but the law was identified to {:.4g} only", reach,
                                    is_rotation(test.axis) ? "rad" : "m", law.valid->amplitude)});
  }
}

/// What the virtual rig alone says of a test that nobody measured: its cycles are found as in any record.
TestFit prediction_of(const RigTest& driven) {
  const RigRecord bare;
  std::vector<FitWarning> about_data;
  std::vector<AppliedCorrection> corrections;
  const PreparedTest prepared = prepare_test(driven, bare, about_data, corrections);
  TestFit test = evaluate_fit(prepared, prepared.force);
  test.prediction = true;
  test.measured = {};
  test.nrmse = test.r_squared = test.force_zero = test.force_drift = test.gain = 0.0;
  test.curve.force.clear();
  for (CycleFit& cycle : test.per_cycle) {
    cycle.measured = {};
    cycle.nrmse = 0.0;
  }
  return test;
}

struct VirtualCampaign {
  RigRecord rig;        ///< what the virtual rig recorded
  ReplayRecord replay;  ///< against the measurement
};

VirtualCampaign drive_campaign(const RigRecord& rig, const Bushing& bushing, const Progress& progress) {
  VirtualCampaign made;
  std::set<std::string> taken;
  std::vector<PreparedTest> tests;
  for (const RigTest& test : rig.tests) {
    const double fraction = static_cast<double>(made.rig.tests.size()) / static_cast<double>(rig.tests.size());
    if (progress && !progress({fraction, test.name})) throw Interrupted("before: " + test.name);
    if (test.protocol) {
      RigTest& driven = made.rig.tests.emplace_back(run_protocol(bushing, test));
      driven.file = file_of(test.name, taken);
      made.replay.tests.push_back(prediction_of(driven));
      warn_of_reach(test, driven.displacement, bushing.axis(test.axis), made.replay.warnings);
      continue;
    }
    std::vector<FitWarning> about_data;
    const PreparedTest& prepared = tests.emplace_back(prepare_test(test, rig, about_data, made.replay.corrections));
    RigWrench wrench = run_virtual_rig(bushing, test.axis, prepared.time, prepared.displacement);
    std::vector<double>& force = wrench[static_cast<std::size_t>(index_of(test.axis))];
    made.replay.tests.push_back(evaluate_fit(prepared, force));
    // What the data show is identify's to tell, unless it leaves nothing to compare.
    if (prepared.cycles_used() == 0) std::ranges::copy(about_data, std::back_inserter(made.replay.warnings));
    warn_of_rate(prepared, made.replay.warnings);
    warn_of_reach(test, prepared.displacement, bushing.axis(test.axis), made.replay.warnings);
    made.rig.tests.push_back(virtual_test(prepared, std::move(force), taken));
  }
  if (!tests.empty()) std::ranges::copy(campaign_corrections(tests, rig), std::back_inserter(made.replay.corrections));
  made.rig.specimen = made.replay.bushing = bushing.name;
  made.replay.specimen = rig.specimen;
  made.rig.synthetic = true;
  made.rig.synthetic_note =
      fmt::format("{}: the simulator's bushing element with the law \"{}\"{}, driven through the tests of \"{}\"",
                  k_computed, bushing.name, bushing.synthetic ? " (from synthetic data)" : "", rig.specimen);
  return made;
}

Provenance provenance_of(const RigRecord& rig, const Bushing& bushing, const std::string& bushing_file) {
  Provenance provenance = rig.provenance;
  provenance.inputs.push_back({"bushing", bushing_file, sha256_of_file(bushing_file)});
  for (const std::string& note : bushing.provenance.synthetic) {
    if (std::ranges::find(provenance.synthetic, note) == provenance.synthetic.end())
      provenance.synthetic.push_back(note);
  }
  if (bushing.synthetic && provenance.synthetic.empty()) provenance.synthetic.emplace_back("the bushing is synthetic");
  return provenance;
}

std::string test_line(const TestFit& test) {
  if (test.prediction) {
    return fmt::format("{:<3} {:<28} {:>2} of {:>2} cycles  prediction      energy {:.6g} J", name_of(test.axis),
                       test.name, test.cycles_used, test.cycles, test.fitted.dissipated_energy);
  }
  const double measured = test.measured.dissipated_energy;
  const std::string energy =
      measured > 0.0 ? fmt::format("{:+7.2f} %", 100.0 * (test.fitted.dissipated_energy / measured - 1.0)) : "      -";
  return fmt::format("{:<3} {:<28} {:>2} of {:>2} cycles  nrmse {:6.3f} %  energy {}", name_of(test.axis), test.name,
                     test.cycles_used, test.cycles, 100.0 * test.nrmse, energy);
}

nlohmann::ordered_json test_json(const TestFit& test) {
  nlohmann::ordered_json json{{"name", test.name}, {"axis", name_of(test.axis)}, {"cycles_used", test.cycles_used}};
  if (test.prediction) {
    json["prediction"] = true;
  } else {
    json["nrmse"] = test.nrmse;
    json["measured_energy_J"] = test.measured.dissipated_energy;
  }
  json["energy_J"] = test.fitted.dissipated_energy;
  return json;
}

Result run(const Options& options, Console& console) {
  const ReplayRecord replay =
      rig_into(options.rig_file, options.bushing_file, options.folder, console.progress("virtual rig"));
  Result result;
  for (const TestFit& test : replay.tests) {
    result.lines.push_back(test_line(test));
    result.json["tests"].push_back(test_json(test));
  }
  result.json["warnings"] = nlohmann::ordered_json::array();
  for (const FitWarning& warning : replay.warnings) {
    console.note("warning: " + warning.test + ": " + warning.text);
    result.json["warnings"].push_back({{"code", warning.code}, {"test", warning.test}, {"text", warning.text}});
  }
  for (const char* name : {"rig.json", "replay.json", "report.html"}) {
    const std::string file = (fs::path(options.folder) / name).string();
    result.lines.push_back(file);
    result.json["outputs"].push_back(file);
  }
  return result;
}

}  // namespace

ReplayRecord rig_into(const fs::path& rig_file, const fs::path& bushing_file, const fs::path& folder,
                      const Progress& progress) {
  const RigRecord rig = read_rig(rig_file);
  const Bushing bushing = read_bushing(bushing_file);
  require_laws(rig, bushing, bushing_file.string());
  require_own_folder(rig, folder);
  require_apart({folder / "rig.json", folder / "replay.json", folder / "report.html", folder / "report.json"},
                {bushing_file});
  require_place_of_report(folder / "report.html");
  VirtualCampaign made = drive_campaign(rig, bushing, progress);
  made.replay.provenance = provenance_of(rig, bushing, bushing_file.string());
  made.replay.provenance.command =
      fmt::format("grouser rig {} --bushing {} -o {}", rig_file.string(), bushing_file.string(), folder.string());
  fs::create_directories(folder);
  write_rig(made.rig, folder);
  write_replay(made.replay, folder / "replay.json");
  write_report({folder}, folder / "report.html");
  return made.replay;
}

Command add_rig(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "rig", "The virtual rig: every test of RIG.json driven on the simulator's bushing element, over the measurement");
  const auto options = std::make_shared<Options>();
  app->add_option("RIG.json", options->rig_file, "The campaign: grouser.rig/1 and the CSV files that it names")
      ->required();
  app->add_option("--bushing", options->bushing_file, "The bushing on the rig: grouser.bushing/1")
      ->type_name("FILE")
      ->required();
  app->add_option("-o,--output", options->folder,
                  "Folder of replay.json, report.html and of rig.json with its CSV files, which identify reads again")
      ->type_name("DIR")
      ->capture_default_str();
  return {app, [options](Console& console) { return run(*options, console); }};
}

}  // namespace grouser::cli
