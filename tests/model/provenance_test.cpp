#include "model/provenance.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "model/errors.h"
#include "model/folder_lock.h"
#include "model/replace_file.h"
#include "tests/support/test_data.h"

namespace {
int exchange_error = 0;  // what an exchange of names is refused with; 0: it is not
}

/// Takes the C library's place in this program.
extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  if (exchange_error == 0) return static_cast<int>(syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
  errno = exchange_error;
  return -1;
}

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

TEST(WriteWhole, WritesOverWhatAKilledProcessLeft) {
  const TemporaryFolder folder;
  folder.write("out.json.part", "half of a file that is longer");
  write_whole(folder.path() / "out.json", "new");
  EXPECT_EQ(read_whole(folder.path() / "out.json"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteWhole, OfManyWritersOneFileIsWhole) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "out";
  std::vector<std::thread> writers;
  for (const char letter : {'a', 'b', 'c', 'd'}) {
    writers.emplace_back([&file, letter] {
      for (int i = 0; i < 20; ++i) write_whole(file, std::string(100000, letter));
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string left = read_whole(file);
  EXPECT_EQ(left, std::string(100000, left.front()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

class ReplaceFolder : public testing::Test {
 protected:
  ~ReplaceFolder() override { exchange_error = 0; }
};

TEST_F(ReplaceFolder, LeavesTheNewOneAlone) {
  const TemporaryFolder folder;
  bool there = false;
  for (const int error : {0, 0, EINVAL, ENOSYS}) {
    exchange_error = error;
    std::filesystem::create_directories(folder.path() / "made");
    folder.write("made/new", "new");
    if (std::exchange(there, true)) folder.write("folder/old", "old");
    replace_folder(folder.path() / "made", folder.path() / "folder");
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "folder" / "new"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "folder" / "old"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "made"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  }
}

TEST_F(ReplaceFolder, ThatFailsLeavesTheOldOne) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "made");
  std::filesystem::create_directories(folder.path() / "folder");
  folder.write("folder/old", "old");
  exchange_error = EIO;
  EXPECT_THROW(replace_folder(folder.path() / "made", folder.path() / "folder"), FileError);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "made"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "folder" / "old"));
  exchange_error = EINVAL;
  EXPECT_THROW(replace_folder(folder.path() / "absent", folder.path() / "folder"), FileError);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "folder" / "old"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(WriteWhole, WaitsForNoPipeAndReplacesNone) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "out.json.part").c_str(), 0600), 0);
  EXPECT_THROW(write_whole(folder.path() / "out.json", "new"), FileError);
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(write_whole(folder.path() / "pipe", "new"), FileError);
  EXPECT_TRUE(std::filesystem::is_fifo(folder.path() / "pipe"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(WriteWhole, LeavesTheOtherNameOfAFileAlone) {
  const TemporaryFolder folder;
  const auto precious = folder.write("precious", "of somebody");
  std::filesystem::create_hard_link(precious, folder.path() / "out.json.part");
  EXPECT_THROW(write_whole(folder.path() / "out.json", "new"), FileError);
  EXPECT_EQ(read_whole(precious), "of somebody");
}

TEST(RequireApart, KnowsAFileByWhateverName) {
  const TemporaryFolder folder;
  const auto input = folder.write("input.json", "given");
  std::filesystem::create_symlink(input, folder.path() / "link.json");
  EXPECT_THROW(require_apart({folder.path() / "absent", folder.path() / "." / "input.json"}, {input}), FileError);
  EXPECT_THROW(require_apart({input}, {folder.path() / "absent", folder.path() / "link.json"}), FileError);
  EXPECT_NO_THROW(require_apart({folder.path() / "absent"}, {input, folder.path() / "absent"}));
}

TEST(RequireRoom, FindsWhatIsThereAndLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(require_room(folder.path(), 1000));
  EXPECT_THROW(require_room(folder.path(), std::uintmax_t{1} << 60), FileError);
  EXPECT_THROW(require_room(folder.path() / "absent", 1000), FileError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(FolderLock, IsHeldByOneAtATimeAndGivenBack) {
  const TemporaryFolder folder;
  {
    const FolderLock held(folder.path(), "run");
    EXPECT_THROW(FolderLock(folder.path(), "run"), FileError);
  }
  EXPECT_NO_THROW(FolderLock(folder.path(), "run"));
}

TEST(ReadWhole, SaysWhatItCouldNotRead) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_whole(folder.path() / "absent")), FileError);
  EXPECT_THROW(static_cast<void>(read_whole(folder.path())), FileError);
  EXPECT_EQ(read_whole(folder.write("empty", "")), "");
}

}  // namespace
}  // namespace grouser
