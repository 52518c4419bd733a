#include "model/csv.h"

#include <gtest/gtest.h>

#include <sstream>

namespace grouser {
namespace {

std::vector<CsvColumn> read_csv(const std::string& text, const std::vector<std::string>& wanted, Findings& findings) {
  std::istringstream stream(text);
  CsvReader reader(stream, findings);
  return reader.read(wanted);
}

std::vector<CsvColumn> read(const std::string& text, const std::vector<std::string>& wanted) {
  Findings findings("table.csv");
  auto columns = read_csv(text, wanted, findings);
  findings.throw_if_any();
  return columns;
}

TEST(Csv, UnderstandsEveryUsualDivider) {
  const std::vector<std::string> tables{
      "time_s,force_kN\n0,1.5\n0.1,-2e1\n",
      "time_s;force_kN\n0;1,5\n0,1;-2e1\n",  // decimal comma
      "time_s\tforce_kN\n0\t1.5\n0.1\t-2e1\n",
      "  time_s   force_kN\n  0     1.5\n  0.1   -2e1\n",
      "\xEF\xBB\xBF\"time_s\",\"force_kN\"\r\n0, +1.5\r\n# a remark\r\n\r\n0.1,-20\r\n",  // as spreadsheets write
  };
  for (const std::string& table : tables) {
    const auto columns = read(table, {"force_kN", "time_s"});
    ASSERT_EQ(columns.size(), 2u) << table;
    EXPECT_EQ(columns[0].values, (std::vector<double>{1.5, -20.0})) << table;
    EXPECT_EQ(columns[1].values, (std::vector<double>{0.0, 0.1})) << table;
  }
}

TEST(Csv, LeavesOtherColumnsAlone) {
  const auto columns = read("time_s,operator,force_N\n0,Kim,1\n1,,2\n", {"force_N"});
  EXPECT_EQ(columns.at(0).values, (std::vector<double>{1.0, 2.0}));
}

TEST(Csv, NamesRowAndColumnOfEveryFault) {
  Findings findings("table.csv");
  static_cast<void>(read_csv("a_m,b_m\n1,2\n3,x\n,4\n5\n1e999,1\n1.000.000,1\n", {"a_m", "b_m"}, findings));
  std::vector<std::string> places;
  for (const InputFinding& finding : findings.list()) places.push_back(finding.place);
  EXPECT_EQ(places, (std::vector<std::string>{"row 3, column b_m", "row 4, column a_m", "row 5", "row 6, column a_m",
                                              "row 7, column a_m"}));
}

TEST(Csv, StopsListingAfterTwentyFaults) {
  std::string table = "a_m\n";
  for (int i = 0; i < 1000; ++i) table += "x\n";
  Findings findings("table.csv");
  static_cast<void>(read_csv(table, {"a_m"}, findings));
  EXPECT_EQ(findings.size(), 21u);
}

TEST(Csv, WantsNamesAndRows) {
  for (const char* const table :
       {"", "# only a remark\n", "1,2\n3,4\n", "a_m,a_m\n1,2\n", "a_m\n", "a_m,,b_m\n1,2,3\n"}) {
    Findings findings("table.csv");
    static_cast<void>(read_csv(table, {"a_m"}, findings));
    EXPECT_EQ(findings.size(), 1u) << table;
  }
}

}  // namespace
}  // namespace grouser
