#include "render/svg_canvas.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "render/base64.h"
#include "render/draw_figure.h"
#include "render/image.h"
#include "render/plot_theme.h"

namespace grouser {
namespace {

std::string hex(const Rgb& rgb) {
  const auto part = [](float share) { return static_cast<int>(std::lround(255.0f * share)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(rgb[0]), part(rgb[1]), part(rgb[2]));
}

/// The colours of a theme and the page's names for them.
std::vector<std::pair<Rgb, std::string>> named_colors(const PlotTheme& theme) {
  std::vector<std::pair<Rgb, std::string>> named{{theme.page.rgb, "--card"},
                                                 {theme.ink.rgb, "--plot-ink"},
                                                 {theme.muted.rgb, "--plot-muted"},
                                                 {theme.grid.rgb, "--plot-grid"},
                                                 {theme.minor_grid.rgb, "--plot-minor-grid"},
                                                 {theme.axis.rgb, "--plot-axis"},
                                                 {theme.zero.rgb, "--plot-zero"},
                                                 {theme.mark.rgb, "--plot-mark"},
                                                 {theme.legend_border.rgb, "--plot-border"}};
  for (std::size_t i = 0; i < theme.palette.size(); ++i)
    named.emplace_back(theme.palette[i], fmt::format("--s{}", i + 1));
  return named;
}

/// A colour of the light theme by the page's name for it, any other as it is.
std::string paint(const Rgb& rgb) {
  static const std::vector<std::pair<Rgb, std::string>> named = named_colors(plot_theme(Theme::light));
  for (const auto& [color, name] : named)
    if (color == rgb) return fmt::format("var({},{})", name, hex(rgb));
  return hex(rgb);
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

/// A tenth of a CSS pixel: finer than a printer's dot at the size of a small multiple.
std::string pixels(float value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

/// Path commands through the points in steps, which take fewer bytes than places. Steps are of rounded places, so that
/// their rounding does not add up.
std::string path_through(std::span<const Vector2f> points) {
  std::string path;
  Vector2f at = Vector2f::Zero();
  for (const Vector2f& point : points) {
    const Vector2f place = (10.0f * point).array().round() / 10.0f;
    const Vector2f step = place - at;
    path += (path.empty() ? "M" : "l") + pixels(step.x()) + (step.y() < 0.0f ? "" : " ") + pixels(step.y());
    at = place;
  }
  return path;
}

/// Without the points that a straight line misses by less than a twentieth of a pixel: from each point kept, the line
/// goes on as long as one direction meets all points on the way.
std::vector<Vector2f> without_straight(std::span<const Vector2f> points) {
  constexpr float k_tolerance = 0.05f;
  std::vector<Vector2f> kept{points.front()};
  float low = 0.0f, high = 0.0f, reached = 0.0f;  // of the angle against the first step; of the way, 0 before that step
  Vector2f first = Vector2f::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) {
    Vector2f way = points[i] - kept.back();
    if (reached > 0.0f) {
      const float length = way.norm(), reach = length > k_tolerance ? std::asin(k_tolerance / length) : 1.5f;
      const float angle = std::atan2(first.x() * way.y() - first.y() * way.x(), first.dot(way));
      if (low <= angle && angle <= high && length >= reached) {
        low = std::max(low, angle - reach);
        high = std::min(high, angle + reach);
        reached = length;
        continue;
      }
      kept.push_back(points[i - 1]);
      way = points[i] - kept.back();
      reached = 0.0f;
    }
    if (way.norm() <= k_tolerance) continue;  // no step yet: it has no direction
    first = way;
    reached = way.norm();
    high = std::asin(k_tolerance / reached);
    low = -high;
  }
  if (points.size() > 1) kept.push_back(points.back());
  return kept;
}

std::string opacity(const char* of, const Color& color) {
  return color.alpha < 1.0f ? fmt::format(" {}-opacity=\"{:.2f}\"", of, color.alpha) : "";
}

/// The text with its subscripts and superscripts as spans. `size` is that of the text itself.
std::string spans(const std::string& text, float size) {
  std::string result;
  float shift = 0.0f;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool opens = (text[i] == '_' || text[i] == '^') && text.substr(i + 1, 1) == "{";
    if (opens) {
      shift = (text[i] == '_' ? 0.22f : -0.36f) * size;
      result += fmt::format("<tspan dy=\"{}\" font-size=\"{}\">", pixels(shift), pixels(0.72f * size));
      ++i;
    } else if (shift != 0.0f && text[i] == '}') {
      // The base line comes back with whatever follows; an invisible space carries it.
      result += fmt::format("</tspan><tspan dy=\"{}\">&#8203;</tspan>", pixels(-shift));
      shift = 0.0f;
    } else {
      result += escaped(text.substr(i, 1));
    }
  }
  return shift != 0.0f ? result + "</tspan>" : result;
}

}  // namespace

void SvgCanvas::fill(const Box& box, const Color& color) {
  body_ +=
      fmt::format("<path fill=\"{}\"{} d=\"M{} {}h{}v{}h{}z\"/>", paint(color.rgb), opacity("fill", color),
                  pixels(box.left), pixels(box.top), pixels(box.width()), pixels(box.height()), pixels(-box.width()));
}

void SvgCanvas::line(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash) {
  if (points.empty()) return;
  const std::string dashes = dash.period > 0.0f ? fmt::format(" stroke-dasharray=\"{} {}\"", pixels(dash.drawn),
                                                              pixels(dash.period - dash.drawn))
                                                : "";
  body_ += fmt::format("<path class=\"l\" stroke=\"{}\"{} stroke-width=\"{}\"{} d=\"{}\"/>", paint(color.rgb),
                       opacity("stroke", color), pixels(width), dashes, path_through(without_straight(points)));
}

/// Each dot is a line of no length with round ends.
void SvgCanvas::dots(std::span<const Vector2f> points, float diameter, const Color& color) {
  if (points.empty()) return;
  std::string path;
  for (const Vector2f& point : points) path += fmt::format("M{} {}h0", pixels(point.x()), pixels(point.y()));
  body_ += fmt::format("<path class=\"l\" stroke=\"{}\"{} stroke-width=\"{}\" d=\"{}\"/>", paint(color.rgb),
                       opacity("stroke", color), pixels(diameter), path);
}

void SvgCanvas::band(std::span<const Vector3f> points, const Color& color) {
  if (points.size() < 2) return;
  std::vector<Vector2f> outline;
  for (const Vector3f& point : points) outline.emplace_back(point.x(), point.y());
  for (std::size_t i = points.size(); i-- > 0;) outline.emplace_back(points[i].x(), points[i].z());
  body_ +=
      fmt::format("<path fill=\"{}\"{} d=\"{}z\"/>", paint(color.rgb), opacity("fill", color), path_through(outline));
}

void SvgCanvas::image(const Box& box, const Image& picture) {
  const std::vector<std::uint8_t> png = encode_png(picture, 9);
  body_ += fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
      "style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
      pixels(box.left), pixels(box.top), pixels(box.width()), pixels(box.height()),
      base64({reinterpret_cast<const char*>(png.data()), png.size()}));
}

/// An inner picture shows nothing outside its own box, and needs no name as a clip path would.
void SvgCanvas::clip(const Box& box) {
  const std::string place =
      fmt::format("{} {} {} {}", pixels(box.left), pixels(box.top), pixels(box.width()), pixels(box.height()));
  body_ += fmt::format("<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" viewBox=\"{}\">", pixels(box.left),
                       pixels(box.top), pixels(box.width()), pixels(box.height()), place);
}

void SvgCanvas::unclip() { body_ += "</svg>"; }

void SvgCanvas::text(const Vector2f& at, const std::string& text, const TextStyle& style) {
  if (text.empty()) return;
  static constexpr std::array<const char*, 3> k_anchors{"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
  const std::string x = pixels(at.x()), y = pixels(at.y());
  body_ +=
      fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"{}{}{}>{}</text>", x, y, pixels(style.size),
                  paint(style.color.rgb), k_anchors[static_cast<std::size_t>(style.align)],
                  style.bold ? " font-weight=\"bold\"" : "",
                  style.upwards ? fmt::format(" transform=\"rotate(-90 {} {})\"", x, y) : "", spans(text, style.size));
}

float SvgCanvas::text_width(const std::string& text, float size, bool bold) const {
  return lay_out(font_, text, size, bold).width;
}

std::string SvgCanvas::element(const std::string& label) const {
  return fmt::format("<svg class=\"figure\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>",
                     pixels(size_.x()), pixels(size_.y()), escaped(label), body_);
}

std::string draw_svg(const Figure& figure, const std::string& label) {
  SvgCanvas canvas(static_cast<float>(figure.width), static_cast<float>(figure.height));
  draw_on(canvas, figure, Theme::light, 1.0f);
  return canvas.element(label);
}

std::string svg_file(const Figure& figure, Theme theme) {
  SvgCanvas canvas(static_cast<float>(figure.width), static_cast<float>(figure.height));
  draw_on(canvas, figure, Theme::light, 1.0f);
  std::string style =
      "text{font-family:'DejaVu Sans',sans-serif}.l{fill:none;stroke-linecap:round;stroke-linejoin:round}svg{";
  for (const auto& [color, name] : named_colors(plot_theme(theme))) style += fmt::format("{}:{};", name, hex(color));
  std::string picture = canvas.element(figure.title);
  constexpr std::string_view k_start = "<svg ";
  picture.replace(0, k_start.size(),
                  fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" ", figure.width,
                              figure.height));
  return picture.insert(picture.find('>') + 1, "<style>" + style + "}</style>") + "\n";
}

}  // namespace grouser
