#include <cmath>
#include <random>

#include "model/terrain.h"

namespace grouser {
namespace {

constexpr double k_reference_frequency = 0.1;         // 1/m, n_0 of ISO 8608
constexpr double k_class_a = 16e-6;                   // m^3, G_d(n_0); each class has four times that of the one before
constexpr double k_lowest = 0.011, k_highest = 2.83;  // 1/m
constexpr double k_spacing = 0.05;                    // m, seven points over the shortest wave
constexpr double k_fade = 5.0;                        // m

/// Uniform in [0, 2 pi): the bits are the standard's, so that every machine draws the same.
double phase(std::mt19937_64& random) { return 2.0 * k_pi * static_cast<double>(random() >> 11) * 0x1p-53; }

/// Coherence of two parallel sections of an isotropic surface with spectrum ~ n^-2: u K_1(u), u = 2 pi n tread.
double coherence(double n, double tread) {
  const double u = 2.0 * k_pi * n * tread;
  return u > 500.0 ? 0.0 : u * std::cyl_bessel_k(1.0, u);
}

/// 0 at an end, 1 from 5 m inside, with a level tangent at both.
double fade(double from_end) {
  return from_end >= k_fade ? 1.0 : 0.5 - 0.5 * std::cos(k_pi * std::max(0.0, from_end) / k_fade);
}

}  // namespace

double road_spectrum(char road_class, double n) {
  const double ratio = n / k_reference_frequency;
  return k_class_a * std::pow(4.0, road_class - 'A') / (ratio * ratio);
}

GroundProfile random_profile(const RandomRoad& road, double tread) {
  const auto points = static_cast<std::size_t>(std::floor(road.length / k_spacing)) + 1;
  GroundProfile profile;
  profile.distance.resize(points);
  for (auto& height : profile.height) height.assign(points, 0.0);
  for (std::size_t i = 0; i < points; ++i) profile.distance[i] = road.start + k_spacing * static_cast<double>(i);

  std::mt19937_64 random(road.seed);
  const double dn = 1.0 / road.length;
  for (double n = k_lowest + 0.5 * dn; n < k_highest; n += dn) {
    const double amplitude = std::sqrt(2.0 * road_spectrum(road.road_class, n) * dn), alike = coherence(n, tread);
    const double even = amplitude * std::sqrt(0.5 * (1.0 + alike)), odd = amplitude * std::sqrt(0.5 * (1.0 - alike));
    const double even_phase = phase(random), odd_phase = phase(random);
    for (std::size_t i = 0; i < points; ++i) {
      const double angle = 2.0 * k_pi * n * k_spacing * static_cast<double>(i);
      const double both = even * std::cos(angle + even_phase), apart = odd * std::cos(angle + odd_phase);
      profile.height[0][i] += both + apart;
      profile.height[1][i] += both - apart;
    }
  }
  for (std::size_t i = 0; i < points; ++i) {
    const double along = k_spacing * static_cast<double>(i), share = fade(along) * fade(road.length - along);
    for (auto& height : profile.height) height[i] *= share;
  }
  return profile;
}

}  // namespace grouser
