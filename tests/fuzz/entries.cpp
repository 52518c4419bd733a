#include "tests/fuzz/entries.h"

#include <sstream>

#include "model/check.h"
#include "model/csv.h"
#include "model/errors.h"
#include "model/hdf5_fault.h"
#include "model/rig.h"
#include "model/run_columns.h"
#include "model/scenario.h"
#include "model/terrain_reader.h"
#include "tests/support/temporary_folder.h"

namespace grouser::fuzz {
namespace {

using test::TemporaryFolder;

/// A refusal is what hostile bytes deserve.
template <typename Reading>
void allow_refusal(Reading&& reading) {
  try {
    reading();
  } catch (const InputError&) {
  } catch (const FileError&) {
  }
}

/// Takes `#set path=value` lines off the front.
ScenarioOverrides take_overrides(std::string_view& input) {
  constexpr std::string_view k_mark = "#set ";
  ScenarioOverrides overrides;
  while (input.starts_with(k_mark)) {
    const std::string_view line = input.substr(k_mark.size(), input.find('\n') - k_mark.size());
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos) {
      overrides.set[std::string(line.substr(0, equals))] = std::string(line.substr(equals + 1));
    }
    input.remove_prefix(std::min(input.size(), k_mark.size() + line.size() + 1));
  }
  return overrides;
}

void copy_data(const TemporaryFolder& folder, const char* from, const char* to) {
  std::filesystem::copy_file(std::filesystem::path(GROUSER_SOURCE_DIR) / "test_data" / from, folder / to);
}

/// Good files for documents to refer to.
const TemporaryFolder& folder_of_references() {
  static const TemporaryFolder folder;
  static const bool filled = [] {
    copy_data(folder, "vehicles/reference.json", "vehicle.json");
    copy_data(folder, "bushings/reference.json", "bushing.json");
    copy_data(folder, "broken/loop.csv", "loop.csv");
    folder.write("profile.csv", "distance_m,height_m\n0,0\n1,0.1\n2,0\n");
    return true;
  }();
  static_cast<void>(filled);
  return folder;
}

constexpr const char* k_rig = R"({"format": "grouser.rig/1", "specimen": {"name": "s"},
  "tests": [{"name": "t", "axis": "x", "kind": "cyclic", "frequency_Hz": 1, "file": "table.csv"}]})";

}  // namespace

void json_entry(std::string_view input) {
  const TemporaryFolder& folder = folder_of_references();
  const ScenarioOverrides overrides = take_overrides(input);
  const std::filesystem::path file = folder.write("input.json", std::string(input));
  if (!overrides.set.empty()) return allow_refusal([&] { static_cast<void>(read_scenario(file, overrides)); });
  allow_refusal([&] { static_cast<void>(check_file(file)); });
}

void csv_entry(std::string_view input) {
  static const TemporaryFolder folder;
  static const std::filesystem::path rig = folder.write("rig.json", k_rig);
  const std::string bytes(input);
  folder.write("table.csv", bytes);
  allow_refusal([&] { static_cast<void>(read_rig(rig)); });
  Findings findings("table.csv");
  static_cast<void>(read_ground_profile(bytes, 0.0, findings));
  std::istringstream in(bytes);
  CsvReader table(in, findings);
  static_cast<void>(table.read(table.names(), CsvReader::Missing::as_nan));
}

void hdf5_entry(std::string_view input) {
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("run.h5", std::string(input));
  if (!fault_of_hdf5(file).empty()) return;
  allow_refusal([&] {
    const RunReader run(file);
    for (const std::string& dataset : run.datasets()) {
      if (holds_names(dataset)) {
        static_cast<void>(run.read_names(dataset));
      } else {
        const Array all = run.read(dataset);
        for (const RunColumn& column : columns_of(run, dataset)) {
          if (all.rows() > 0) static_cast<void>(run.read_column(dataset, column.index));
        }
      }
    }
  });
}

}  // namespace grouser::fuzz
