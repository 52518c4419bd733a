#pragma once
#include <bit>
#include <cstdint>

#include "simulator/lanes.h"

/// Natural logarithm and exponential of eight numbers, after Sun's fdlibm.
namespace grouser {

using LaneBits [[gnu::vector_size(sizeof(Lanes))]] = std::int64_t;

/// ln x to 1 ulp for normal x > 0: x = 2^k (1 + f) with 1 + f in [sqrt(1/2), sqrt 2), ln(1 + f) by the odd series of
/// s = f / (2 + f).
[[nodiscard]] inline Lanes natural_logarithm(const Lanes& x) {
  constexpr std::int64_t k_root_half = 0x3fe6a09e667f3bcd, k_mantissa = 0x000fffffffffffff;
  const LaneBits above = std::bit_cast<LaneBits>(x.values()) - k_root_half;
  const Lanes k = __builtin_convertvector(above >> 52, Lanes::Values);
  const Lanes f = Lanes(std::bit_cast<Lanes::Values>((above & k_mantissa) + k_root_half)) - 1.0;
  const Lanes s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
  const Lanes series = z * (6.666666666666735130e-01 +
                            z * (3.999999999940941908e-01 +
                                 z * (2.857142874366239149e-01 +
                                      z * (2.222219843214978396e-01 +
                                           z * (1.818357216161805012e-01 +
                                                z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01))))));
  return k * 6.93147180369123816490e-01 - ((half - (s * (half + series) + k * 1.90821492927058770002e-10)) - f);
}

/// e^x to 1 ulp for |x| below 700, 1e-304 below that: x = k ln 2 + r with |r| <= ln(2) / 2, e^r by the rational
/// function of r^2.
[[nodiscard]] inline Lanes exp(const Lanes& exponent) {
  const Lanes x = exponent.max(-700.0);
  const Lanes k = (x * 1.44269504088896338700e+00).rint();
  const Lanes high = x - k * 6.93147180369123816490e-01, low = k * 1.90821492927058770002e-10;
  const Lanes r = high - low, z = r * r;
  const Lanes c =
      r -
      z * (1.66666666666666019037e-01 +
           z * (-2.77777777770155933842e-03 +
                z * (6.61375632143793436117e-05 + z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
  const Lanes of_r = 1.0 - ((low - r * c / (2.0 - c)) - high);
  const LaneBits power = __builtin_convertvector(k.values(), LaneBits) << 52;
  return std::bit_cast<Lanes::Values>(std::bit_cast<LaneBits>(of_r.values()) + power);
}

}  // namespace grouser
