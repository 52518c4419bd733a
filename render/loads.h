#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/geometry.h"
#include "model/run.h"

namespace grouser {

/// Who pushes on a link, in the order of /tracks/<side>/contact_force/.
enum class LoadPartner { road_wheel, support_roller, idler, sprocket, guide, ground };
inline constexpr std::size_t k_num_load_partners = 6;
[[nodiscard]] const char* name_of(LoadPartner partner);

/// Loads of the links of one side at one time.
struct SideLoads {
  std::vector<double> tension;  ///< N, at the joint ahead of each link, > 0 when it pulls
  std::array<std::vector<Vector3d>, k_num_load_partners> force;  ///< N, on each link in W
};
using TrackLoads = std::array<SideLoads, k_num_sides>;

/// Loads of a run by time, read in blocks.
class LoadReader {
 public:
  /// The run must outlive the reader.
  explicit LoadReader(const RunFolder& run);

  /// Interpolated between samples, held at the ends.
  [[nodiscard]] TrackLoads at(double time);
  [[nodiscard]] const std::vector<double>& times() const { return time_; }

  /// Extremes over the run and both sides.
  struct Range {
    double least_tension = 0.0, most_tension = 0.0;  ///< N
    double most_ground_load = 0.0;                   ///< N, vertical, under one link
  };
  [[nodiscard]] Range range();

 private:
  struct Block {
    std::size_t first = 0, count = 0;
    std::array<Array, k_num_sides> bushing_force;
    std::array<std::array<Array, k_num_load_partners>, k_num_sides> contact_force;
  };
  void load(std::size_t row);
  [[nodiscard]] TrackLoads sample(std::size_t row) const;

  const RunFolder& run_;
  std::vector<double> time_;
  Block block_;
};

}  // namespace grouser
