#include "model/json_document.h"

#include <algorithm>
#include <array>
#include <memory>
#include <unordered_set>
#include <utility>

namespace grouser {
namespace {

// Far above any file of ours; below them no text, however made, costs more than some seconds and 2 GB.
constexpr std::size_t k_most_bytes = 32u << 20, k_most_levels = 64, k_most_keys = 10'000;

/// Other things than JSON, by their first bytes.
const char* other_content(std::string_view text) {
  using namespace std::string_view_literals;
  constexpr std::array<std::pair<std::string_view, const char*>, 8> k_marks{{{"\xFF\xFE\0\0"sv, "text in UTF-32"},
                                                                             {"\0\0\xFE\xFF"sv, "text in UTF-32"},
                                                                             {"\xFF\xFE"sv, "text in UTF-16"},
                                                                             {"\xFE\xFF"sv, "text in UTF-16"},
                                                                             {"\x89HDF\r\n"sv, "an HDF5 file"},
                                                                             {"\x1F\x8B"sv, "a gzip archive"},
                                                                             {"PK\x03\x04"sv, "a zip archive"},
                                                                             {"\x89PNG"sv, "a picture"}}};
  for (const auto& [mark, name] : k_marks)
    if (text.starts_with(mark)) return name;
  const std::size_t zero = text.find('\0');
  if (zero == std::string_view::npos) return nullptr;
  return zero < 2 ? "text in UTF-16" : "bytes that are no text";
}

/// Builds the document and knows where it is.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const std::string& text, Findings& findings) : text_(text), findings_(findings) {}
  [[nodiscard]] Json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& value) override { return put(std::move(value)); }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& value) override {
    Level& level = levels_.back();
    level.key = value;
    if (!level.keys.insert(value).second) findings_.add(pointer_to(level.pointer, value), "each key once", "it twice");
    if (level.keys.size() <= k_most_keys) return true;
    return refuse(level.pointer, "at most " + std::to_string(k_most_keys) + " keys in an object", "more");
  }

  bool parse_error(std::size_t position, const std::string& last_token, const Json::exception& error) override {
    const std::size_t at = std::min(position > 0 ? position - 1 : 0, text_.size());
    const auto begin = text_.begin(), here = begin + static_cast<std::ptrdiff_t>(at);
    const auto line = std::count(begin, here, '\n') + 1;
    const std::size_t newline = at > 0 ? text_.rfind('\n', at - 1) : std::string::npos;
    const std::size_t column = newline == std::string::npos ? at + 1 : at - newline;
    const bool overflow = dynamic_cast<const Json::out_of_range*>(&error) != nullptr;
    const bool ended = at >= text_.size();
    const std::string place = "line " + std::to_string(line) + ", column " + std::to_string(column);
    if (std::string_view(error.what()).find("ill-formed UTF-8") != std::string_view::npos) {
      findings_.add(place, "text in UTF-8", end_of(last_token), "save the file in that encoding");
      return false;
    }
    findings_.add(place, overflow ? "a number that a double can hold" : "valid JSON",
                  ended ? "the end of the file" : end_of(last_token), overflow ? "" : reason(error.what()));
    return false;
  }

 private:
  struct Level {
    Json* container;
    std::string pointer;
    std::string key;
    std::unordered_set<std::string> keys;  ///< so far: of an object
  };

  /// A finding that ends the reading.
  bool refuse(const std::string& pointer, std::string expected, std::string found) {
    findings_.add(pointer, std::move(expected), std::move(found));
    return false;
  }

  /// The lexer hands over what it read since the last token, of any length; what is wrong stands at its end.
  static std::string end_of(std::string token) {
    constexpr std::string_view k_newline = "<U+000A>";
    constexpr std::size_t k_most = 60;
    const std::size_t line = token.rfind(k_newline);
    if (line != std::string::npos && line + k_newline.size() < token.size()) token.erase(0, line + k_newline.size());
    token.erase(0, std::min(token.find_first_not_of(' '), token.size()));
    return token.size() <= k_most ? token : "..." + token.substr(token.size() - k_most);
  }

  /// nlohmann's own sentence without its error number and position.
  static std::string reason(const std::string& what) {
    const std::size_t dash = what.find(" - "), tail = what.find("; last read"), expected = what.rfind("; expected");
    const std::size_t begin = dash == std::string::npos ? 0 : dash + 3;
    const std::string after = expected == std::string::npos ? "" : what.substr(expected);
    return what.substr(begin, std::min(tail, expected) - begin) + after;
  }

  Json* place(Json value) {
    if (levels_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    Level& level = levels_.back();
    if (level.container->is_array()) {
      level.container->push_back(std::move(value));
      return &level.container->back();
    }
    // Appended without a search: it would cost the square of the number of keys.
    auto& members = level.container->get_ref<Json::object_t&>();
    return &members.emplace_back(level.key, std::move(value)).second;
  }
  bool put(Json value) {
    place(std::move(value));
    return true;
  }
  bool open(Json container) {
    std::string pointer;
    if (!levels_.empty()) {
      const Level& level = levels_.back();
      pointer =
          pointer_to(level.pointer, level.container->is_array() ? std::to_string(level.container->size()) : level.key);
    }
    if (levels_.size() == k_most_levels) {
      return refuse(levels_.front().pointer,
                    "at most " + std::to_string(k_most_levels) + " levels of arrays and objects", "more");
    }
    Json* placed = place(std::move(container));
    levels_.push_back({placed, std::move(pointer), {}, {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  const std::string& text_;
  Findings& findings_;
  Json root_;
  std::vector<Level> levels_;
};

bool is_plain(const Json& value) { return !value.is_structured(); }

void print(const Json& value, std::size_t indent, std::string& out) {
  const bool on_one_line = value.is_array() && std::all_of(value.begin(), value.end(), is_plain);
  if (is_plain(value) || value.empty()) {
    // Names of files may hold any bytes.
    out += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const std::string margin = on_one_line ? "" : "\n" + std::string(indent + 2, ' ');
  out += value.is_array() ? '[' : '{';
  bool first = true;
  for (const auto& item : value.items()) {
    if (!first) out += on_one_line ? ", " : ",";
    first = false;
    out += margin;
    if (value.is_object()) out += Json(item.key()).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    print(item.value(), indent + 2, out);
  }
  if (!on_one_line) out += "\n" + std::string(indent, ' ');
  out += value.is_array() ? ']' : '}';
}

}  // namespace

Json parse_json(const std::string& text, Findings& findings) {
  if (const char* other = other_content(text)) {
    findings.add("", "JSON text in UTF-8", other);
    return nullptr;
  }
  if (text.size() > k_most_bytes) {
    findings.add("", "a JSON file of at most " + std::to_string(k_most_bytes >> 20) + " MB",
                 std::to_string(text.size() >> 20) + " MB");
    return nullptr;
  }
  Builder builder(text, findings);
  if (!Json::sax_parse(text, &builder)) return nullptr;
  return builder.take();
}

std::string pointer_to(const std::string& pointer, const std::string& key) {
  std::string text = pointer + "/";
  for (const char c : key) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += c;
    }
  }
  return text;
}

std::string shown(const Json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string json_text(const Json& value) {
  std::string text;
  print(value, 0, text);
  return text + "\n";
}

}  // namespace grouser
