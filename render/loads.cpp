#include "render/loads.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grouser {
namespace {

constexpr std::size_t k_block_rows = 64;

std::string track_path(std::size_t side) {
  return std::string("/tracks/") + name_of(side == 0 ? Side::left : Side::right);
}

double blend(double a, double b, double weight) { return (1.0 - weight) * a + weight * b; }

}  // namespace

const char* name_of(LoadPartner partner) {
  constexpr std::array<const char*, k_num_load_partners> k_names{"road_wheel", "support_roller", "idler",
                                                                 "sprocket",   "guide",          "ground"};
  return k_names[static_cast<std::size_t>(partner)];
}

LoadReader::LoadReader(const RunFolder& run) : run_(run), time_(run.channels.read("/time").values) {}

void LoadReader::load(std::size_t row) {
  if (row >= block_.first && row + 1 < block_.first + block_.count) return;
  block_.first = row;
  block_.count = std::min(k_block_rows, time_.size() - row);
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const auto rows = [&](const std::string& path) {
      return run_.channels.read_rows(track_path(s) + path, block_.first, block_.count);
    };
    block_.bushing_force[s] = rows("/bushing_force");
    for (std::size_t p = 0; p < k_num_load_partners; ++p)
      block_.contact_force[s][p] = rows(std::string("/contact_force/") + name_of(static_cast<LoadPartner>(p)));
  }
}

TrackLoads LoadReader::sample(std::size_t row) const {
  TrackLoads loads;
  const std::size_t i = row - block_.first;
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    const std::span<const double> bushing = block_.bushing_force[s].row(i);
    for (std::size_t k = 0; k < bushing.size(); k += 3) loads[s].tension.push_back(bushing[k]);
    for (std::size_t p = 0; p < k_num_load_partners; ++p) {
      const std::span<const double> force = block_.contact_force[s][p].row(i);
      for (std::size_t k = 0; k < force.size(); k += 3)
        loads[s].force[p].emplace_back(force[k], force[k + 1], force[k + 2]);
    }
  }
  return loads;
}

TrackLoads LoadReader::at(double time) {
  const double held = std::clamp(time, time_.front(), time_.back());
  const auto after = std::upper_bound(time_.begin(), time_.end(), held);
  const auto next = std::min(static_cast<std::size_t>(after - time_.begin()), time_.size() - 1);
  const std::size_t row = next > 0 ? next - 1 : 0;
  load(row);
  TrackLoads loads = sample(row);
  if (next == row) return loads;
  const TrackLoads ahead = sample(next);
  const double weight = std::clamp((held - time_[row]) / (time_[next] - time_[row]), 0.0, 1.0);
  for (std::size_t s = 0; s < k_num_sides; ++s) {
    for (std::size_t i = 0; i < loads[s].tension.size(); ++i)
      loads[s].tension[i] = blend(loads[s].tension[i], ahead[s].tension[i], weight);
    for (std::size_t p = 0; p < k_num_load_partners; ++p) {
      for (std::size_t i = 0; i < loads[s].force[p].size(); ++i)
        loads[s].force[p][i] = (1.0 - weight) * loads[s].force[p][i] + weight * ahead[s].force[p][i];
    }
  }
  return loads;
}

LoadReader::Range LoadReader::range() {
  Range range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(), 0.0};
  constexpr std::size_t k_rows = 512;
  for (std::size_t first = 0; first < time_.size(); first += k_rows) {
    const std::size_t count = std::min(k_rows, time_.size() - first);
    for (std::size_t s = 0; s < k_num_sides; ++s) {
      const Array bushing = run_.channels.read_rows(track_path(s) + "/bushing_force", first, count);
      for (std::size_t k = 0; k < bushing.values.size(); k += 3) {
        range.least_tension = std::min(range.least_tension, bushing.values[k]);
        range.most_tension = std::max(range.most_tension, bushing.values[k]);
      }
      const Array ground = run_.channels.read_rows(track_path(s) + "/contact_force/ground", first, count);
      for (std::size_t k = 2; k < ground.values.size(); k += 3)
        range.most_ground_load = std::max(range.most_ground_load, ground.values[k]);
    }
  }
  return range;
}

}  // namespace grouser
