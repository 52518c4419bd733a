#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/json_reader.h"
#include "tests/support/floating_point_traps.h"

namespace grouser {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> findings_of(const std::string& text, const ObjectReader::Visit& visit) {
  Findings findings("f.json");
  const Json document = parse_json(text, findings);
  if (!document.is_null()) {
    ObjectReader reader(document, "", findings);
    visit(reader);
  }
  std::vector<std::string> texts;
  for (const InputFinding& finding : findings.list()) texts.push_back(finding.text());
  return texts;
}

TEST(StrictJson, NoticesKeysGivenTwiceAtAnyDepth) {
  const auto texts = findings_of(R"({"a": [{"k": 1}, {"k": 1, "b/c": {"x": 1, "x": 2}}]})",
                                 [](ObjectReader& r) { static_cast<void>(r.raw("a")); });
  EXPECT_THAT(texts, ElementsAre("f.json#/a/1/b~1c/x: expected each key once, found it twice"));
}

TEST(StrictJson, SaysLineAndColumnOfASyntaxError) {
  const auto texts = findings_of("{\n  \"a\": 1,\n  \"b\": ]\n}", [](ObjectReader&) {});
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_THAT(texts[0], HasSubstr("line 3, column 8"));
}

TEST(StrictJson, RefusesANumberThatNoDoubleHolds) {
  const test::WithoutTraps of_overflow;
  const auto texts = findings_of(R"({"a": 1e999})", [](ObjectReader&) {});
  EXPECT_THAT(texts, ElementsAre(HasSubstr("expected a number that a double can hold, found 1e999")));
}

TEST(ObjectReader, FindsEveryFaultOfAnObjectAtOnce) {
  const auto texts =
      findings_of(R"({"mass_mm": 3, "length_m": -1, "pitsch_mm": 2, "width": 3, "extra": 1})", [](ObjectReader& r) {
        r.quantity("mass", dimension::mass);
        r.quantity("length", dimension::length, Range::positive);
        r.quantity("pitch", dimension::length);
        r.quantity("width", dimension::length);
        r.quantity("height", dimension::length);
      });
  EXPECT_THAT(texts, ElementsAre("f.json#/mass_mm: expected a unit of mass, as in mass_kg, found a unit of length",
                                 "f.json#/length_m: expected a length > 0, found -1",
                                 "f.json#/width: expected a unit of length in the key, as in width_mm, found no unit",
                                 "f.json#/pitsch_mm: expected a known key, found pitsch_mm (did you mean pitch_mm?)",
                                 "f.json#/extra: expected a known key, found extra",
                                 "f.json: expected the key height_mm (or another unit), found no such key"));
}

TEST(ObjectReader, AllowsANoteInEveryObject) {
  EXPECT_TRUE(findings_of(R"({"note": "for people", "a": {"note": "here too"}})", [](ObjectReader& r) {
                r.object("a", [](ObjectReader&) {});
              }).empty());
}

TEST(ObjectReader, DoesNotTakeOneQuantityForAnother) {
  // "force_max_kN" is not "force" with an unknown unit once somebody asks for force_max.
  const auto texts = findings_of(R"({"force_kN": 1, "force_max_kN": 2})", [](ObjectReader& r) {
    EXPECT_DOUBLE_EQ(r.quantity("force", dimension::force), 1e3);
    EXPECT_DOUBLE_EQ(r.quantity("force_max", dimension::force), 2e3);
  });
  EXPECT_TRUE(texts.empty());
}

TEST(JsonText, IsShortestRoundTripAndStable) {
  const Json value{{"b", 0.1}, {"a", 1e-300}, {"list", {1, 2.5}}, {"rows", Json::array({{1, 2}, {3, 4}})}};
  EXPECT_EQ(
      json_text(value),
      "{\n  \"b\": 0.1,\n  \"a\": 1e-300,\n  \"list\": [1, 2.5],\n  \"rows\": [\n    [1, 2],\n    [3, 4]\n  ]\n}\n");
}

}  // namespace
}  // namespace grouser
