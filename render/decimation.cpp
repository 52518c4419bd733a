#include "render/decimation.h"

#include <algorithm>
#include <cmath>

namespace grouser {
namespace {

constexpr double k_far = 3e4;     ///< pixels; beyond, float coordinates lose the pixel
constexpr float k_apart = 0.35f;  ///< pixels
constexpr float k_parts = 3.0f;   ///< of a pixel column: strokes at 1/6, 1/2, 5/6 cover it as any number would
constexpr double k_dense = 12.0;  ///< points a pixel column from which M4 saves anything

using Points = std::vector<Vector2f>;

Points thin_columns(const Points& points) {
  Points kept;
  for (std::size_t i = 0; i < points.size();) {
    const float column = std::floor(k_parts * points[i].x());
    std::size_t first = i, low = i, high = i, last = i;
    for (; i < points.size() && std::floor(k_parts * points[i].x()) == column; ++i) {
      if (points[i].y() < points[low].y()) low = i;
      if (points[i].y() > points[high].y()) high = i;
      last = i;
    }
    for (const std::size_t k : {first, std::min(low, high), std::max(low, high), last}) {
      const Vector2f point((column + 0.5f) / k_parts, points[k].y());
      if (kept.empty() || kept.back() != point) kept.push_back(point);
    }
  }
  return kept;
}

Points thin_distances(const Points& points) {
  Points kept{points.front()};
  for (const Vector2f& p : points) {
    if ((p - kept.back()).norm() > k_apart) kept.push_back(p);
  }
  if (kept.size() == 1 && points.size() > 1) kept.push_back(points.back());
  return kept;
}

}  // namespace

Vector2f PlotFrame::pixel(double px, double py) const {
  const double u = box.left + x.share(px) * static_cast<double>(box.width());
  const double v = box.bottom - y.share(py) * static_cast<double>(box.height());
  return {static_cast<float>(std::clamp(u, -k_far, k_far)), static_cast<float>(std::clamp(v, -k_far, k_far))};
}

std::vector<std::vector<Vector2f>> pixel_pieces(std::span<const double> x, std::span<const double> y,
                                                const PlotFrame& frame, bool steps) {
  std::vector<Points> pieces(1);
  const std::size_t count = std::min(x.size(), y.size());
  const auto drawable = [](const PlotAxis& axis, double value) {
    return std::isfinite(value) && (!axis.logarithmic || value > 0.0);
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (!drawable(frame.x, x[i]) || !drawable(frame.y, y[i])) {
      if (!pieces.back().empty()) pieces.emplace_back();
      continue;
    }
    const Vector2f p = frame.pixel(x[i], y[i]);
    if (steps && !pieces.back().empty()) pieces.back().emplace_back(p.x(), pieces.back().back().y());
    pieces.back().push_back(p);
  }
  if (pieces.back().empty()) pieces.pop_back();
  for (Points& piece : pieces) {
    const bool sorted =
        std::is_sorted(piece.begin(), piece.end(), [](const Vector2f& a, const Vector2f& b) { return a.x() < b.x(); });
    const double columns = std::max(1.0, static_cast<double>(piece.back().x() - piece.front().x()));
    if (!sorted) piece = thin_distances(piece);
    if (sorted && static_cast<double>(piece.size()) > k_dense * columns) piece = thin_columns(piece);
  }
  return pieces;
}

}  // namespace grouser
