#include "model/provenance.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "model/errors.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

TEST(Sha256, GivesTheDigestsOfTheStandard) {
  // FIPS 180-4 examples.
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const TemporaryFolder folder;
  const std::string million(1000000, 'a');
  EXPECT_EQ(sha256_of_file(folder.write("a", million)),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(WriteWhole, ReplacesTheOldFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  const auto file = folder.write("out.json", "old");
  write_whole(file, "new");
  EXPECT_EQ(read_whole(file), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteWhole, ThatFailsLeavesTheOldFile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "taken";
  std::filesystem::create_directories(file / "inside");  // a folder of that name cannot be replaced
  EXPECT_THROW(write_whole(file, "new"), FileError);
  EXPECT_TRUE(std::filesystem::exists(file / "inside"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(ReadWhole, SaysWhatItCouldNotRead) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_whole(folder.path() / "absent")), FileError);
  EXPECT_THROW(static_cast<void>(read_whole(folder.path())), FileError);
  EXPECT_EQ(read_whole(folder.write("empty", "")), "");
}

}  // namespace
}  // namespace grouser
