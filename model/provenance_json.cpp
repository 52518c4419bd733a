#include "model/file_json.h"

namespace grouser {

Json provenance_json(const Provenance& provenance) {
  Json inputs = Json::array();
  for (const Provenance::Input& input : provenance.inputs) {
    inputs.push_back(Json{{"role", input.role}, {"path", input.path}, {"sha256", input.sha256}});
  }
  Json options = Json::object();
  for (const auto& [key, value] : provenance.options) options[key] = value;
  return Json{{"program", provenance.program},
              {"version", provenance.version},
              {"command", provenance.command},
              {"inputs", inputs},
              {"options", options},
              {"synthetic", provenance.synthetic}};
}

Provenance read_provenance(ObjectReader& reader) {
  Provenance provenance;
  reader.optional_object("provenance", [&](ObjectReader& r) {
    provenance.program = r.text("program");
    provenance.version = r.text("version");
    provenance.command = r.text_or("command", "");
    r.each_optional("inputs", [&](ObjectReader& input) {
      provenance.inputs.push_back({input.text("role"), input.text("path"), input.text("sha256")});
    });
    r.optional_object("options", [&](ObjectReader& options) {
      options.each_member([&](const std::string& key, const Json& value) {
        provenance.options[key] = value.is_string() ? value.get<std::string>() : value.dump();
      });
    });
    provenance.synthetic = r.texts_or_none("synthetic");
  });
  return provenance;
}

Provenance::Input provenance_input(const std::string& role, const std::string& path, const std::string& bytes) {
  return {role, path, sha256_of(bytes)};
}

}  // namespace grouser
