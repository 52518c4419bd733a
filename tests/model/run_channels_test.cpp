#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>
#include <future>
#include <sstream>

#include "model/errors.h"
#include "model/run.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

std::vector<ChannelTable> tables() {
  return {{"samples",
           {{"/time", "s", {}},
            {"/tracks/left/link_position", "m", {76, 3}},
            {"/tracks/left/contact_force/ground", "N", {76, 3}, true, true}}},
          {"steps", {{"/steps/time", "s", {}}, {"/steps/size", "s", {}}}}};
}

/// Row i holds i, then i + its column.
void append_rows(RunWriter& writer, int first, int count) {
  std::vector<double> row(1 + 2 * 76 * 3);
  for (int i = first; i < first + count; ++i) {
    row[0] = i;
    for (std::size_t c = 1; c < row.size(); ++c) row[c] = i + static_cast<double>(c);
    writer.append(0, row);
    writer.append(1, std::vector<double>{static_cast<double>(i), 1e-4});
  }
}

TEST(RunChannels, ComeBackAsWritten) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  {
    RunWriter writer(file, tables(), {{"/joints/names", {"left idler arm", "left idler"}}});
    append_rows(writer, 0, 1500);  // several chunks and a part of one
    writer.close();
  }
  const RunReader reader(file);
  EXPECT_EQ(reader.datasets().size(), 6u);
  EXPECT_TRUE(reader.has("/steps/size"));
  EXPECT_FALSE(reader.has("/steps"));
  EXPECT_FALSE(reader.has("/nothing/here"));
  const Array position = reader.read("/tracks/left/link_position");
  EXPECT_EQ(position.shape, (std::vector<std::size_t>{1500, 76, 3}));
  EXPECT_EQ(position.unit, "m");
  EXPECT_EQ(position.row(1499)[5], 1499.0 + 6.0);
  EXPECT_EQ(reader.read_rows("/time", 700, 2).values, (std::vector<double>{700.0, 701.0}));
  EXPECT_EQ(reader.read_column("/tracks/left/contact_force/ground", {75, 2}).at(10), 10.0 + 456.0);
  EXPECT_EQ(reader.read_names("/joints/names"), (std::vector<std::string>{"left idler arm", "left idler"}));
}

/// The survey forks: HDF5's lock in the hands of the writer's thread would hold the child for ever.
TEST(RunChannels, AreReadWhileTheWritersThreadWrites) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  {
    RunWriter writer(file, tables(), {});
    append_rows(writer, 0, 10);
    writer.close();
  }
  for (int i = 0; i < 100; ++i) {
    RunWriter busy(folder.path() / "busy.h5", tables(), {});
    for (int k = 0; k < 200; ++k) busy.flush();
    EXPECT_EQ(RunReader(file).read("/time").rows(), 10u);
  }
}

TEST(RunChannels, RefuseWhatIsNotThere) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  RunWriter(file, tables(), {}).close();
  const RunReader reader(file);
  EXPECT_EQ(reader.read("/time").rows(), 0u);
  EXPECT_THROW(static_cast<void>(reader.read("/velocity")), FileError);
  EXPECT_THROW(static_cast<void>(reader.read_rows("/time", 0, 1)), FileError);
  EXPECT_THROW(static_cast<void>(reader.read_column("/tracks/left/link_position", {76, 0})), FileError);
  EXPECT_THROW(RunReader(folder.write("text.h5", "not HDF5")), FileError);
}

TEST(RunChannels, OfAKilledRunAreReadableUpToTheLastFlush) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  const pid_t child = ::fork();
  if (child == 0) {
    RunWriter writer(file, tables(), {});
    writer.publish();
    append_rows(writer, 0, 1000);
    std::promise<void> safe;
    writer.sync([&] { safe.set_value(); });
    safe.get_future().wait();
    append_rows(writer, 1000, 900);  // partly written, never flushed
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const RunReader reader(file);
  ASSERT_GE(reader.read("/time").rows(), 1000u);
  EXPECT_EQ(reader.read_column("/tracks/left/link_position", {0, 0}).at(999), 1000.0);
  EXPECT_EQ(reader.read_column("/tracks/left/contact_force/ground", {75, 2}).at(999), 999.0 + 456.0);
  EXPECT_GE(reader.read("/steps/time").rows(), 1000u);
}

TEST(RunChannels, OfAnEarlierRunStayUntilThoseThatKeepSomeArePublished) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  const auto rows = [&] { return RunReader(file).read("/time").rows(); };
  {
    RunWriter earlier(file, tables(), {});
    append_rows(earlier, 0, 2000);
    earlier.close();
  }
  { const RunWriter given_up(file, tables(), {}, {1100, 1100}); }
  EXPECT_EQ(rows(), 2000u);
  RunWriter later(file, tables(), {}, {1100, 1100});
  EXPECT_EQ(rows(), 2000u);
  later.publish();
  EXPECT_EQ(rows(), 1100u);
  append_rows(later, 1100, 100);
  later.close();
  EXPECT_EQ(rows(), 1200u);
  EXPECT_EQ(RunReader(file).read_column("/tracks/left/link_position", {0, 0}).at(1199), 1200.0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);  // and nothing beside it
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file, std::ios::binary).rdbuf();
  return all.str();
}

TEST(RunChannels, AreTheSameBytesHoweverFarTheWriterLagsBehind) {
  const TemporaryFolder folder;
  for (const char* name : {"prompt.h5", "late.h5"}) {
    const bool late = name == std::string("late.h5");
    std::promise<void> all_appended;
    const std::shared_future<void> go = all_appended.get_future().share();
    RunWriter writer(folder.path() / name, tables(), {});
    // The writer stands here until all that its queue takes has been appended.
    writer.sync([late, go] {
      if (late) go.wait();
    });
    append_rows(writer, 0, 3000);  // four full chunks, two a table: what the queue takes
    all_appended.set_value();
    writer.flush();
    append_rows(writer, 3000, 1500);
    writer.close();
  }
  EXPECT_TRUE(bytes_of(folder.path() / "prompt.h5") == bytes_of(folder.path() / "late.h5"));
}

TEST(RunChannels, TellOfAFailureOfTheWritersThreadInALaterCall) {
  const TemporaryFolder folder;
  RunWriter writer(folder.path() / "run.h5", tables(), {});
  writer.sync([] { throw FileError("cannot write checkpoint"); });
  EXPECT_THROW(append_rows(writer, 0, 100000), FileError);
  EXPECT_THROW(writer.close(), FileError);
}

TEST(RunChannels, AreLeftAsTheyAreBehindAnyErrorOfTheWritersThread) {
  const TemporaryFolder folder;
  const auto write = [&] {
    RunWriter writer(folder.path() / "run.h5", tables(), {});
    writer.publish();
    writer.sync([] { throw std::bad_alloc(); });
    append_rows(writer, 0, 100000);
  };
  EXPECT_THROW(write(), std::bad_alloc);  // and the writer's end throws nothing more
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "run.h5"));
}

TEST(RunChannels, AreNotWrittenThroughALink) {
  const TemporaryFolder folder;
  const auto elsewhere = folder.write("elsewhere", "of a user");
  std::filesystem::create_symlink(elsewhere, folder.path() / "run.h5.part");
  EXPECT_THROW(RunWriter(folder.path() / "run.h5", tables(), {}), FileError);
  EXPECT_EQ(bytes_of(elsewhere), "of a user");
}

TEST(RunChannels, RefuseWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails as one on a full disk does
    const rlimit limit{1 << 20, 1 << 20};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      RunWriter writer(folder.path() / "run.h5", tables(), {});
      append_rows(writer, 0, 100000);
      writer.close();
    } catch (const FileError&) {
      ::_exit(5);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

}  // namespace
}  // namespace grouser
