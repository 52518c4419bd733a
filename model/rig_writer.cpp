#include "model/rig_writer.h"

#include <array>
#include <charconv>

#include "model/file_json.h"

namespace grouser {
namespace {

struct SiNames {
  const char *displacement, *force, *preset;
};

const SiNames& names_of(Axis axis) {
  static constexpr SiNames k_straight{"displacement_m", "force_N", "preset_m"};
  static constexpr SiNames k_turning{"angle_rad", "torque_N_m", "preset_rad"};
  return is_rotation(axis) ? k_turning : k_straight;
}

void append(std::string& text, double value, char end) {
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr);
  text += end;
}

std::string csv_of(const RigTest& test) {
  const SiNames& names = names_of(test.axis);
  std::string text = test.time_measured ? "time_s," : "";
  text.append(names.displacement).append(",").append(names.force).append("\n");
  for (std::size_t i = 0; i < test.force.size(); ++i) {
    if (test.time_measured) append(text, test.time[i], ',');
    append(text, test.displacement[i], ',');
    append(text, test.force[i], '\n');
  }
  return text;
}

Json entry_of(const RigTest& test) {
  const SiNames& names = names_of(test.axis);
  Json entry{{"name", test.name},
             {"axis", name_of(test.axis)},
             {"kind", test.kind == TestKind::cyclic ? "cyclic" : "static"},
             {"file", test.file}};
  if (test.preset) entry[names.preset] = *test.preset;
  if (test.discard_cycles) entry["discard_cycles"] = *test.discard_cycles;
  return entry;
}

}  // namespace

void write_rig(const RigRecord& rig, const std::filesystem::path& folder) {
  Json document{{"format", k_rig_format}, {"specimen", Json{{"name", rig.specimen}, {"bushings_in_series", 1}}}};
  if (rig.synthetic) document["synthetic"] = Json{{"note", rig.synthetic_note}};
  document["tests"] = Json::array();
  for (const RigTest& test : rig.tests) {
    document["tests"].push_back(entry_of(test));
    write_whole(folder / test.file, csv_of(test));
  }
  write_whole(folder / "rig.json", json_text(document));
}

}  // namespace grouser
