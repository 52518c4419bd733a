#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "model/findings.h"

/// Tables of numbers: the first line that is neither empty nor a `#` comment names the columns; fields are divided by
/// semicolon, tab, comma or blanks, whichever the header uses; where the comma does not divide, it is a decimal comma.
namespace grouser {

/// One column: its name in the header and its numbers as they stand there.
struct CsvColumn {
  std::string name;
  std::vector<double> values;
};

/// Column names, in file order; empty for a file without any line.
[[nodiscard]] std::vector<std::string> csv_header(std::string_view bytes);

/// Columns of the given names, in the given order. Other columns are not converted, so texts may stand there. A finding
/// names row (line of the file, counted from 1) and column; after 20 of them the rest of the file is left.
[[nodiscard]] std::vector<CsvColumn> read_csv(std::string_view bytes, const std::vector<std::string>& wanted,
                                              Findings& findings);

}  // namespace grouser
