#include "model/terrain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "model/errors.h"
#include "model/ground_surface.h"
#include "model/scenario.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

constexpr double k_tread = 2.79;

TEST(GroundSurface, IsAPlaneWithASlope) {
  Terrain terrain;
  terrain.slope = 0.3;
  terrain.cross_slope = -0.1;
  const GroundHeight at = GroundSurface(terrain, k_tread).at(7.0, -2.0);
  EXPECT_DOUBLE_EQ(at.z, 0.3 * 7.0 + 0.1 * 2.0);
  EXPECT_EQ(at.slope_x, 0.3);
  EXPECT_EQ(at.slope_y, -0.1);
}

TEST(GroundSurface, PassesThroughItsProfileWithoutAKink) {
  Terrain terrain;
  GroundProfile profile{{0.0, 0.1, 0.25, 0.3, 0.6}, {{{0.0, 0.02, 0.05, -0.01, 0.03}, {0.1, 0.1, 0.0, 0.2, 0.0}}}};
  terrain.profile = profile;
  const GroundSurface ground(terrain, k_tread);
  for (std::size_t i = 0; i < profile.distance.size(); ++i) {
    const double x = profile.distance[i];
    EXPECT_NEAR(ground.at(x, 1.4).z, profile.height[0][i], 1e-15);
    EXPECT_NEAR(ground.at(x, -1.4).z, profile.height[1][i], 1e-15);
    // Slopes on both sides of a point differ by curvature times 2e-9 m: some 1e3 1/m here.
    EXPECT_NEAR(ground.at(x - 1e-9, 1.4).slope_x, ground.at(x + 1e-9, 1.4).slope_x, 1e-5);
  }
  EXPECT_EQ(ground.at(-5.0, 1.4).z, 0.0);
  EXPECT_EQ(ground.at(5.0, 1.4).z, 0.03);
}

TEST(GroundSurface, StatesTheSlopesOfItsHeights) {
  Terrain terrain;
  terrain.slope = 0.05;
  terrain.road = RandomRoad{'E', 5, -10.0, 40.0};
  terrain.obstacles = {{ObstacleKind::trapezoid, Side::left, 3.0, 0.3, 1.2, 0.4}};
  const GroundSurface ground(terrain, k_tread);
  const double h = 1e-6;  // a central difference errs by h^2 times a third derivative of some 1e3 1/m^2
  for (double x = -9.0; x < 9.0; x += 0.0371) {
    for (const double y : {1.4, 0.2, -0.3, -1.4}) {
      const GroundHeight at = ground.at(x, y);
      EXPECT_NEAR(at.slope_x, (ground.at(x + h, y).z - ground.at(x - h, y).z) / (2.0 * h), 1e-4);
      EXPECT_NEAR(at.slope_y, (ground.at(x, y + h).z - ground.at(x, y - h).z) / (2.0 * h), 1e-4);
    }
  }
}

TEST(GroundSurface, BuildsATrapezoidOnItsSideAlone) {
  Terrain terrain;
  terrain.obstacles = {{ObstacleKind::trapezoid, Side::left, 10.0, 0.3, 1.2, 0.4}};
  const GroundSurface ground(terrain, k_tread);
  EXPECT_NEAR(ground.at(10.0, 1.4).z, 0.3, 1e-15);
  EXPECT_NEAR(ground.at(9.6, 1.4).z, 0.15, 1e-15);  // half way up a ramp of 0.4 m
  EXPECT_NEAR(ground.at(9.6, 1.4).slope_x, 0.75, 1e-15);
  EXPECT_NEAR(ground.at(10.4, 1.4).slope_x, -0.75, 1e-15);
  EXPECT_EQ(ground.at(9.3, 1.4).z, 0.0);
  EXPECT_EQ(ground.at(10.0, -1.4).z, 0.0);
}

TEST(GroundSurface, IsNowhereHigherThanItSaysNearby) {
  Terrain terrain;
  terrain.slope = -0.1;
  terrain.road = RandomRoad{'F', 2, 0.0, 30.0};
  terrain.obstacles = {{ObstacleKind::half_round, {}, 12.0, 0.2}};
  const GroundSurface ground(terrain, k_tread);
  for (double x = -3.0; x < 33.0; x += 0.113) {
    for (double dx = -GroundSurface::k_reach; dx <= GroundSurface::k_reach; dx += 0.05) {
      // Between the places that the table looks at a wave may rise by slope x 5 mm.
      EXPECT_LE(ground.top(x + dx, 1.4), ground.highest_near(x, 1.4) + 2e-3);
    }
  }
}

TEST(GroundSurface, HasFrictionByZoneAndSide) {
  Terrain terrain;
  terrain.friction = 0.7;
  terrain.zones = {{{}, 10.0, 20.0, 0.3}, {Side::left, 15.0, 30.0, 0.1}};
  const GroundSurface ground(terrain, k_tread);
  EXPECT_EQ(ground.friction(9.9, 1.0), 0.7);
  EXPECT_EQ(ground.friction(12.0, 1.0), 0.3);
  EXPECT_EQ(ground.friction(17.0, 1.0), 0.1);
  EXPECT_EQ(ground.friction(17.0, -1.0), 0.3);
  EXPECT_EQ(ground.friction(25.0, -1.0), 0.7);
}

/// Power of a profile in [low, high) [m^2], from its discrete Fourier sums over `length` [m].
double band_power(const std::vector<double>& height, double length, double low, double high) {
  double power = 0.0;
  const auto n = static_cast<double>(height.size());
  for (int m = static_cast<int>(std::ceil(low * length)); m < high * length; ++m) {
    std::complex<double> sum = 0.0;
    const std::complex<double> turn = std::polar(1.0, -2.0 * k_pi * m / n);
    std::complex<double> phase = 1.0;
    for (const double z : height) sum += z * phase, phase *= turn;
    power += 2.0 * std::norm(sum / n);
  }
  return power;
}

TEST(RandomRoad, HasTheSpectrumOfItsClassInEveryOctave) {
  for (const auto& [road_class, seed] : {std::pair{'B', 1u}, {'D', 7u}}) {
    const GroundProfile road = random_profile({road_class, seed, 0.0, 400.0}, k_tread);
    for (const auto& side : road.height) {
      for (double low = 0.0442; low < 2.0; low *= 2.0) {  // octaves of ISO 8608 from the one about 1/16 1/m
        const double wanted =
            road_spectrum(road_class, 1.0) * (1.0 / low - 0.5 / low);  // integral of G_d over the octave
        // Lines 1/400 1/m apart: an octave from 0.044 has 18. Each line's square, a sum of two waves of random phase,
        // scatters by up to 0.7 of its mean, weighted by n^-2: 3 sigma is 0.55 there and falls as the root of 2 an
        // octave. Fading over 10 of 400 m takes 1.6 %.
        const double scatter = 0.55 * std::sqrt(0.0442 / low) + 0.03;
        EXPECT_NEAR(band_power(side, 400.0, low, 2.0 * low) / wanted, 1.0, scatter) << road_class << " " << low;
      }
    }
  }
}

TEST(RandomRoad, FollowsISO8608) {
  EXPECT_DOUBLE_EQ(road_spectrum('A', 0.1), 16e-6);
  EXPECT_DOUBLE_EQ(road_spectrum('D', 0.1), 1024e-6);
  EXPECT_DOUBLE_EQ(road_spectrum('D', 0.2), 256e-6);
}

TEST(RandomRoad, LiftsBothSidesAlikeInLongWavesOnly) {
  const GroundProfile road = random_profile({'C', 3, 0.0, 400.0}, k_tread);
  std::vector<double> mean, half_difference;
  for (std::size_t i = 0; i < road.distance.size(); ++i) {
    mean.push_back(0.5 * (road.height[0][i] + road.height[1][i]));
    half_difference.push_back(0.5 * (road.height[0][i] - road.height[1][i]));
  }
  const auto ratio = [&](double low, double high) {
    return band_power(half_difference, 400.0, low, high) / band_power(mean, 400.0, low, high);
  };
  // (1 - g) / (1 + g) with g = u K_1(u), u = 2 pi n 2.79 m: 0.013 at 0.011 1/m, 1 where waves are short.
  EXPECT_LT(ratio(0.011, 0.02), 0.15);
  // Equal amplitudes there; fading over 10 of 400 m mixes neighbouring lines by chance.
  EXPECT_NEAR(ratio(1.0, 2.0), 1.0, 0.02);
}

TEST(RandomRoad, IsTheSameForTheSameSeed) {
  const RandomRoad road{'D', 11, 5.0, 30.0};
  EXPECT_EQ(random_profile(road, k_tread).height, random_profile(road, k_tread).height);
  EXPECT_NE(random_profile(road, k_tread).height, random_profile({'D', 12, 5.0, 30.0}, k_tread).height);
  EXPECT_EQ(random_profile(road, k_tread).distance.front(), 5.0);
}

class TerrainFile : public testing::Test {
 protected:
  Scenario read(const std::string& terrain) {
    std::string text = read_whole(test_data("scenarios/run_a.json"));
    const std::string old = R"({"friction": 0.7})";
    text.replace(text.find(old), old.size(), terrain);
    const std::string folder = test_data("").string();
    for (std::string::size_type at; (at = text.find("\"../")) != std::string::npos;) text.replace(at, 4, "\"" + folder);
    return read_scenario(folder_.write("scenario.json", text),
                         {"", test_data("broken/good_bushing.json").string(), {}});
  }
  std::string error(const std::string& terrain) {
    try {
      static_cast<void>(read(terrain));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  TemporaryFolder folder_;
};

TEST_F(TerrainFile, SaysEverythingInAnyUnit) {
  folder_.write("course.csv", "distance_m,left_height_mm,right_height_cm\n0,0,0\n1,20,3\n2,0,0\n");
  const Terrain terrain = read(R"({"friction": 0.6, "slope": 0.1, "cross_slope": -0.05, "median_mm": 800,
    "friction_zones": [{"side": "left", "from_m": 1, "to_m": 2, "friction": 0.2}],
    "profile": {"file": "course.csv", "start_m": 30},
    "iso_8608": {"class": "D", "seed": 4, "start_m": 50, "length_km": 0.1},
    "obstacles": [{"kind": "half_round", "radius_mm": 200, "position_m": 12, "side": "right"},
                  {"kind": "trapezoid", "height_cm": 20, "base_m": 1, "top_m": 0.4, "position_m": 15}]})")
                              .terrain;
  EXPECT_EQ(terrain.slope, 0.1);
  EXPECT_EQ(terrain.median, 0.8);
  EXPECT_EQ(terrain.zones.at(0).side, Side::left);
  ASSERT_TRUE(terrain.profile);
  EXPECT_EQ(terrain.profile->distance, (std::vector<double>{30.0, 31.0, 32.0}));
  EXPECT_EQ(terrain.profile->height[0][1], 0.02);
  EXPECT_EQ(terrain.profile->height[1][1], 0.03);
  ASSERT_TRUE(terrain.road);
  EXPECT_EQ(terrain.road->road_class, 'D');
  EXPECT_EQ(terrain.road->length, 100.0);
  EXPECT_EQ(terrain.obstacles.at(0).height, 0.2);
  EXPECT_EQ(terrain.obstacles.at(1).height, 0.2);
  EXPECT_FALSE(terrain.level());
}

TEST_F(TerrainFile, RefusesWhatCannotBeGround) {
  using testing::HasSubstr;
  EXPECT_THAT(error(R"({"slope_percent": 30})"), HasSubstr("/terrain/slope_percent"));
  EXPECT_THAT(error(R"({"iso_8608": {"class": "Z", "seed": 1, "length_m": 50}})"),
              HasSubstr("/terrain/iso_8608/class"));
  EXPECT_THAT(error(R"({"friction_zones": [{"from_m": 3, "to_m": 2, "friction": 0.2}]})"), HasSubstr("beyond from"));
  EXPECT_THAT(
      error(R"({"obstacles": [{"kind": "trapezoid", "height_m": 1, "base_m": 1, "top_m": 1, "position_m": 5}]})"),
      HasSubstr("two ramps"));
  EXPECT_THAT(error(R"({"profile": {"file": "nowhere.csv"}})"), HasSubstr("nowhere.csv"));
  folder_.write("course.csv", "distance_m,height_m\n0,0\n2,1\n1,0\n");
  EXPECT_THAT(error(R"({"profile": {"file": "course.csv"}})"), HasSubstr("strictly increasing"));
  folder_.write("course.csv", "distance_m,left_height_m\n0,0\n2,1\n");
  EXPECT_THAT(error(R"({"profile": {"file": "course.csv"}})"), HasSubstr("right_height_m"));
}

TEST_F(TerrainFile, IsKeptWithItsProfile) {
  folder_.write("course.csv", "distance_m,height_m\n0,0\n1,0.1\n2,0\n");
  const Scenario scenario = read(R"({"profile": {"file": "course.csv", "start_m": 7}})");
  write_inputs(scenario, folder_ / "run");
  const Scenario again = read_scenario(folder_ / "run/inputs/scenario.json");
  EXPECT_EQ(again.terrain.profile->distance, scenario.terrain.profile->distance);
  EXPECT_EQ(again.terrain.profile->height, scenario.terrain.profile->height);
}

TEST(Drive, IsToldByItsColumns) {
  const auto drive = [](std::map<std::string, std::string> set) {
    return read_scenario(test_data("scenarios/coast_down.json"),
                         {"", test_data("broken/good_bushing.json").string(), std::move(set)})
        .drive[0];
  };
  const DriveTable table = drive({{"drive.left.drag_N_m_s_per_rad", "12"}});
  EXPECT_EQ(table.kind, DriveKind::torque);
  EXPECT_EQ(table.torque, (std::vector<double>{0.0, 10e3, 10e3, 0.0}));
  EXPECT_EQ(table.drag, 12.0);
  const Scenario cruise = read_scenario(test_data("scenarios/half_round_20kmh.json"),
                                        {"", test_data("broken/good_bushing.json").string(), {}});
  EXPECT_EQ(cruise.drive[1].kind, DriveKind::cruise);
  EXPECT_DOUBLE_EQ(cruise.drive[1].target_speed.back(), 20.0 / 3.6);
  EXPECT_EQ(cruise.drive[1].power, 400e3);
}

}  // namespace
}  // namespace grouser
