#pragma once
#include <filesystem>

#include "model/bushing.h"
#include "model/fit.h"
#include "model/json_reader.h"
#include "model/provenance.h"
#include "model/scenario.h"
#include "model/vehicle.h"

/// Parts of files that several formats share, and readers of documents already in memory.
namespace grouser {

inline constexpr const char* k_bushing_format = "grouser.bushing/1";
inline constexpr const char* k_camera_format = "grouser.camera/1";
inline constexpr const char* k_fit_format = "grouser.fit/1";
inline constexpr const char* k_replay_format = "grouser.replay/1";
inline constexpr const char* k_rig_format = "grouser.rig/1";
inline constexpr const char* k_run_format = "grouser.run/1";
inline constexpr const char* k_scenario_format = "grouser.scenario/1";
inline constexpr const char* k_vehicle_format = "grouser.vehicle/1";

[[nodiscard]] Json provenance_json(const Provenance& provenance);
/// The optional member `provenance`.
[[nodiscard]] Provenance read_provenance(ObjectReader& reader);

/// Input entry of a file that was read: role, name as referred to, digest of its bytes.
[[nodiscard]] Provenance::Input provenance_input(const std::string& role, const std::string& path,
                                                 const std::string& bytes);

[[nodiscard]] Bushing read_bushing(ObjectReader& reader);

/// One entry of `tests[]` in fit.json and in replay.json.
[[nodiscard]] Json test_fit_json(const TestFit& test);
[[nodiscard]] TestFit read_test_fit(ObjectReader& reader);

/// Puts in place of `"mirror": "left"` what it stands for: the other side with y reversed, and the given keys on top.
/// Returns the side that was filled in ("right"), empty when there is none; what is wrong is left for the reader to
/// find.
std::string expand_mirrored_side(Json& vehicle);
/// A fault of the side that was mirrored stands once in the file, so it is reported once.
void forget_mirrored_findings(const std::string& mirrored_side, Findings& findings);
[[nodiscard]] Vehicle read_vehicle(ObjectReader& reader);

}  // namespace grouser
