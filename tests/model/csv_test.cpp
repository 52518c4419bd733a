#include "model/csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "model/provenance.h"

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

TEST(Csv, TakesUnitsFromBracketsAndFromARowOfTheirOwn) {
  const std::vector<std::string> tables{
      "Time [s],Force [kN]\n0,1.5\n0.1,-20\n",         "Time (s);Force (kN)\n0;1,5\n0,1;-20\n",
      "Time [s]   Force [kN]\n 0   1.5\n 0.1   -20\n", "Time,Force\n[s],[kN]\n0,1.5\n0.1,-20\n",
      "Time\tForce\n(s)\t(kN)\n0\t1.5\n0.1\t-20\n",    "Time;Force\ns;kN\n0;1,5\n0,1;-20\n",
      "Time_s,Force\n[s],[kN]\n0,1.5\n0.1,-20\n",
  };
  for (const std::string& table : tables) {
    const auto columns = read(table, {"Force_kN", "Time_s"});
    EXPECT_EQ(columns.at(0).values, (std::vector<double>{1.5, -20.0})) << table;
    EXPECT_EQ(columns.at(1).values, (std::vector<double>{0.0, 0.1})) << table;
  }
}

TEST(Csv, KnowsUnitsAsPeopleWriteThem) {
  const auto names = [](const std::string& table) {
    std::istringstream stream(table);
    Findings findings("table.csv");
    return CsvReader(stream, findings).names();
  };
  EXPECT_EQ(names("a,b,c,d,e\n[\xC2\xB0],[Nm],[\xC2\xB0"
                  "C],[mV/V],[\xC2\xB5m]\n1,2,3,4,5\n"),
            (std::vector<std::string>{"a_deg", "b_N_m", "c_degC", "d_mV_per_V", "e_um"}));
  EXPECT_EQ(names("a [\xB0],b [N\xC2\xB7m],c [-],n\n1,2,3,4\n"),  // Latin-1; [-] is no unit
            (std::vector<std::string>{"a_deg", "b_N_m", "c [-]", "n"}));
  EXPECT_EQ(names("n,x,q\n-,mm,[counts]\n1,2,3\n"), (std::vector<std::string>{"n", "x_mm", "q [counts]"}));
  // A unit that nobody knows keeps its row a row of units, and stays with the name for messages to show.
  EXPECT_EQ(names("t,x,load\nsec,mm,pond\n1,2,3\n"), (std::vector<std::string>{"t_s", "x_mm", "load [pond]"}));
  EXPECT_EQ(names("t,load\nms,daN\n1,2\n"), (std::vector<std::string>{"t_ms", "load_daN"}));
  EXPECT_EQ(names("a [m/s^2],b [m/s\xC2\xB2],c [mm\xB2],n\n1,2,3,4\n"),
            (std::vector<std::string>{"a_m_per_s2", "b_m_per_s2", "c_mm2", "n"}));
}

TEST(Csv, TakesFieldsThatAreLeftFreeForNothingWhereThatIsAsked) {
  const std::string table = "time_s,force_kN\n0,\n1,NaN\n2,3\n";
  Findings findings("table.csv");
  EXPECT_EQ(read_csv(table, {"force_kN"}, findings).size(), 1u);
  EXPECT_EQ(findings.size(), 2u);
  std::istringstream stream(table);
  Findings none("table.csv");
  const auto columns = CsvReader(stream, none).read({"force_kN", "time_s"}, CsvReader::Missing::as_nan);
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(std::isnan(columns[0].values[0]) && std::isnan(columns[0].values[1]));
  EXPECT_EQ(columns[0].values[2], 3.0);
  EXPECT_EQ(columns[1].values, (std::vector<double>{0.0, 1.0, 2.0}));
}

TEST(Csv, PassesOverWhatALoggerWritesAboveTheNames) {
  const std::string preamble =
      "Test bench 4, run_17_m\nOperator;Kim\nStarted;2026-11-22\nSample rate_Hz;100\n\n% calibrated in_May\n";
  const auto columns = read(preamble + "time_s;x_mm;force_kN\n0;0;1\n1;0,5;2\n", {"x_mm", "force_kN"});
  EXPECT_EQ(columns.at(0).values, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(columns.at(1).values, (std::vector<double>{1.0, 2.0}));
  Findings findings("table.csv");
  static_cast<void>(read_csv(preamble + "time_s;x_mm\n0;0\n1;?\n", {"x_mm"}, findings));
  EXPECT_EQ(findings.list().at(0).place, "row 9, column x_mm");  // lines of the file, preamble and empty ones included
}

TEST(Csv, TakesNamesFromARemarkWhereNothingElseNamesTheColumns) {
  const auto columns = read("# run 17\n# time_s x_mm\n0 1\n1 2\n", {"x_mm"});  // as numerical tools write
  EXPECT_EQ(columns.at(0).values, (std::vector<double>{1.0, 2.0}));
}

TEST(Csv, ReadsQuotedFieldsAndDividersAtTheEndOfLines) {
  const auto columns = read("time_s,\"force, left_kN\",\n\"0,5\",\"1,25\",\n1,2,\n", {"force, left_kN", "time_s"});
  EXPECT_EQ(columns.at(0).values, (std::vector<double>{1.25, 2.0}));
  EXPECT_EQ(columns.at(1).values, (std::vector<double>{0.5, 1.0}));
}

TEST(Csv, RefusesARowOfUnitsThatContradictsTheNames) {
  Findings findings("table.csv");
  static_cast<void>(read_csv("time_s,force_kN\n[s],[N]\n0,1\n", {"force_kN"}, findings));
  EXPECT_EQ(findings.list().at(0).place, "row 2, column force_kN");
}

/// Makes the rows of a long table as they are read, so that the table itself takes no memory.
class GeneratedRows : public std::streambuf {
 public:
  GeneratedRows(std::string header, long rows, std::string more)
      : row_(std::move(header)), rows_(rows), more_(std::move(more)) {
    setg(row_.data(), row_.data(), row_.data() + row_.size());
  }

 protected:
  int_type underflow() override {
    if (next_ == rows_) return traits_type::eof();
    row_ = std::to_string(next_++) + more_;
    setg(row_.data(), row_.data(), row_.data() + row_.size());
    return traits_type::to_int_type(row_.front());
  }

 private:
  std::string row_;
  long rows_, next_ = 0;
  std::string more_;
};

/// A line of /proc/self/status [bytes].
double process_memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(key, 0) == 0) return 1024.0 * std::stod(line.substr(key.size() + 1));
  }
  return -1.0;
}

TEST(Csv, HoldsNoMoreThanTheWantedColumnAndOnePiece) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps memory of its own";
#endif
  constexpr long rows = 400'000;
  const std::string unwanted = ",0.123456789,0.123456789,0.123456789,0.123456789,0.123456789,0.123456789\n";
  GeneratedRows source("n_m,a_m,b_m,c_m,d_m,e_m,f_m\n", rows, unwanted);
  std::istream stream(&source);
  std::ofstream("/proc/self/clear_refs") << "5";  // sets the high-water mark back to what is held now
  const double before = process_memory("VmRSS:");
  Findings findings("table.csv");
  CsvReader reader(stream, findings);
  const auto columns = reader.read({"n_m"});
  const double peak = process_memory("VmHWM:") - before;
  ASSERT_EQ(columns.at(0).values.size(), static_cast<std::size_t>(rows));
  for (long i = 0; i < rows; ++i) ASSERT_EQ(columns[0].values[static_cast<std::size_t>(i)], static_cast<double>(i));
  // 31 MB of text, 3.2 MB of numbers. This stream cannot tell its length, so the column doubles: up to three times
  // itself while it is copied; beside it one piece, and a little for the allocator.
  EXPECT_LT(peak, 3.0 * 8.0 * rows + CsvLines::k_piece + 2e6);
}

TEST(Csv, ReadsAcrossPiecesAndKnowsTheirDigest) {
  std::string table = "n_m,text\n";
  const std::string text(900, 'x');  // no whole number of lines to a piece
  for (int i = 0; i < 10'000; ++i) table += std::to_string(i) + "," + text + "\n";
  table += "10000,last line without its end";
  ASSERT_GT(table.size(), 2 * CsvLines::k_piece);
  std::istringstream stream(table);
  Findings findings("table.csv");
  CsvReader reader(stream, findings);
  const auto columns = reader.read({"n_m"});
  EXPECT_TRUE(findings.empty());
  ASSERT_EQ(columns.at(0).values.size(), 10'001u);
  for (int i = 0; i <= 10'000; ++i) EXPECT_EQ(columns[0].values[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(reader.sha256(), sha256_of(table));
}

TEST(Csv, RefusesALineWithoutEnd) {
  Findings findings("table.csv");
  static_cast<void>(read_csv("a_m\n1\n" + std::string(CsvLines::k_piece + 1, '1'), {"a_m"}, findings));
  EXPECT_EQ(findings.list().at(0).place, "row 3");
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
