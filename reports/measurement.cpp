#include "reports/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/csv.h"
#include "model/errors.h"
#include "model/findings.h"
#include "model/input_file.h"
#include "model/units.h"
#include "model/utf8.h"

namespace grouser {
namespace {

/// A column's name taken apart.
struct NamedColumn {
  std::string column;
  std::string name;
  std::optional<Unit> unit;
};

NamedColumn taken_apart(const std::string& column) {
  if (const auto named = split_name_and_unit(column)) return {column, named->name, named->unit};
  return {column, column, std::nullopt};
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// For pages: names of older loggers are in Latin-1.
std::string in_utf8(const std::string& text) {
  if (is_utf8(text)) return text;
  std::string converted;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      converted += c;
    } else {
      converted += static_cast<char>(0xC0 | (byte >> 6));
      converted += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return converted;
}

/// A column to be read.
struct Wanted {
  NamedColumn column;
  const RunChannel* channel;
  bool reversed;
};

/// Finds which columns are compared with what.
class Matching {
 public:
  Matching(const CsvReader& table, const std::vector<RunChannel>& channels, std::string stem, Findings& findings)
      : place_(table.place_of_names()), channels_(channels), stem_(std::move(stem)), findings_(findings) {
    for (const std::string& name : table.names()) columns_.push_back(taken_apart(name));
    for (const RunChannel& channel : channels) {
      words_.push_back(channel.name);
      words_.push_back(channel.column.name);
    }
  }

  /// Every column whose name is a channel's; a name that nearly is one is a finding, others are left out.
  void by_name(std::vector<std::string>& left_out) {
    for (const NamedColumn& column : columns_) {
      if (is_time(column) || lower(column.name) == "time") continue;
      const std::vector<const RunChannel*> found = channels_called(channels_, lower(column.name), stem_);
      if (found.size() == 1) {
        take(column, *found.front(), false);
      } else if (found.size() > 1) {
        findings_.add(at(column), "the name of one channel", column.name, several(found));
      } else if (const std::string near = nearest_word(lower(column.name), words_); !near.empty()) {
        findings_.add(at(column), "the name of a channel", column.name, did_you_mean(near));
      } else {
        left_out.push_back(in_utf8(column.column));
      }
    }
  }

  /// Those that the user names, and no others.
  void as_asked(const std::vector<std::pair<std::string, std::string>>& asked) {
    for (const auto& [column_name, channel_name] : asked) {
      const bool reversed = channel_name.starts_with('-');
      const std::string name = channel_name.substr(reversed ? 1 : 0);
      const NamedColumn* column = called(column_name);
      if (column == nullptr || name == "time") continue;
      const std::vector<const RunChannel*> found = channels_called(channels_, name);
      if (found.size() == 1)
        take(*column, *found.front(), reversed);
      else if (found.size() > 1)
        findings_.add("--channel " + column_name, "the name of one channel", name, several(found));
      else
        findings_.add("--channel " + column_name, "the name of a channel (--list-channels prints them)", name,
                      did_you_mean(nearest_word(name, words_)));
    }
  }

  /// The time column: the one that `asked` calls so, else by its name; nullptr with a finding when there is none.
  const NamedColumn* time(const std::vector<std::pair<std::string, std::string>>& asked) {
    for (const auto& [column_name, channel_name] : asked)
      if (channel_name == "time") {
        const NamedColumn* column = called(column_name);
        if (column != nullptr && !(column->unit && column->unit->dimension == dimension::time)) {
          findings_.add(at(*column), "a unit of time, such as s", "none");
          return nullptr;
        }
        return column;
      }
    for (const NamedColumn& column : columns_)
      if (is_time(column)) return &column;
    findings_.add(place_, "a column time with its unit (time_s, Time [ms]), or --channel COLUMN=time", list());
    return nullptr;
  }

  [[nodiscard]] const std::vector<Wanted>& wanted() const { return wanted_; }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] std::string list() const {
    std::string names;
    for (const NamedColumn& column : columns_) names += (names.empty() ? "" : ", ") + column.column;
    return names.empty() ? "none" : names;
  }

 private:
  static bool is_time(const NamedColumn& column) {
    return lower(column.name) == "time" && column.unit && column.unit->dimension == dimension::time;
  }
  [[nodiscard]] std::string at(const NamedColumn& column) const { return place_ + ", column " + column.column; }

  static std::string several(const std::vector<const RunChannel*>& found) {
    std::string names;
    for (const RunChannel* channel : found) names += (names.empty() ? "one of " : ", ") + channel->name;
    return names;
  }

  /// By its name with or without the unit.
  const NamedColumn* called(const std::string& name) {
    std::vector<std::string> names;
    for (const NamedColumn& column : columns_) {
      if (in_utf8(column.column) == name || in_utf8(column.name) == name) return &column;
      names.push_back(column.name);
    }
    findings_.add(place_, "the column " + name + " of --channel", list(), did_you_mean(nearest_word(name, names)));
    return nullptr;
  }

  void take(const NamedColumn& column, const RunChannel& channel, bool reversed) {
    const std::string suffix = unit_suffix(channel.unit);
    const Dimension expected = suffix.empty() ? dimension::none : unit(suffix).dimension;
    const Dimension found = column.unit ? column.unit->dimension : dimension::none;
    if (expected != found) {
      const std::string usual = usual_unit(expected);
      findings_.add(at(column),
                    fmt::format("a unit of {} for {}{}", name_of(expected), channel.name,
                                usual.empty() ? "" : ", such as " + usual),
                    column.unit ? name_of(found) : "no unit");
      return;
    }
    for (const Wanted& other : wanted_)
      if (other.column.column == column.column || other.channel == &channel) {
        findings_.add(at(column), "each channel and each column once", channel.name + " twice");
        return;
      }
    wanted_.push_back({column, &channel, reversed});
  }

  std::string place_;
  const std::vector<RunChannel>& channels_;
  std::string stem_;
  Findings& findings_;
  std::vector<NamedColumn> columns_;
  std::vector<std::string> words_;
  std::vector<Wanted> wanted_;
};

double in_si(double value, const std::optional<Unit>& unit) { return unit ? unit->to_si(value) : value; }

/// The samples of a column that are there, in SI and with the sign of the run.
TimeSeries series_of(const std::vector<double>& clock, const std::vector<double>& values, const Wanted& wanted) {
  TimeSeries series;
  for (std::size_t i = 0; i < clock.size(); ++i) {
    if (std::isnan(values[i])) continue;
    series.time.push_back(clock[i]);
    series.value.push_back((wanted.reversed ? -1.0 : 1.0) * in_si(values[i], wanted.column.unit));
  }
  return series;
}

void check_rising(const std::vector<double>& time, const std::string& column, Findings& findings) {
  for (std::size_t i = 1; i < time.size(); ++i)
    if (!(time[i] > time[i - 1])) {
      findings.add("column " + column, "a time that rises from sample to sample",
                   fmt::format("{} s after {} s, at sample {}", time[i], time[i - 1], i + 1));
      return;
    }
  if (time.size() < 2) findings.add("column " + column, "two samples or more", std::to_string(time.size()));
}

}  // namespace

Measurement read_measurement(const std::filesystem::path& file, const std::vector<RunChannel>& channels,
                             const ReportOptions& options) {
  std::ifstream stream = open_input(file);
  Findings findings(file.string());
  CsvReader table(stream, findings);
  require_sound(stream, file);
  findings.throw_if_any();

  Measurement measurement{file, {}, {}, {}};
  Matching matching(table, channels, file.stem().string(), findings);
  const NamedColumn* time = matching.time(options.channels);
  const bool asked = std::ranges::any_of(options.channels, [](const auto& pair) { return pair.second != "time"; });
  asked ? matching.as_asked(options.channels) : matching.by_name(measurement.left_out);
  if (findings.empty() && matching.wanted().empty())
    findings.add(matching.place(), "a column called like a channel of the run (--list-channels prints them)",
                 matching.list());
  findings.throw_if_any();

  std::vector<std::string> names{time->column};
  for (const Wanted& wanted : matching.wanted()) names.push_back(wanted.column.column);
  const std::vector<CsvColumn> columns = table.read(names, CsvReader::Missing::as_nan);
  require_sound(stream, file);
  findings.throw_if_any();
  std::vector<double> clock = columns.front().values;
  for (double& t : clock) t = in_si(t, time->unit);
  check_rising(clock, time->column, findings);
  findings.throw_if_any();
  for (double& t : clock) t += options.shift;

  measurement.sha256 = table.sha256();
  for (std::size_t i = 0; i < matching.wanted().size(); ++i) {
    const Wanted& wanted = matching.wanted()[i];
    measurement.channels.push_back({in_utf8(wanted.column.column), *wanted.channel, wanted.reversed,
                                    series_of(clock, columns[i + 1].values, wanted)});
  }
  return measurement;
}

}  // namespace grouser
