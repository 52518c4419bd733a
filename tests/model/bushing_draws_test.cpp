#include "model/bushing_draws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "model/check.h"
#include "model/errors.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

namespace fs = std::filesystem;

std::vector<Bushing> draws(std::size_t count) {
  std::vector<Bushing> list(count);
  for (std::size_t k = 0; k < count; ++k) {
    list[k].name = "b, draw " + std::to_string(k + 1) + " of " + std::to_string(count);
    list[k].axis(Axis::x).spring = SpringSpline::linear(1e8 + 1e6 * static_cast<double>(k), 1e-3);
  }
  return list;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(BushingDraws, AreOrdinaryBushingFiles) {
  const TemporaryFolder folder;
  BushingDraws(draws(2), folder / "draws").publish();
  EXPECT_EQ(names_in(folder / "draws"), (std::vector<std::string>{"bushing_01.json", "bushing_02.json"}));
  EXPECT_EQ(check_file(folder / "draws" / "bushing_02.json"), "ok: bushing b, draw 2 of 2, axes x");
  EXPECT_DOUBLE_EQ(read_bushing(folder / "draws" / "bushing_02.json").axis(Axis::x).spring.slope.front(), 1.01e8);
}

TEST(BushingDraws, SortByTheirNumber) {
  const TemporaryFolder folder;
  BushingDraws(draws(120), folder / "draws").publish();
  const auto names = names_in(folder / "draws");
  EXPECT_EQ(names.front(), "bushing_001.json");
  EXPECT_EQ(names.back(), "bushing_120.json");
}

TEST(BushingDraws, ReplaceThoseOfAnEarlierFit) {
  const TemporaryFolder folder;
  BushingDraws(draws(5), folder / "draws").publish();
  BushingDraws(draws(2), folder / "draws").publish();
  EXPECT_EQ(names_in(folder / "draws").size(), 2u);
  BushingDraws({}, folder / "draws").publish();
  EXPECT_FALSE(fs::exists(folder / "draws"));
}

TEST(BushingDraws, DoNotTakeAUsersFilesAway) {
  const TemporaryFolder folder;
  BushingDraws(draws(2), folder / "draws").publish();
  fs::create_directories(folder / "draws" / "run_with_bushing_01");
  EXPECT_THAT([&] { BushingDraws(draws(2), folder / "draws"); },
              testing::ThrowsMessage<FileError>(testing::HasSubstr("found run_with_bushing_01")));
  EXPECT_TRUE(fs::exists(folder / "draws" / "run_with_bushing_01"));
}

TEST(BushingDraws, DoNotTakeAUsersFileOfTheirNameAway) {
  const TemporaryFolder folder;
  std::ofstream(folder / "draws") << "lots";
  EXPECT_THAT([&] { BushingDraws(draws(2), folder / "draws"); },
              testing::ThrowsMessage<FileError>(testing::HasSubstr("expected a folder of draws, found a file")));
  EXPECT_TRUE(fs::is_regular_file(folder / "draws"));
}

TEST(BushingDraws, AreNotSeenBeforeTheyArePublished) {
  const TemporaryFolder folder;
  BushingDraws(draws(5), folder / "draws").publish();
  {
    const BushingDraws unpublished(draws(3), folder / "draws");
    EXPECT_EQ(names_in(folder / "draws").size(), 5u);  // a kill now leaves those of the earlier fit
  }
  EXPECT_EQ(names_in(folder / "draws").size(), 5u);
  EXPECT_EQ(names_in(folder.path()).size(), 1u);
}

TEST(BushingDraws, AreNoneWhereOneCannotBeWritten) {
  const TemporaryFolder folder;
  std::vector<Bushing> list = draws(3);
  list[2].axis(Axis::x).viscous = std::nan("");
  EXPECT_THROW(BushingDraws(list, folder / "draws"), NumericalError);
  EXPECT_THAT(names_in(folder.path()), testing::IsEmpty());
}

}  // namespace
}  // namespace grouser
