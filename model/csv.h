#pragma once
#include <istream>
#include <string>
#include <vector>

#include "model/csv_head.h"
#include "model/csv_lines.h"
#include "model/findings.h"

/// Tables of numbers as loggers and spreadsheets write them: fields divided by semicolon, tab, comma or blanks,
/// whichever the line of names uses; decimal point or decimal comma; lines that begin with `#`, `%` or `//` are
/// remarks. See find_csv_head for names and units.
namespace grouser {

/// One column: its name in the header and its numbers as they stand there.
struct CsvColumn {
  std::string name;
  std::vector<double> values;
};

/// Reads a table of any length in pieces: memory holds the wanted columns and one piece (CsvLines::k_piece).
class CsvReader {
 public:
  /// Reads the names of the columns; a finding says why there are none, or none that can be used. `in` and `findings`
  /// must outlive this.
  CsvReader(std::istream& in, Findings& findings);

  /// Column names with their units, in file order; empty for a file without any line.
  [[nodiscard]] const std::vector<std::string>& names() const { return head_.names; }
  /// "row 3": where the names stand.
  [[nodiscard]] std::string place_of_names() const;

  /// Columns of the given names, in the given order; called once. Other columns are not converted, so texts may stand
  /// there. A finding names row (line of the file, counted from 1) and column; after 20 of them the rest of the file
  /// is left. An empty field or the text NaN is a finding too, or where `missing` is as_nan a NaN: loggers of several
  /// rates leave fields free.
  enum class Missing { refused, as_nan };
  [[nodiscard]] std::vector<CsvColumn> read(const std::vector<std::string>& wanted, Missing missing = Missing::refused);

  /// SHA-256 of the file's bytes, once it was read to its end.
  [[nodiscard]] std::string sha256() { return lines_.sha256(); }

 private:
  void check_names();
  void report_long_line();

  Findings& findings_;
  CsvLines lines_;
  std::vector<CsvHeadLine> first_lines_;
  CsvHead head_;
};

}  // namespace grouser
