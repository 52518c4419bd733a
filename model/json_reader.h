#pragma once
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/geometry.h"
#include "model/json_document.h"
#include "model/units.h"

namespace grouser {

/// What a number must satisfy.
enum class Range { any, non_negative, positive };

/// Reads one JSON object key by key. A quantity is asked for by its name; the unit is found in the key. What is wrong
/// is noted and a harmless value returned, so that reading goes on; when the reader is destroyed, keys that nobody
/// asked for are noted too. `note` (a string for people) is allowed in every object.
class ObjectReader {
 public:
  ObjectReader(const Json& value, std::string pointer, Findings& findings);
  ~ObjectReader();
  ObjectReader(const ObjectReader&) = delete;
  ObjectReader& operator=(const ObjectReader&) = delete;

  [[nodiscard]] const std::string& pointer() const { return pointer_; }
  [[nodiscard]] Findings& findings() { return findings_; }
  /// A finding about `key`, or about this object when the key is empty.
  void report(const std::string& key, std::string expected, std::string found, std::string hint = {});
  [[nodiscard]] bool has(const std::string& key) const { return object_->contains(key); }
  [[nodiscard]] bool has_quantity(const std::string& name) const { return !keys_of_quantity(name).empty(); }
  /// The key that gave a quantity ("pitch_mm"), for findings of the caller; the bare name when there is none.
  [[nodiscard]] std::string key_of(const std::string& name) const;

  double quantity(const std::string& name, const Dimension& dimension, Range range = Range::any);
  double quantity_or(const std::string& name, const Dimension& dimension, double fallback, Range range = Range::any);
  std::optional<double> optional_quantity(const std::string& name, const Dimension& dimension,
                                          Range range = Range::any);
  /// At least one value; empty only after a finding.
  std::vector<double> quantities(const std::string& name, const Dimension& dimension);
  std::optional<std::vector<double>> optional_quantities(const std::string& name, const Dimension& dimension);
  Vector3d vector(const std::string& name, const Dimension& dimension, Range range = Range::any);
  std::vector<Vector3d> vectors(const std::string& name, const Dimension& dimension, std::size_t components = 3);

  double number(const std::string& key, Range range = Range::any);
  double number_or(const std::string& key, double fallback, Range range = Range::any);
  std::vector<double> numbers_or_none(const std::string& key);
  /// Whole numbers that a double holds; a count that memory or time pays for says how many are sane.
  static constexpr long k_most_integer = 1'000'000'000'000'000, k_most_count = 1'000'000'000;
  long integer(const std::string& key, long least, long most = k_most_integer);
  long integer_or(const std::string& key, long fallback, long least, long most = k_most_integer);
  /// The same for what is kept as an int.
  int count(const std::string& key, long least, long most = k_most_count) {
    return static_cast<int>(integer(key, least, most));
  }
  int count_or(const std::string& key, long fallback, long least, long most = k_most_count) {
    return static_cast<int>(integer_or(key, fallback, least, most));
  }
  bool boolean_or(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string text_or(const std::string& key, const std::string& fallback);
  /// Of another file: a text that is not empty and that the system takes as a whole.
  std::string file_name(const std::string& key) { return file_name_at(find(key, true), key); }
  std::string file_name_or_none(const std::string& key) { return file_name_at(find(key, false), key); }
  std::vector<std::string> texts_or_none(const std::string& key);

  /// One of the listed words.
  template <typename E>
  E choice(const std::string& key, std::initializer_list<std::pair<const char*, E>> choices) {
    std::vector<std::string> words;
    for (const auto& c : choices) words.emplace_back(c.first);
    const std::size_t i = choice_index(key, words);
    return (choices.begin() + static_cast<std::ptrdiff_t>(i))->second;
  }

  /// Indices of the listed words in an optional array of words, each once, in the order of `words`.
  std::vector<std::size_t> choices_or_none(const std::string& key, const std::vector<std::string>& words);

  using Visit = std::function<void(ObjectReader&)>;
  void object(const std::string& key, const Visit& visit);
  /// Returns whether the key is there.
  bool optional_object(const std::string& key, const Visit& visit);
  void each(const std::string& key, std::size_t least, const Visit& visit);
  void each_optional(const std::string& key, const Visit& visit);
  /// Every member, whatever its name, with its key.
  void each_member(const std::function<void(const std::string&, const Json&)>& visit);
  /// Marks a key as known without reading it, and returns it (null when absent).
  const Json* raw(const std::string& key);

 private:
  struct Found {
    std::string key;
    Unit unit;
  };
  struct Missing {
    std::string name;
    std::optional<Dimension> dimension;  ///< of a quantity; empty for a plain key
  };

  [[nodiscard]] std::vector<std::string> keys_of_quantity(const std::string& name) const;
  std::optional<Found> find_quantity(const std::string& name, const Dimension& dimension, bool required);
  const Json* find(const std::string& key, bool required);
  std::string file_name_at(const Json* value, const std::string& key);
  double number_at(const Json& value, const std::string& pointer, const std::string& what, Range range);
  std::vector<double> numbers_at(const Json& value, const std::string& pointer, const std::string& what,
                                 const Unit& unit, Range range = Range::any);
  std::size_t choice_index(const std::string& key, const std::vector<std::string>& words);
  std::optional<std::size_t> index_of_word(const Json& value, const std::string& pointer,
                                           const std::vector<std::string>& words);
  void report_unasked();
  bool explain_missing(const Missing& missing);
  [[nodiscard]] std::string suggestion(const std::string& key) const;

  const Json* object_;
  std::string pointer_;
  Findings& findings_;
  bool usable_ = true;  ///< false: not an object at all; said once
  std::vector<std::string> used_;
  std::vector<Missing> known_;  ///< everything asked for
  std::vector<Missing> missing_;
};

/// Reads and parses a file, checks its `format`, and hands its top object to `visit`; throws InputError with all
/// findings.
void read_document(const std::filesystem::path& file, const std::string& format, const ObjectReader::Visit& visit);
/// The same for a document in memory (with overrides applied).
void read_document(const Json& document, const std::string& format, Findings& findings,
                   const ObjectReader::Visit& visit);

}  // namespace grouser
