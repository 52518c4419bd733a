#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "model/check.h"
#include "model/errors.h"
#include "model/provenance.h"
#include "tests/support/floating_point_traps.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

/// What the check says, line by line.
std::vector<std::string> verdict(const std::filesystem::path& file) {
  try {
    return {check_file(file)};
  } catch (const InputError& error) {
    std::vector<std::string> lines;
    for (const InputFinding& finding : error.findings()) lines.push_back(finding.text());
    return lines;
  }
}

TEST(BrokenFiles, AreEachRefusedWithTheirOwnWords) {
  const test::WithoutTraps of_overflow;  // what is too large for a double is found by it
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(test_data("broken"));
  const auto expected = nlohmann::json::parse(read_whole("expected.json"));
  EXPECT_GE(expected.size(), 90u);
  for (const auto& [file, lines] : expected.items()) {
    EXPECT_EQ(verdict(file), lines.get<std::vector<std::string>>()) << file;
  }
  std::filesystem::current_path(before);
}

/// CSV files and pictures of the ground are read through the files that name them.
TEST(BrokenFiles, AreAllExpected) {
  const auto expected = nlohmann::json::parse(read_whole(test_data("broken/expected.json")));
  for (const auto& file : std::filesystem::directory_iterator(test_data("broken"))) {
    const std::string name = file.path().filename();
    const bool book = name == "expected.json" || name == "commands.json";
    if (file.path().extension() != ".json" || book) continue;
    EXPECT_TRUE(expected.contains(name)) << name;
  }
}

TEST(BrokenFiles, ThatAreNotThereAreAnotherKindOfError) {
  EXPECT_THROW(static_cast<void>(check_file(test_data("broken/absent.json"))), FileError);
}

}  // namespace
}  // namespace grouser
