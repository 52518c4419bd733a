#include "render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

const Color k_card{{0.06f, 0.07f, 0.09f}, 0.72f}, k_ink{{1.0f, 1.0f, 1.0f}}, k_muted{{0.80f, 0.82f, 0.86f}};

/// Sizes of a card in pixels.
struct CardLayout {
  float text, line, margin, width;
  CardLayout(const Canvas& canvas, float unit, std::span<const Legend> legends)
      : text(std::max(13.5f * unit, 9.0f)), line(1.5f * text), margin(0.8f * text), width(13.0f * text) {
    for (const Legend& legend : legends) {
      width = std::max({width, canvas.text_width(legend.title, text, true), canvas.text_width(legend.note, text)});
      for (const Legend::Key& key : legend.keys) width = std::max(width, line + canvas.text_width(key.text, text));
    }
  }
  [[nodiscard]] float height(const Legend& legend) const {
    const std::size_t lines = 1 + legend.keys.size() + (legend.bar ? 2 : 0) + (legend.note.empty() ? 0 : 1);
    return 2.0f * margin + static_cast<float>(lines) * line - 0.35f * text;
  }
};

void draw_bar(Canvas& canvas, const Legend::Bar& bar, const CardLayout& layout, float left, float top) {
  const int steps = static_cast<int>(layout.width);
  const float height = 0.85f * layout.text;
  for (int i = 0; i < steps; ++i) {
    const double value = bar.scale.low + (bar.scale.high - bar.scale.low) * (i + 0.5) / steps;
    const float x = left + static_cast<float>(i);
    canvas.fill({x, top, x + 1.0f, top + height}, {bar.scale.at(value)});
  }
  const float base = top + height + 1.15f * layout.text;
  const auto number = [&](double share, TextAlign align) {
    const double value = bar.scale.low + share * (bar.scale.high - bar.scale.low);
    canvas.text({left + static_cast<float>(share) * layout.width, base}, fmt::format("{:g}", value / bar.unit),
                {layout.text, k_ink, align, false, false});
  };
  number(0.0, TextAlign::left);
  number(0.5, TextAlign::center);
  number(1.0, TextAlign::right);
}

void draw_card(Canvas& canvas, const Legend& legend, const CardLayout& layout, float left, float top) {
  canvas.fill({left - layout.margin, top, left + layout.width + layout.margin, top + layout.height(legend)}, k_card);
  float base = top + layout.margin + layout.text;
  canvas.text({left, base}, legend.title, {layout.text, k_ink, TextAlign::left, true, false});
  for (const Legend::Key& key : legend.keys) {
    base += layout.line;
    const float top_of_key = base - 0.75f * layout.text, rim = std::max(1.0f, 0.08f * layout.text);
    canvas.fill({left, top_of_key, left + 0.9f * layout.text, base + 0.1f * layout.text}, k_muted);
    canvas.fill({left + rim, top_of_key + rim, left + 0.9f * layout.text - rim, base + 0.1f * layout.text - rim},
                {key.color});
    canvas.text({left + layout.line, base}, key.text, {layout.text, k_ink, TextAlign::left, false, false});
  }
  if (legend.bar) {
    draw_bar(canvas, *legend.bar, layout, left, base + 0.6f * layout.text);
    base += 2.0f * layout.line;
  }
  if (!legend.note.empty())
    canvas.text({left, base + layout.line}, legend.note, {layout.text, k_muted, TextAlign::left, false, false});
}

std::vector<Rgb> colors(std::initializer_list<unsigned> values) {
  std::vector<Rgb> list;
  for (const unsigned value : values) {
    const auto part = [value](unsigned shift) { return static_cast<float>((value >> shift) & 0xFFU) / 255.0f; };
    list.push_back({part(16), part(8), part(0)});
  }
  return list;
}

}  // namespace

Rgb ColorScale::at(double value) const {
  const double u = std::clamp((value - low) / (high - low), 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(u), stops.size() - 2);
  const auto weight = static_cast<float>(u - static_cast<double>(k));
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = (1.0f - weight) * stops[k][c] + weight * stops[k + 1][c];
  return color;
}

std::vector<Rgb> viridis() {
  return colors({0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725});
}

std::vector<Rgb> yellow_to_red() {
  return colors({0xffeda0, 0xfed976, 0xfeb24c, 0xfd8d3c, 0xfc4e2a, 0xe31a1c, 0xbd0026, 0x800026});
}

void draw_legends(Canvas& canvas, std::span<const Legend> legends, float unit) {
  const CardLayout layout(canvas, unit, legends);
  const float gap = std::round(16.0f * unit);
  const float left = std::round(gap + layout.margin);
  float top = gap;
  for (const Legend& legend : legends) {
    draw_card(canvas, legend, layout, left, top);
    top += std::round(layout.height(legend)) + std::round(0.5f * gap);
  }
}

}  // namespace grouser
