#pragma once
#include "simulator/lanes.h"

namespace grouser {

struct SineCosine {
  Lanes sine, cosine;
};

/// Sine and cosine of eight angles [rad] to 2 ulp of 1, for |x| below 1e6: reduced to [-pi/4, pi/4] by a pi/2 in three
/// parts of 33 bits (Cody & Waite 1980), there the polynomials of Sun's fdlibm.
[[nodiscard]] inline SineCosine sine_cosine(const Lanes& x) {
  const Lanes quarter = (x * 6.36619772367581382433e-01).rint();
  const Lanes r = ((x - quarter * 1.57079632673412561417e+00) - quarter * 6.07710050630396597660e-11) -
                  quarter * 2.02226624879595063154e-21;
  const Lanes z = r * r;
  const Lanes sine = r + r * z *
                             (-1.66666666666666324348e-01 +
                              z * (8.33333333332248946124e-03 +
                                   z * (-1.98412698298579493134e-04 +
                                        z * (2.75573137070700676789e-06 +
                                             z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  const Lanes cosine = 1.0 - 0.5 * z +
                       z * z *
                           (4.16666666666666019037e-02 +
                            z * (-1.38888888888741095749e-03 +
                                 z * (2.48015872894767294178e-05 +
                                      z * (-2.75573143513906633035e-07 +
                                           z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)))));
  const Lanes in_turn = quarter - 4.0 * (0.25 * quarter).floor();  // quarter turns: 0, 1, 2 or 3
  const LaneMask odd = 0.5 < in_turn - 2.0 * (0.5 * in_turn).floor();
  const LaneMask sine_falls = 1.5 < in_turn;
  const LaneMask cosine_negative = (in_turn - 1.5).abs() < 1.0;
  const Lanes s = choose(odd, cosine, sine), c = choose(odd, sine, cosine);
  return {choose(sine_falls, -s, s), choose(cosine_negative, -c, c)};
}

}  // namespace grouser
