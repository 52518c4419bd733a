#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reports/ratings.h"

/// What a channel must reach to count as like its reference.
namespace grouser {

/// One measure of Ratings with how it is judged.
struct RatedMeasure {
  const char* key;                                          ///< for --limit and report.json: "iso"
  const char* label;                                        ///< "ISO rating"
  const char* brief;                                        ///< "M"
  const char* unit;                                         ///< SI, "1" or "%"
  enum class Bound { at_least, at_most, about_one } bound;  ///< about_one: |value - 1| at most the limit
  std::optional<double> limit;                              ///< where the user sets none; empty: only shown
  const char* source;                                       ///< of that limit
  std::optional<double> (*value)(const Ratings&);

  [[nodiscard]] bool meets(double found, double allowed) const;
  /// "≥ 0.8"; empty without a limit.
  [[nodiscard]] std::string text(const std::optional<double>& allowed) const;
};
[[nodiscard]] std::span<const RatedMeasure> rated_measures();

/// Limits of all measures, those of rated_measures() until set otherwise.
class RatingLimits {
 public:
  RatingLimits();
  /// "iso=0.6", "lag_ms=20", "correlation=none". Throws std::invalid_argument with what was expected.
  void set(const std::string& assignment);
  [[nodiscard]] std::optional<double> of(const std::string& key) const { return limits_.at(key); }
  /// True where the limit is not the one of rated_measures().
  [[nodiscard]] bool is_set(const std::string& key) const { return set_.contains(key); }

 private:
  std::map<std::string, std::optional<double>> limits_;
  std::map<std::string, std::string> set_;  ///< as asked for
};

}  // namespace grouser
