#include "model/scenario.h"

#include <algorithm>
#include <cmath>

#include "model/file_json.h"
#include "model/overrides.h"
#include "model/replace_file.h"
#include "model/terrain_reader.h"

namespace grouser {
namespace {

namespace d = dimension;
namespace fs = std::filesystem;

/// The values of a table, one for each time.
std::vector<double> read_values(ObjectReader& r, const std::vector<double>& time, const std::string& name,
                                const Dimension& dimension) {
  std::vector<double> values = r.quantities(name, dimension);
  if (!time.empty() && !values.empty() && time.size() != values.size()) {
    r.report(r.key_of(name), std::to_string(time.size()) + " values, one for each time", std::to_string(values.size()));
    values.resize(time.size());
  }
  return values;
}

DriveKind drive_kind(const ObjectReader& r) {
  if (r.has_quantity("torque")) return DriveKind::torque;
  return r.has_quantity("target_speed") ? DriveKind::cruise : DriveKind::speed;
}

/// A prescribed speed cannot jump away from rest; a driver's wish can.
void check_start(ObjectReader& r, const DriveTable& drive) {
  if (drive.kind != DriveKind::speed || drive.speed.empty()) return;
  const double speed = table_value(drive.time, drive.speed, 0.0);
  if (speed == 0.0) return;
  r.report(r.key_of("speed"), "a speed of 0 at time 0: a run starts from rest", shown(Json(speed)) + " rad/s");
}

DriveTable read_drive(ObjectReader& r) {
  DriveTable drive;
  drive.kind = drive_kind(r);
  drive.time = r.quantities("time", d::time);
  switch (drive.kind) {
    case DriveKind::speed:
      drive.speed = read_values(r, drive.time, "speed", d::angular_speed);
      break;
    case DriveKind::torque:
      drive.torque = read_values(r, drive.time, "torque", d::torque);
      drive.drag = r.quantity_or("drag", d::angular_damping, drive.drag, Range::non_negative);
      break;
    case DriveKind::cruise:
      drive.target_speed = read_values(r, drive.time, "target_speed", d::speed);
      drive.power = r.quantity("power", d::power, Range::positive);
      drive.largest_torque = r.quantity("largest_torque", d::torque, Range::positive);
      drive.brake_torque = r.quantity("brake_torque", d::torque, Range::non_negative);
      drive.response_time = r.quantity_or("response_time", d::time, drive.response_time, Range::positive);
      break;
  }
  if (drive.time.empty()) return drive;
  const bool rises =
      std::adjacent_find(drive.time.begin(), drive.time.end(), std::greater_equal<>()) == drive.time.end();
  if (rises) {
    check_start(r, drive);
  } else {
    r.report(r.key_of("time"), "strictly increasing values", "a value not above the one before it");
  }
  return drive;
}

/// No run takes as many steps a second; a chunk of rows must fit into memory.
double read_rate(ObjectReader& r, const std::string& name, double fallback) {
  constexpr double k_most = 1e5;  // Hz
  const double rate = r.quantity_or(name, d::frequency, fallback, Range::positive);
  if (rate <= k_most) return rate;
  r.report(r.key_of(name), "a frequency up to 100 kHz", shown(Json(rate)) + " Hz");
  return fallback;
}

OutputOptions read_output(ObjectReader& r) {
  OutputOptions output;
  output.rate = read_rate(r, "rate", output.rate);
  output.probe_rate = read_rate(r, "probe_rate", output.probe_rate);
  r.each_optional("probes", [&](ObjectReader& p) {
    const Side side = p.choice<Side>("side", {{"left", Side::left}, {"right", Side::right}});
    output.probes.push_back({side, p.count("link", 0)});
  });
  return output;
}

IntegratorOptions read_integrator(ObjectReader& r) {
  IntegratorOptions o;
  o.beta = r.number_or("beta", o.beta, Range::positive);
  if (o.beta < 1.0 || o.beta > 28.0 / 27.0 + 1e-12) r.report("beta", "a number from 1 to 28/27", Json(o.beta).dump());
  o.velocity_tolerance = r.quantity_or("velocity_tolerance", d::speed, o.velocity_tolerance, Range::positive);
  o.displacement_tolerance =
      r.quantity_or("displacement_tolerance", d::length, o.displacement_tolerance, Range::positive);
  o.max_step = r.quantity_or("max_step", d::time, o.max_step, Range::positive);
  o.min_step = r.quantity_or("min_step", d::time, o.min_step, Range::positive);
  o.stability_fraction = r.number_or("stability_fraction", o.stability_fraction, Range::positive);
  o.growth_limit = r.number_or("growth_limit", o.growth_limit, Range::positive);
  o.fixed_step = r.quantity_or("fixed_step", d::time, o.fixed_step, Range::non_negative);
  // At 1000 s neighbouring doubles are 1e-13 s apart: a shorter step would not move the time.
  constexpr double k_least_step = 1e-12;
  const auto require_time_to_move = [&r](const char* name, double step) {
    if (step >= k_least_step) return;
    r.report(r.key_of(name), "a step of at least 1e-12 s", Json(step).dump() + " s");
  };
  require_time_to_move("min_step", o.min_step);
  if (o.fixed_step > 0.0) require_time_to_move("fixed_step", o.fixed_step);
  if (o.growth_limit <= 1.0) r.report("growth_limit", "a number > 1", Json(o.growth_limit).dump());
  if (o.min_step > o.max_step) {
    r.report(r.key_of("min_step"), "a step not above max_step", Json(o.min_step).dump() + " s");
  }
  return o;
}

/// `bushing_scale`: one factor for all axes, or an object with some of them by name.
AxisScale read_bushing_scale(ObjectReader& r) {
  AxisScale scale;
  scale.fill(1.0);
  const Json* given = r.raw("bushing_scale");
  if (given == nullptr) return scale;
  if (!given->is_object()) {
    scale.fill(r.number("bushing_scale", Range::positive));
    return scale;
  }
  r.optional_object("bushing_scale", [&](ObjectReader& axes) {
    for (std::size_t a = 0; a < scale.size(); ++a) scale[a] = axes.number_or(k_axis_names[a], 1.0, Range::positive);
  });
  return scale;
}

/// s. A step adds to the time: where that is long, neighbouring doubles are further apart than steps.
constexpr double k_longest_run = 1e6, k_longest_assembly = 1e3;

void require_at_most(ObjectReader& r, const char* name, double time, double most) {
  if (time > most) r.report(r.key_of(name), "at most " + Json(most).dump() + " s", Json(time).dump() + " s");
}

/// The scenario's own document; the files that it names come later.
void read_own(ObjectReader& r, Scenario& scenario, TerrainEntry& terrain) {
  scenario.name = r.text("name");
  scenario.vehicle_file = r.file_name("vehicle");
  scenario.bushing_file = r.file_name("bushing");
  r.optional_object("terrain", [&](ObjectReader& t) { terrain = read_terrain(t); });
  r.object("drive", [&](ObjectReader& drive) {
    for (const Side side : {Side::left, Side::right}) {
      drive.object(name_of(side),
                   [&](ObjectReader& t) { scenario.drive[static_cast<std::size_t>(index_of(side))] = read_drive(t); });
    }
  });
  scenario.duration = r.quantity("duration", d::time, Range::positive);
  require_at_most(r, "duration", scenario.duration, k_longest_run);
  scenario.gravity = r.quantity_or("gravity", d::acceleration, scenario.gravity, Range::positive);
  scenario.bushing_scale = read_bushing_scale(r);
  r.optional_object("output", [&](ObjectReader& o) { scenario.output = read_output(o); });
  r.optional_object("integrator", [&](ObjectReader& o) { scenario.integrator = read_integrator(o); });
  r.optional_object("assembly", [&](ObjectReader& a) {
    scenario.assembly.settle_time =
        a.quantity_or("settle_time", d::time, scenario.assembly.settle_time, Range::positive);
    require_at_most(a, "settle_time", scenario.assembly.settle_time, k_longest_assembly);
    scenario.assembly.step = a.quantity_or("step", d::time, scenario.assembly.step, Range::positive);
  });
}

/// Reads the scenario and what it names; collects the findings of all files.
class ScenarioReader {
 public:
  ScenarioReader(const fs::path& file, const ScenarioOverrides& overrides)
      : file_(file), overrides_(overrides), findings_(file.string()) {}

  Scenario read() {
    read_scenario_document();
    read_vehicle_document();
    scenario_.bushing = read_bushing_document("bushing", "bushing.", overrides_.bushing_file, scenario_.bushing_file,
                                              file_, scenario_.documents.bushing);
    read_side_bushings();
    read_profile();
    check_probes();
    findings_.throw_if_any();
    scale_bushings();
    if (scenario_.bushing.synthetic) scenario_.provenance.synthetic = scenario_.bushing.provenance.synthetic;
    scenario_.provenance.version = program_version();
    scenario_.provenance.options = overrides_.set;
    return std::move(scenario_);
  }

 private:
  /// Those overrides whose path starts with `prefix`, without it; for the scenario itself those with no prefix at all.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> overrides_for(const std::string& prefix) const {
    std::vector<std::pair<std::string, std::string>> chosen;
    for (const auto& [path, value] : overrides_.set) {
      const bool others = path.rfind("vehicle.", 0) == 0 || path.rfind("bushing.", 0) == 0;
      if (prefix.empty() ? !others : path.rfind(prefix, 0) == 0) chosen.emplace_back(path.substr(prefix.size()), value);
    }
    return chosen;
  }

  /// Parses bytes, applies overrides and reads; returns the document's text as it was understood.
  std::string read_text(const std::string& bytes, const char* format, const std::string& prefix, Findings& findings,
                        const ObjectReader::Visit& visit) {
    Json document = parse_json(bytes, findings);
    if (document.is_null() && !findings.empty()) return {};
    // A mirrored side follows what is set on the other; what is set on itself stands on top.
    Json trial = document;
    const std::string mirrored = expand_mirrored_side(trial);
    const auto is_on_top = [&](const std::string& path) {
      return !mirrored.empty() && path.substr(path.front() == '/' ? 1 : 0).rfind(mirrored, 0) == 0;
    };
    for (const bool on_top : {false, true}) {
      for (const auto& [path, value] : overrides_for(prefix)) {
        if (is_on_top(path) == on_top) apply_override(document, path, value, findings);
      }
      if (!on_top) expand_mirrored_side(document);
    }
    read_document(document, format, findings, visit);
    forget_mirrored_findings(mirrored, findings);
    return json_text(document);
  }

  void read_scenario_document() {
    const std::string bytes = read_whole(file_);
    scenario_.path = file_;
    scenario_.files.push_back(file_);
    scenario_.provenance.inputs.push_back(provenance_input("scenario", file_.string(), bytes));
    scenario_.documents.scenario = read_text(bytes, k_scenario_format, "", findings_,
                                             [this](ObjectReader& r) { read_own(r, scenario_, terrain_); });
  }

  /// Bytes of a file that `owner` names under /role, or that the user named in its place.
  std::optional<std::string> referred(const std::string& role, const std::string& by_user, std::string& name,
                                      const fs::path& owner, fs::path& path) {
    if (!by_user.empty()) name = by_user;
    if (name.empty()) return std::nullopt;  // a finding already
    path = by_user.empty() ? (owner.parent_path() / name).lexically_normal() : fs::path(by_user);
    scenario_.files.push_back(path);
    if (!by_user.empty()) return read_whole(path);
    try {
      return read_whole(path);
    } catch (const FileError& error) {
      findings_.add(InputFinding{owner.string(), "/" + role, "a file that can be read", name, error.what()});
      return std::nullopt;
    }
  }

  void read_vehicle_document() {
    const auto bytes = referred("vehicle", overrides_.vehicle_file, scenario_.vehicle_file, file_, vehicle_path_);
    if (!bytes) return;
    const auto input = provenance_input("vehicle", scenario_.vehicle_file, *bytes);
    Findings findings(vehicle_path_.string());
    scenario_.documents.vehicle = read_text(*bytes, k_vehicle_format, "vehicle.", findings,
                                            [this](ObjectReader& r) { scenario_.vehicle = read_vehicle(r); });
    vehicle_read_ = findings.empty();
    findings_.add(findings);
    scenario_.vehicle.provenance.inputs.push_back(input);
    scenario_.provenance.inputs.push_back(input);
  }

  Bushing read_bushing_document(const std::string& role, const std::string& prefix, const std::string& by_user,
                                std::string& name, const fs::path& owner, std::string& document) {
    Bushing bushing;
    fs::path path;
    const auto bytes = referred(role, by_user, name, owner, path);
    if (!bytes) return bushing;
    scenario_.provenance.inputs.push_back(provenance_input(role, name, *bytes));
    Findings findings(path.string());
    document = read_text(*bytes, k_bushing_format, prefix, findings,
                         [&](ObjectReader& r) { bushing = grouser::read_bushing(r); });
    for (int i = 0; findings.empty() && i < k_num_axes; ++i) {
      const Axis axis = static_cast<Axis>(i);
      if (!bushing.axis(axis).spring.displacement.empty()) continue;
      findings.add("/axes", std::string("a law for axis ") + name_of(axis), "no such key",
                   "a link joint needs all six axes");
      break;
    }
    findings_.add(findings);
    return bushing;
  }

  void read_profile() {
    scenario_.terrain = terrain_.terrain;
    scenario_.profile_file = terrain_.profile_file;
    fs::path path;
    const auto bytes = referred("terrain/profile/file", "", scenario_.profile_file, file_, path);
    if (!bytes) return;
    scenario_.provenance.inputs.push_back(provenance_input("terrain profile", scenario_.profile_file, *bytes));
    scenario_.documents.profile = *bytes;
    Findings findings(path.string());
    scenario_.terrain.profile = read_ground_profile(*bytes, terrain_.profile_start, findings);
    findings_.add(findings);
  }

  void read_side_bushings() {
    for (const Side side : {Side::left, Side::right}) {
      const auto i = static_cast<std::size_t>(index_of(side));
      std::string& name = scenario_.vehicle.sides[i].track.bushing;
      if (name.empty()) continue;
      const std::string role = std::string(name_of(side)) + "/track/bushing";
      scenario_.side_bushing[i] =
          read_bushing_document(role, "no override", "", name, vehicle_path_, scenario_.documents.side_bushing[i]);
    }
  }

  void scale_bushings() {
    scenario_.bushing = scaled(scenario_.bushing, scenario_.bushing_scale);
    for (std::optional<Bushing>& own : scenario_.side_bushing)
      if (own) own = scaled(*own, scenario_.bushing_scale);
  }

  void check_probes() {
    constexpr std::size_t k_most = 1000;  // every link of both tracks
    if (scenario_.output.probes.size() > k_most) {
      findings_.add("/output/probes", "at most " + std::to_string(k_most) + " probe links",
                    std::to_string(scenario_.output.probes.size()));
      return;
    }
    for (std::size_t i = 0; i < scenario_.output.probes.size(); ++i) {
      const ProbeLink& probe = scenario_.output.probes[i];
      const std::string place = "/output/probes/" + std::to_string(i);
      const bool twice =
          std::any_of(scenario_.output.probes.begin(), scenario_.output.probes.begin() + static_cast<std::ptrdiff_t>(i),
                      [&](const ProbeLink& p) { return p.side == probe.side && p.link == probe.link; });
      if (twice) findings_.add(place, "a link that is not probed already", std::to_string(probe.link));
      const int links = scenario_.vehicle.side(probe.side).track.num_links;
      if (!vehicle_read_ || probe.link < links) continue;
      findings_.add(place + "/link", "a link from 0 to " + std::to_string(links - 1), std::to_string(probe.link));
    }
  }

  fs::path file_, vehicle_path_;
  const ScenarioOverrides& overrides_;
  Findings findings_;
  Scenario scenario_;
  TerrainEntry terrain_;
  bool vehicle_read_ = false;  ///< without a finding
};

/// The document with one text member changed; `pointer` leads to it.
std::string with_text(const std::string& document, const std::string& pointer, const std::string& text) {
  Json json = Json::parse(document);
  json[Json::json_pointer(pointer)] = text;
  return json_text(json);
}

}  // namespace

double table_value(const std::vector<double>& time, const std::vector<double>& value, double at) {
  const auto after = std::upper_bound(time.begin(), time.end(), at);
  if (after == time.begin()) return value.front();
  if (after == time.end()) return value.back();
  const auto i = static_cast<std::size_t>(after - time.begin());
  return value[i - 1] + (at - time[i - 1]) / (time[i] - time[i - 1]) * (value[i] - value[i - 1]);
}

Scenario read_scenario(const std::filesystem::path& file, const ScenarioOverrides& overrides) {
  return ScenarioReader(file, overrides).read();
}

std::vector<std::string> input_names() {
  return {"scenario.json", "vehicle.json", "bushing.json", "bushing_left.json", "bushing_right.json", "profile.csv"};
}

void write_inputs(const Scenario& scenario, const std::filesystem::path& run_folder) {
  const fs::path inputs = run_folder / "inputs";
  require_own(inputs);
  std::error_code error;
  fs::create_directories(inputs, error);
  if (error) throw FileError("cannot create " + inputs.string() + ": " + error.message());
  std::string vehicle = scenario.documents.vehicle;
  for (const Side side : {Side::left, Side::right}) {
    const std::string& own = scenario.documents.side_bushing[static_cast<std::size_t>(index_of(side))];
    if (own.empty()) continue;
    const std::string name = std::string("bushing_") + name_of(side) + ".json";
    write_whole(inputs / name, own);
    vehicle = with_text(vehicle, std::string("/") + name_of(side) + "/track/bushing", name);
  }
  write_whole(inputs / "bushing.json", scenario.documents.bushing);
  write_whole(inputs / "vehicle.json", vehicle);
  std::string document =
      with_text(with_text(scenario.documents.scenario, "/vehicle", "vehicle.json"), "/bushing", "bushing.json");
  if (!scenario.documents.profile.empty()) {
    write_whole(inputs / "profile.csv", scenario.documents.profile);
    document = with_text(document, "/terrain/profile/file", "profile.csv");
  }
  write_whole(inputs / "scenario.json", document);
}

}  // namespace grouser
