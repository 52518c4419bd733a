#include "model/ground_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/spline.h"

namespace grouser {
namespace {

/// Half the length over which a ramp's slope sets in [m]: an edge of 20 mm, as concrete and earth have.
constexpr double k_edge = 0.02;
constexpr double k_cell = 0.1;     // m, of the table of highest places
constexpr double k_far = 1e3;      // m beside the median, where only one course is
constexpr double k_sample = 0.01;  // m, between the places that it looks at

/// max(0, t) with the corner replaced by a parabola over |t| < k_edge, and its derivative.
struct Ramp {
  double value, slope;
};
Ramp ramp(double t) {
  if (t <= -k_edge) return {0.0, 0.0};
  if (t >= k_edge) return {t, 1.0};
  return {(t + k_edge) * (t + k_edge) / (4.0 * k_edge), (t + k_edge) / (2.0 * k_edge)};
}

/// Share of the left course at y: 0 right of the median, 1 left of it, C1.
Ramp left_share(double y, double half_median) {
  const double t = std::clamp(0.5 + 0.5 * y / half_median, 0.0, 1.0);
  return {t * t * (3.0 - 2.0 * t), 3.0 * t * (1.0 - t) / half_median};
}

}  // namespace

ProfileCurve::ProfileCurve(std::vector<double> distance, std::vector<double> height)
    : distance_(std::move(distance)), height_(std::move(height)), slope_(fritsch_carlson_slopes(distance_, height_)) {
  slope_.front() = slope_.back() = 0.0;  // level beyond the ends, so level at them
  const auto intervals = static_cast<int>(distance_.size()) - 1;
  cells_per_metre_ = intervals / (distance_.back() - distance_.front());
  int interval = 0;
  for (int c = 0; c <= intervals; ++c) {
    const double x = distance_.front() + c / cells_per_metre_;
    while (interval + 1 < intervals && x >= distance_[static_cast<std::size_t>(interval) + 1]) ++interval;
    cell_interval_.push_back(interval);
  }
}

void ProfileCurve::add(double x, double& z, double& slope) const {
  if (x <= distance_.front()) return void(z += height_.front());
  if (x >= distance_.back()) return void(z += height_.back());
  auto i =
      static_cast<std::size_t>(cell_interval_[static_cast<std::size_t>((x - distance_.front()) * cells_per_metre_)]);
  while (x > distance_[i + 1]) ++i;
  while (x < distance_[i]) --i;  // a product that rounds up to the next cell
  const double width = distance_[i + 1] - distance_[i], secant = (height_[i + 1] - height_[i]) / width;
  const double c2 = (3.0 * secant - 2.0 * slope_[i] - slope_[i + 1]) / width;
  const double c3 = (slope_[i] + slope_[i + 1] - 2.0 * secant) / (width * width), u = x - distance_[i];
  z += height_[i] + u * (slope_[i] + u * (c2 + u * c3));
  slope += slope_[i] + u * (2.0 * c2 + u * 3.0 * c3);
}

GroundSurface::GroundSurface(const Terrain& terrain, double tread)
    : level_(terrain.level()),
      slope_(terrain.slope),
      cross_slope_(terrain.cross_slope),
      half_median_(0.5 * terrain.median),
      friction_(terrain.friction),
      zones_(terrain.zones) {
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  const auto reaches = [&](double from, double to) { begin = std::min(begin, from), end = std::max(end, to); };
  const auto add_profile = [&](const GroundProfile& profile) {
    for (std::size_t s = 0; s < k_num_sides; ++s) curves_[s].emplace_back(profile.distance, profile.height[s]);
    reaches(profile.distance.front(), profile.distance.back());
  };
  if (terrain.profile) add_profile(*terrain.profile);
  if (terrain.road) add_profile(random_profile(*terrain.road, tread));
  for (const Obstacle& o : terrain.obstacles) {
    const double half = o.kind == ObstacleKind::trapezoid ? 0.5 * o.base + k_edge : o.height;
    reaches(o.position - half, o.position + half);
    if (o.kind != ObstacleKind::trapezoid) continue;
    const double length = 0.5 * (o.base - o.top);
    banks_.push_back({o.position, 0.5 * o.base, length, o.height / length, o.side});
  }
  if (begin < end) begin_ = begin, end_ = end;
  for (const Obstacle& o : terrain.obstacles) {
    if (o.kind != ObstacleKind::half_round) continue;
    const double y = o.side == Side::right ? -k_far : k_far;
    const GroundHeight foot = at(o.position, y);
    half_rounds_.push_back({o.position, o.height, foot.z - cross_slope_ * y, cross_slope_, o.side});
  }
  tabulate_highest();
}

void GroundSurface::course(Side side, double x, double& z, double& slope) const {
  for (const ProfileCurve& curve : curves_[static_cast<std::size_t>(index_of(side))]) curve.add(x, z, slope);
  for (const Bank& bank : banks_) {
    if (!covers(bank.side, side)) continue;
    const double from_middle = x - bank.position, inside = bank.half_base - std::abs(from_middle);
    if (inside <= -k_edge) continue;
    const Ramp up = ramp(inside), over = ramp(inside - bank.ramp);
    z += bank.slope * (up.value - over.value);
    slope -= std::copysign(bank.slope * (up.slope - over.slope), from_middle);
  }
}

GroundHeight GroundSurface::at(double x, double y) const {
  GroundHeight ground{slope_ * x + cross_slope_ * y, slope_, cross_slope_};
  if (begin_ == end_) return ground;
  const Ramp left = left_share(y, half_median_);
  double z_left = 0.0, slope_left = 0.0, z_right = 0.0, slope_right = 0.0;
  if (left.value > 0.0) course(Side::left, x, z_left, slope_left);
  if (left.value < 1.0) course(Side::right, x, z_right, slope_right);
  ground.z += left.value * z_left + (1.0 - left.value) * z_right;
  ground.slope_x += left.value * slope_left + (1.0 - left.value) * slope_right;
  ground.slope_y += left.slope * (z_left - z_right);
  return ground;
}

double GroundSurface::zoned_friction(double x, double y) const {
  double friction = friction_;
  for (const FrictionZone& zone : zones_) {
    if (x >= zone.from && x < zone.to && covers(zone.side, side_of(y))) friction = zone.friction;
  }
  return friction;
}

double GroundSurface::top(double x, double y) const {
  double z = at(x, y).z;
  for (const HalfRound& round : half_rounds_) {
    const double from_axis = x - round.x;
    if (std::abs(from_axis) >= round.radius || !covers(round.side, side_of(y))) continue;
    const double up = std::sqrt(round.radius * round.radius - from_axis * from_axis);
    z = std::max(z, round.z + round.slope_y * y + up);
  }
  return z;
}

/// The highest of both sides counts for both: it only has to be safe.
void GroundSurface::tabulate_highest() {
  if (begin_ == end_) return;
  const auto bare = [&](double x, double y) { return top(x, y) - slope_ * x - cross_slope_ * y; };
  const double first = begin_ - 2.0 * k_reach, last = end_ + 2.0 * k_reach;
  const auto cells = static_cast<std::size_t>(std::ceil((last - first) / k_cell));
  std::vector<double> own(cells, -std::numeric_limits<double>::infinity());
  for (std::size_t c = 0; c < cells; ++c) {
    for (double x = first + k_cell * static_cast<double>(c), to = x + 1.5 * k_cell; x < to; x += k_sample) {
      own[c] = std::max({own[c], bare(x, k_far), bare(x, -k_far)});
    }
  }
  const auto reach = static_cast<std::size_t>(std::ceil(k_reach / k_cell)) + 1;
  for (std::size_t c = 0; c < cells; ++c) {
    const auto from = own.begin() + static_cast<std::ptrdiff_t>(c > reach ? c - reach : 0);
    const auto to = own.begin() + static_cast<std::ptrdiff_t>(std::min(cells, c + reach + 1));
    highest_.push_back(*std::max_element(from, to));
  }
}

double GroundSurface::highest_near(double x, double y) const {
  const double plane = slope_ * x + cross_slope_ * y + k_reach * (std::abs(slope_) + std::abs(cross_slope_));
  if (highest_.empty()) return plane;
  const double cell = (x - begin_ + 2.0 * k_reach) / k_cell;
  const auto last = static_cast<double>(highest_.size() - 1);
  return plane + highest_[static_cast<std::size_t>(std::clamp(cell, 0.0, last))];
}

}  // namespace grouser
