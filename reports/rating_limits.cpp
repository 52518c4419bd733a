#include "reports/rating_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "model/csv_fields.h"
#include "model/findings.h"
#include "model/units.h"
#include "reports/number_text.h"

namespace grouser {
namespace {

using Bound = RatedMeasure::Bound;
using Value = std::optional<double>;

constexpr const char* k_nchrp = "NCHRP Web-Only Document 179 (Ray et al. 2010), for vehicle crash simulations";
constexpr const char* k_own = "a choice of Grouser: no standard states one";

const std::array<RatedMeasure, 8> k_measures{{
    {"iso", "ISO rating", "ISO rating", "1", Bound::at_least, k_iso_good, "ISO/TS 18571:2014: the grade “good”",
     [](const Ratings& r) { return r.iso ? Value(r.iso->overall()) : Value(); }},
    {"magnitude", "Sprague-Geers M", "M", "%", Bound::at_most, 0.40, k_nchrp,
     [](const Ratings& r) { return r.sprague_geers ? Value(r.sprague_geers->magnitude) : Value(); }},
    {"phase", "Sprague-Geers P", "P", "%", Bound::at_most, 0.40, k_nchrp,
     [](const Ratings& r) { return r.sprague_geers ? Value(r.sprague_geers->phase) : Value(); }},
    {"combined", "Sprague-Geers C", "C", "%", Bound::at_most, std::nullopt, "",
     [](const Ratings& r) { return r.sprague_geers ? Value(r.sprague_geers->combined()) : Value(); }},
    {"nrmse", "RMSE of the range", "RMSE", "%", Bound::at_most, 0.10, k_own, [](const Ratings& r) { return r.nrmse; }},
    {"correlation", "Correlation", "correlation", "1", Bound::at_least, 0.90, k_own,
     [](const Ratings& r) { return r.correlation; }},
    {"peak", "Peak ratio", "peak", "1", Bound::about_one, std::nullopt, "",
     [](const Ratings& r) { return r.peak_ratio; }},
    {"lag", "Lag, late > 0", "lag", "s", Bound::at_most, std::nullopt, "", [](const Ratings& r) { return r.lag; }},
}};

std::vector<std::string> keys() {
  std::vector<std::string> names;
  for (const RatedMeasure& measure : k_measures) names.emplace_back(measure.key);
  return names;
}

}  // namespace

bool RatedMeasure::meets(double found, double allowed) const {
  switch (bound) {
    case Bound::at_least:
      return found >= allowed;
    case Bound::at_most:
      return std::abs(found) <= allowed;
    case Bound::about_one:
      return std::abs(found - 1.0) <= allowed;
  }
  return false;
}

std::string RatedMeasure::text(const Value& allowed) const {
  if (!allowed) return "";
  const std::string number = unit == std::string("%") ? percent_text(*allowed) : quantity_text(*allowed, unit);
  return (bound == Bound::at_least ? "≥ " : bound == Bound::at_most ? "≤ " : "1 ± ") + number;
}

std::span<const RatedMeasure> rated_measures() { return k_measures; }

RatingLimits::RatingLimits() {
  for (const RatedMeasure& measure : k_measures) limits_[measure.key] = measure.limit;
}

void RatingLimits::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  std::string key = assignment.substr(0, equals);
  const std::string text = equals == std::string::npos ? "" : assignment.substr(equals + 1);
  double to_si = 1.0;
  if (const auto named = split_name_and_unit(key); named && named->name == "lag") {
    if (named->unit.dimension != dimension::time)
      throw std::invalid_argument("expected a limit of lag in a unit of time (lag_ms=20), found " + assignment);
    to_si = named->unit.to_si(1.0);
    key = "lag";
  } else if (key == "lag" && text != "none") {
    throw std::invalid_argument("expected a limit of lag with its unit (lag_ms=20), found " + assignment);
  }
  if (!limits_.contains(key)) {
    std::string known;
    for (const std::string& name : keys()) known += (known.empty() ? "" : ", ") + name;
    const std::string hint = did_you_mean(nearest_word(key, keys()));
    throw std::invalid_argument("expected a limit of " + known + ", found " + assignment +
                                (hint.empty() ? "" : " (" + hint + ")"));
  }
  const std::optional<double> number = number_in(text);
  if (text != "none" && (!number || *number < 0.0))
    throw std::invalid_argument("expected " + key + "=NUMBER, at least 0, or " + key + "=none, found " + assignment);
  limits_[key] = text == "none" ? Value() : Value(*number * to_si);
  set_[key] = assignment;
}

}  // namespace grouser
