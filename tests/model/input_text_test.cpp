#include <gtest/gtest.h>

#include "model/errors.h"
#include "model/findings.h"
#include "model/input_file.h"
#include "tests/support/test_data.h"

#include <sys/stat.h>

namespace grouser {
namespace {

TEST(Printable, ShowsControlCharactersAndMovesNoCursor) {
  EXPECT_EQ(printable("a\x1b[2J\nb\x7f"),
            "a\\x1b[2J\\x0a"
            "b\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"), "\\xc2\\x9b");  // CSI of C1
}

TEST(Printable, KeepsUtf8AndShowsOtherBytes) {
  EXPECT_EQ(printable("Gr\xc3\xbc\xc3\x9f"
                      "e \xe2\x82\xac \xf0\x9f\x9a\x9c"),
            "Gr\xc3\xbc\xc3\x9f"
            "e \xe2\x82\xac \xf0\x9f\x9a\x9c");
  EXPECT_EQ(printable("L\xe4nge"), "L\\xe4nge");                              // Latin-1
  EXPECT_EQ(printable("\xc0\xaf\xe0\x80\xaf"), "\\xc0\\xaf\\xe0\\x80\\xaf");  // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");                    // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");           // beyond the last character
  EXPECT_EQ(printable("cut \xe2\x82"), "cut \\xe2\\x82");
}

TEST(Printable, CutsWhatNobodyReads) { EXPECT_LT(printable(std::string(1'000'000, 'x')).size(), 3000u); }

TEST(Findings, EndWithTheWordThatThereAreMore) {
  Findings findings("file.json");
  for (int i = 0; i < 1000; ++i) findings.add("/" + std::to_string(i), "a number", "none");
  ASSERT_EQ(findings.size(), Findings::k_most + 1);
  EXPECT_EQ(findings.list().back().text(), "file.json: expected at most 200 faults to tell of, found more");
}

/// Opening a pipe would wait for somebody who writes; this test would then never end.
TEST(InputFile, IsNoPipe) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(static_cast<void>(open_input(folder / "pipe")), FileError);
}

TEST(InputFile, IsNoDevice) { EXPECT_THROW(static_cast<void>(open_input("/dev/zero")), FileError); }

TEST(InputFile, IsNoFolder) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(open_input(folder.path())), FileError);
}

}  // namespace
}  // namespace grouser
