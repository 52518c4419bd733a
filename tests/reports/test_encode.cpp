#include <gtest/gtest.h>
#include <zlib.h>

#include "reports/encode.h"

namespace grouser {
namespace {

std::string inflated(const std::string& bytes, std::size_t expected) {
  z_stream stream{};
  inflateInit2(&stream, 15 + 16);
  std::string out(expected + 16, '\0');
  std::string in = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

TEST(Encode, Base64KnowsTheVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Encode, GzipGivesBackWhatWentIn) {
  std::string bytes;
  for (int i = 0; i < 20000; ++i) bytes += static_cast<char>(i * i >> 3);
  EXPECT_EQ(inflated(gzip(bytes), bytes.size()), bytes);
  EXPECT_EQ(inflated(gzip(""), 0), "");
}

TEST(Encode, GzipOfTheSameBytesIsTheSame) { EXPECT_EQ(gzip("track"), gzip("track")); }

TEST(Encode, JsonInAScriptCannotEndTheScript) {
  const nlohmann::json value{{"name", "</script><script>alert(1)</script>"}, {"comment", "<!-- x"}};
  const std::string text = script_json(value);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text), value);
}

}  // namespace
}  // namespace grouser
