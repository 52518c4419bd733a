#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/svg_canvas.h"

namespace grouser {
namespace {

using testing::HasSubstr;
using testing::Not;

Figure two_lines(const std::string& title) {
  Figure figure;
  figure.width = 300;
  figure.height = 200;
  Panel panel;
  panel.title = title;
  panel.x_label = "Displacement [mm]";
  panel.y_label = "Force F_{x} [kN]";
  panel.bands.push_back({.name = "", .x = {0.0, 1.0}, .low = {0.0, 0.5}, .high = {0.5, 1.0}});
  panel.series.push_back({.name = "measured", .x = {0.0, 0.5, 1.0}, .y = {0.0, 1.0, 0.5}});
  panel.series.push_back({.name = "fit", .x = {0.0, 1.0}, .y = {0.2, 0.7}, .style = SeriesStyle::dashed, .hue = 4});
  figure.panels = {panel};
  return figure;
}

TEST(Svg, TakesThePagesColoursSoThatOnePictureServesLightAndDark) {
  const std::string svg = draw_svg(two_lines("Loop"), "A loop.");
  EXPECT_THAT(svg, HasSubstr("stroke=\"var(--s1,#1f6bb3)\""));  // the first of the palette, by order
  EXPECT_THAT(svg, HasSubstr("stroke=\"var(--s5,"));            // by hue 4, the fifth
  EXPECT_THAT(svg, HasSubstr("fill=\"var(--plot-muted,"));      // numbers of the axes
  EXPECT_THAT(svg, Not(HasSubstr("stroke=\"#")));               // nothing that is the same by night
}

TEST(Svg, KeepsNamesAsTextAndSaysWhatItShows) {
  const std::string svg = draw_svg(two_lines("<script>alert(1)</script>"), "A \"loop\" & more.");
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(svg, HasSubstr("role=\"img\" aria-label=\"A &quot;loop&quot; &amp; more.\""));
}

TEST(Svg, LeavesOutPointsThatAStraightLineMeets) {
  SvgCanvas canvas(100.0f, 100.0f);
  std::vector<Vector2f> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(static_cast<float>(i), i == 40 ? 50.2f : 50.0f);
  canvas.line(points, 1.0f, {});
  EXPECT_THAT(canvas.element(""), HasSubstr("d=\"M0 50l39 0l1 0.2l1-0.2l59 0\""));
}

TEST(Svg, KeepsAWayThatTurnsBack) {
  SvgCanvas canvas(100.0f, 100.0f);
  const std::vector<Vector2f> points{{0.0f, 50.0f}, {0.0f, 10.0f}, {0.0f, 90.0f}, {0.0f, 50.0f}};
  canvas.line(points, 1.0f, {});
  EXPECT_THAT(canvas.element(""), HasSubstr("d=\"M0 50l0-40l0 80l0-40\""));
}

TEST(Svg, KeepsTheBendsOfAWayThatBeginsAtRest) {
  SvgCanvas canvas(100.0f, 100.0f);
  const std::vector<Vector2f> points{{0.0f, 50.0f}, {0.0f, 50.0f}, {10.0f, 20.0f}, {20.0f, 50.0f}, {30.0f, 10.0f}};
  canvas.line(points, 1.0f, {});
  EXPECT_THAT(canvas.element(""), HasSubstr("d=\"M0 50l10-30l10 30l10-40\""));
}

TEST(Svg, StandsAloneAsAFileInTheColoursOfItsTheme) {
  const std::string light = svg_file(two_lines("Loop")), dark = svg_file(two_lines("Loop"), Theme::dark);
  for (const std::string& file : {light, dark})
    EXPECT_THAT(file, testing::StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"300\" height=\"200\""));
  EXPECT_THAT(light, HasSubstr("--card:#ffffff;"));
  EXPECT_THAT(dark, HasSubstr("--card:#171a21;"));
}

TEST(Svg, HoldsAMapAsPixelsWithoutAnyRequest) {
  Figure figure = two_lines("Map");
  figure.panels[0].map =
      HeatMap{.columns = 2, .rows = 1, .x_span = {0.0, 1.0}, .y_span = {0.0, 1.0}, .values = {1.0, 2.0}, .label = "F"};
  EXPECT_THAT(draw_svg(figure, ""), HasSubstr("href=\"data:image/png;base64,"));
}

TEST(Svg, LowersSubscriptsAndComesBack) {
  SvgCanvas canvas(100.0f, 50.0f);
  canvas.text({10.0f, 20.0f}, "F_{x} [kN]", {.size = 10.0f, .color = {}});
  EXPECT_THAT(canvas.element(""), HasSubstr(">F<tspan dy=\"2.2\" font-size=\"7.2\">x</tspan><tspan dy=\"-2.2\">"));
}

TEST(Svg, StepsOfAPathEndWhereItsPointsDo) {
  SvgCanvas canvas(100.0f, 100.0f);
  std::vector<Vector2f> points;
  for (int i = 0; i <= 200; ++i) points.emplace_back(0.333f * static_cast<float>(i), 50.0f);
  canvas.line(points, 1.0f, {});
  const std::string svg = canvas.element("");
  const std::size_t from = svg.find("d=\"M0 50l") + 3;
  double x = 0.0;
  for (std::size_t at = svg.find('l', from); at < svg.find('"', from); at = svg.find('l', at + 1))
    x += std::stod(svg.substr(at + 1));
  EXPECT_NEAR(x, 66.6, 0.06);  // half a tenth of a pixel, for 200 steps as for one
}

}  // namespace
}  // namespace grouser
