#include "model/terrain_reader.h"

#include <algorithm>
#include <sstream>

#include "model/csv.h"

namespace grouser {
namespace {

namespace d = dimension;

GroundSide read_side(ObjectReader& r) {
  if (!r.has("side")) return std::nullopt;
  return r.choice<GroundSide>("side", {{"both", std::nullopt}, {"left", Side::left}, {"right", Side::right}});
}

FrictionZone read_zone(ObjectReader& r) {
  FrictionZone zone;
  zone.side = read_side(r);
  zone.from = r.quantity("from", d::length);
  zone.to = r.quantity("to", d::length);
  zone.friction = r.number("friction", Range::non_negative);
  if (zone.to <= zone.from) r.report(r.key_of("to"), "a place beyond from", shown(Json(zone.to)) + " m");
  return zone;
}

RandomRoad read_road(ObjectReader& r) {
  RandomRoad road;
  constexpr std::array<std::pair<const char*, char>, 8> k_classes{
      {{"A", 'A'}, {"B", 'B'}, {"C", 'C'}, {"D", 'D'}, {"E", 'E'}, {"F", 'F'}, {"G", 'G'}, {"H", 'H'}}};
  road.road_class = r.choice<char>("class", {k_classes[0], k_classes[1], k_classes[2], k_classes[3], k_classes[4],
                                             k_classes[5], k_classes[6], k_classes[7]});
  road.seed = static_cast<std::uint64_t>(r.integer("seed", 0));
  road.start = r.quantity_or("start", d::length, road.start);
  road.length = r.quantity("length", d::length, Range::positive);
  constexpr double k_least = 20.0, k_most = 5000.0;  // m; the work to make one grows with the square
  if (road.length < k_least) {
    r.report(r.key_of("length"), "20 m or more: 5 m at each end lead in and out", shown(Json(road.length)) + " m");
  }
  if (road.length > k_most) r.report(r.key_of("length"), "5000 m or less", shown(Json(road.length)) + " m");
  return road;
}

Obstacle read_obstacle(ObjectReader& r) {
  Obstacle o;
  o.kind = r.choice<ObstacleKind>("kind",
                                  {{"half_round", ObstacleKind::half_round}, {"trapezoid", ObstacleKind::trapezoid}});
  o.side = read_side(r);
  o.position = r.quantity("position", d::length);
  if (o.kind == ObstacleKind::half_round) {
    o.height = r.quantity("radius", d::length, Range::positive);
    return o;
  }
  constexpr double k_least = 0.08;  // m, of a ramp and of the top: room for the rounding of their edges
  o.height = r.quantity("height", d::length, Range::positive);
  o.base = r.quantity("base", d::length, Range::positive);
  o.top = r.quantity("top", d::length, Range::positive);
  if (o.top < k_least) r.report(r.key_of("top"), "0.08 m or more", shown(Json(o.top)) + " m");
  if (o.base < o.top + 2.0 * k_least) {
    r.report(r.key_of("base"), "0.16 m or more beyond top: two ramps of 0.08 m", shown(Json(o.base)) + " m");
  }
  return o;
}

/// The column `name`_unit of a table; empty when there is none.
std::string length_column(const CsvReader& table, const std::string& name) {
  for (const std::string& column : table.names()) {
    const auto split = split_name_and_unit(column);
    if (split && split->name == name && split->unit.dimension == d::length) return column;
  }
  return {};
}

std::vector<double> in_metres(const CsvColumn& column) {
  const Unit unit = split_name_and_unit(column.name)->unit;
  std::vector<double> values = column.values;
  for (double& value : values) value = unit.to_si(value);
  return values;
}

}  // namespace

TerrainEntry read_terrain(ObjectReader& r) {
  TerrainEntry entry;
  Terrain& terrain = entry.terrain;
  terrain.friction = r.number_or("friction", terrain.friction, Range::non_negative);
  terrain.slope = r.number_or("slope", terrain.slope);
  terrain.cross_slope = r.number_or("cross_slope", terrain.cross_slope);
  terrain.median = r.quantity_or("median", d::length, terrain.median, Range::positive);
  r.each_optional("friction_zones", [&](ObjectReader& zone) { terrain.zones.push_back(read_zone(zone)); });
  r.optional_object("profile", [&](ObjectReader& profile) {
    entry.profile_file = profile.file_name("file");
    entry.profile_start = profile.quantity_or("start", d::length, 0.0);
  });
  r.optional_object("iso_8608", [&](ObjectReader& road) { terrain.road = read_road(road); });
  r.each_optional("obstacles", [&](ObjectReader& o) { terrain.obstacles.push_back(read_obstacle(o)); });
  return entry;
}

GroundProfile read_ground_profile(const std::string& bytes, double start, Findings& findings) {
  GroundProfile profile;
  std::istringstream in(bytes);
  CsvReader table(in, findings);
  if (!findings.empty()) return profile;
  const std::string distance = length_column(table, "distance"), both = length_column(table, "height");
  const std::string left = both.empty() ? length_column(table, "left_height") : both;
  const std::string right = both.empty() ? length_column(table, "right_height") : both;
  if (distance.empty() || left.empty() || right.empty()) {
    std::string found;
    for (const std::string& name : table.names()) found += (found.empty() ? "" : ", ") + name;
    findings.add(
        table.place_of_names(),
        "columns distance_m and height_m, or distance_m, left_height_m and right_height_m (any unit of length)", found);
    return profile;
  }
  std::vector<std::string> wanted{distance, left};
  if (both.empty()) wanted.push_back(right);
  const std::vector<CsvColumn> columns = table.read(wanted);
  if (!findings.empty()) return profile;
  profile.distance = in_metres(columns[0]);
  for (double& x : profile.distance) x += start;
  profile.height = {in_metres(columns[1]), in_metres(columns.back())};
  if (profile.distance.size() < 2) findings.add("column " + distance, "at least two rows", "fewer");
  const auto back = std::adjacent_find(profile.distance.begin(), profile.distance.end(), std::greater_equal<>());
  if (back != profile.distance.end()) {
    findings.add("column " + distance, "strictly increasing values",
                 shown(Json(*(back + 1) - start)) + " m after " + shown(Json(*back - start)) + " m");
  }
  return profile;
}

}  // namespace grouser
