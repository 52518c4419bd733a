#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "model/errors.h"
#include "render/scene.h"
#include "render/terrain_mesh.h"
#include "reports/encode.h"
#include "reports/number_text.h"
#include "reports/pages.h"

namespace grouser {
namespace {

using nlohmann::json;

/// Enough frames for smooth play, few enough for the page: 30 a second for a long run, up to 60 for a short one.
double frame_rate(double duration) { return std::clamp(600.0 / std::max(duration, 1e-3), 30.0, 60.0); }

constexpr double k_rotation_step = 1.0 / 16000.0;  ///< of a quaternion's component: 0.1 mm at a wheel's rim

/// Pose of one instance at every frame: position from the chassis origin [m] and quaternion x, y, z, w, as columns.
using PoseColumns = std::array<std::vector<double>, 7>;

void append_pose(const Eigen::Matrix4f& X_WB, const Vector3d& origin, PoseColumns& track) {
  const Matrix3d rotation = X_WB.topLeftCorner<3, 3>().cast<double>();
  Quaterniond q(rotation);
  q.normalize();
  // Of q and -q the one nearer to the frame before, so that differences stay small.
  if (!track[3].empty()) {
    const Eigen::Vector4d before(track[3].back(), track[4].back(), track[5].back(), track[6].back());
    if (q.coeffs().dot(before) < 0.0) q.coeffs() *= -1.0;
  }
  const Vector3d position = X_WB.topRightCorner<3, 1>().cast<double>() - origin;
  for (std::size_t k = 0; k < 3; ++k) track[k].push_back(position[static_cast<Eigen::Index>(k)]);
  for (std::size_t k = 0; k < 4; ++k) track[k + 3].push_back(q.coeffs()[static_cast<Eigen::Index>(k)]);
}

/// Whole steps, and of these the differences from frame to frame (16 bits, wrapping): what gzip likes best.
void append_differences(const std::vector<double>& values, double step, std::vector<std::int16_t>& out) {
  std::int32_t before = 0;
  for (const double value : values) {
    const auto now = static_cast<std::int32_t>(std::lround(value / step));
    out.push_back(static_cast<std::int16_t>(static_cast<std::uint16_t>(now - before)));
    before = now;
  }
}

/// Vertex and index arrays of all meshes, equal meshes (the wheels of all stations) kept once.
struct Geometry {
  std::vector<float> vertices;  ///< position, normal, colour, gloss
  std::vector<std::uint32_t> indices;
  json meshes = json::array();

  std::size_t add(const Mesh& mesh) {
    std::vector<float> own;
    for (const Vertex& v : mesh.vertices)
      for (const float value : {v.position.x(), v.position.y(), v.position.z(), v.normal.x(), v.normal.y(),
                                v.normal.z(), v.color.x(), v.color.y(), v.color.z(), v.gloss})
        own.push_back(value);
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      const std::size_t first = 10 * meshes[k]["first_vertex"].get<std::size_t>();
      if (meshes[k]["num_vertices"] == mesh.vertices.size() && meshes[k]["num_indices"] == mesh.indices.size() &&
          std::memcmp(vertices.data() + first, own.data(), own.size() * sizeof(float)) == 0)
        return k;
    }
    meshes.push_back({{"first_vertex", vertices.size() / 10},
                      {"num_vertices", mesh.vertices.size()},
                      {"first_index", indices.size()},
                      {"num_indices", mesh.indices.size()}});
    vertices.insert(vertices.end(), own.begin(), own.end());
    indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
    return meshes.size() - 1;
  }
};

double rounded(double value) { return std::round(1e4 * value) / 1e4; }
json rounded(const Vector3d& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

/// A run's poses frame by frame, gathered for the page.
class Recording {
 public:
  /// The first frame says which meshes stand where; the others only move them.
  void add(const VehiclePose& pose, const Scene& placed) {
    if (tracks_.empty()) describe(pose, placed);
    Vector3d kept;  // as the page will know it, so that rounding does not shake the vehicle
    for (Eigen::Index k = 0; k < 3; ++k) {
      kept[k] = rounded(pose.chassis.position[k]);
      origin_.push_back(kept[k]);
    }
    std::size_t body = 0;
    for (const std::vector<Instance>& mesh : placed.instances)
      for (const Instance& instance : mesh) append_pose(instance.X_WB, kept, tracks_[body++]);
  }

  [[nodiscard]] std::size_t num_bodies() const { return tracks_.size(); }

  [[nodiscard]] json facts(double start, double rate) const {
    double furthest = 1.0;
    for (const PoseColumns& track : tracks_)
      for (std::size_t k = 0; k < 3; ++k)
        for (const double value : track[k]) furthest = std::max(furthest, std::abs(value));
    const double position_step = furthest / 32000.0;
    std::vector<std::int16_t> differences;
    for (const PoseColumns& track : tracks_)
      for (std::size_t k = 0; k < track.size(); ++k)
        append_differences(track[k], k < 3 ? position_step : k_rotation_step, differences);
    json scene = scene_;
    scene.update({{"rate", rate},
                  {"start", start},
                  {"frames", origin_.size() / 3},
                  {"bodies", tracks_.size()},
                  {"position_step", position_step},
                  {"rotation_step", k_rotation_step},
                  {"origin", origin_},
                  {"meshes", geometry_.meshes}});
    return {{"payload_scene", script_json(scene)},
            {"payload_vertices", packed(std::span<const float>(geometry_.vertices))},
            {"payload_indices", packed(std::span<const std::uint32_t>(geometry_.indices))},
            {"payload_poses", packed(std::span<const std::int16_t>(differences))}};
  }

 private:
  void describe(const VehiclePose& pose, const Scene& placed) {
    const Eigen::Vector2d half = placed.footprint.half.cast<double>();
    scene_ = {{"focus", rounded(Vector3d(placed.shadow_center.cast<double>() - pose.chassis.position))},
              {"reach", rounded(static_cast<double>(placed.shadow_radius))},
              {"footprint", {rounded(half.x()), rounded(half.y())}},
              {"instances", json::array()}};
    json& instances = scene_["instances"];
    for (std::size_t m = 0; m < placed.instances.size(); ++m) {
      if (placed.instances[m].empty()) continue;
      const std::size_t mesh = geometry_.add((*placed.meshes)[m].shape);
      for (const Instance& instance : placed.instances[m]) {
        const Eigen::Vector4f& t = instance.tint;
        instances.push_back({{"mesh", mesh}, {"body", instances.size()}, {"tint", {t.x(), t.y(), t.z(), t.w()}}});
      }
    }
    tracks_.resize(instances.size());
  }

  Geometry geometry_;
  std::vector<PoseColumns> tracks_;
  std::vector<double> origin_;
  json scene_;
};

/// Ground that is not level: its grid's x, y and heights one after the other; `false` for the plane z = 0.
json packed_terrain(const RunFolder& run) {
  const Terrain& terrain = run.scenario.terrain;
  if (terrain.level()) return false;
  const double tread = run.vehicle.side(Side::left).track_center_y - run.vehicle.side(Side::right).track_center_y;
  const TerrainGrid grid = terrain_grid(terrain, tread);
  std::vector<float> values{static_cast<float>(grid.x.size()), static_cast<float>(grid.y.size())};
  for (const std::vector<double>* part : {&grid.x, &grid.y, &grid.height})
    for (const double value : *part) values.push_back(static_cast<float>(rounded(value)));
  return packed(std::span<const float>(values));
}

}  // namespace

json playback_facts(const RunFolder& run) {
  if (!run.channels.has("/chassis/position") || run.channels.read_column("/time", {}).size() < 2) return false;
  PoseReader poses(run);
  const VehicleModel model(run.vehicle, run.scenario.output.probes);
  const double start = poses.first_time(), rate = frame_rate(poses.last_time() - start);
  const auto num_frames = static_cast<std::size_t>(std::floor((poses.last_time() - start) * rate + 1e-6)) + 1;
  Recording recording;
  for (std::size_t frame = 0; frame < num_frames; ++frame) {
    const VehiclePose pose = poses.at(start + static_cast<double>(frame) / rate);
    recording.add(pose, model.place(pose));
  }
  json facts = recording.facts(start, rate);
  facts["payload_terrain"] = packed_terrain(run);
  facts["frames_text"] = fmt::format("{} poses a second of {} parts", number_text(rate, 3), recording.num_bodies());
  return facts;
}

}  // namespace grouser
