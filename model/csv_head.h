#pragma once
#include <string>
#include <vector>

#include "model/findings.h"

namespace grouser {

/// One of the first lines of a table, empty ones left out.
struct CsvHeadLine {
  std::string text;  ///< of a remark without its mark
  std::size_t row = 0;
  bool remark = false;
};

/// Names of a table's columns, and where its numbers begin.
struct CsvHead {
  std::vector<std::string> names;  ///< each with its unit as suffix, where one is given
  char divider = ',';
  std::size_t row = 0;    ///< line of the file that holds the names
  std::size_t first = 0;  ///< index of the first line below names and units
};

/// Finds the line that names the columns: the first whose columns with a unit have numbers below. Loggers write lines
/// about the test above it, some write it as a remark, and some give the units in brackets ("Force [kN]") or in a row
/// of their own below; units so given become the suffix of the name ("Force_kN"). Where no line fits, the first that
/// has a unit, else the first: the reader's findings then say what is wrong with it. `lines` holds one that is no
/// remark.
[[nodiscard]] CsvHead find_csv_head(const std::vector<CsvHeadLine>& lines, Findings& findings);

}  // namespace grouser
