#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "model/provenance.h"
#include "tests/fuzz/entries.h"

namespace grouser::fuzz {
namespace {

using Entry = void (*)(std::string_view);

/// Feeds every input that the repository keeps for an entry: seeds, and whatever once went wrong.
void replay(const char* name, Entry entry) {
  const std::filesystem::path folder = std::filesystem::path(GROUSER_SOURCE_DIR) / "tests/fuzz/corpus" / name;
  std::vector<std::filesystem::path> inputs;
  for (const auto& item : std::filesystem::directory_iterator(folder)) inputs.push_back(item.path());
  std::sort(inputs.begin(), inputs.end());
  ASSERT_FALSE(inputs.empty());
  for (const std::filesystem::path& input : inputs) {
    EXPECT_NO_THROW(entry(read_whole(input))) << input.filename();
  }
}

TEST(FuzzCorpus, OfJsonIsReadOrRefused) { replay("json", json_entry); }
TEST(FuzzCorpus, OfCsvIsReadOrRefused) { replay("csv", csv_entry); }
TEST(FuzzCorpus, OfHdf5IsReadOrRefused) { replay("hdf5", hdf5_entry); }
TEST(FuzzCorpus, OfReportsIsWrittenOrRefused) { replay("report", report_entry); }
TEST(FuzzCorpus, OfRunReportsIsWrittenOrRefused) { replay("run_report", run_report_entry); }

}  // namespace
}  // namespace grouser::fuzz
