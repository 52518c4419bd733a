#include <cmath>

#include "tests/support/closed_forms.h"
#include "tests/support/pulled_pair.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

/// Loss of the second cycle [J].
double loss_of_cycle(const Bushing& bushing, double amplitude, int steps) {
  PulledPair pair(bushing);
  const auto cycle = [&] {
    for (int i = 1; i <= steps; ++i) pair.step(amplitude * std::sin(2.0 * k_pi * i / steps), 0.0, 1e-4);
  };
  cycle();  // the first one starts in the middle of the elastic range
  pair.step_loss = 0.0;
  cycle();
  return pair.step_loss;
}

void add_stops(Chapter& chapter) {
  chapter.section("Friction stops",
                  "A joint pulled to and fro along the track, +-0.4 mm, by the kernel that a vehicle's run uses.");
  constexpr double k = 2e7, yield = 1e-4, amplitude = 4e-4;
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).stops = {{k, yield}};
  const double area = 4.0 * k * yield * (amplitude - yield);
  chapter.add({"loss of a cycle in 40 steps", "J", area, loss_of_cycle(bushing, amplitude, 40),
               fraction(1e-11, area, "round-off: the update is exact"), "closed form: 4 k r (X - r)"});
  chapter.add({"loss of a cycle below the yield", "J", 0.0, loss_of_cycle(bushing, 0.99 * yield, 100),
               within(1e-12, "round-off"), "closed form: nothing slips"});
  const std::vector<FrictionStop> stops{{1e7, 5e-5}, {5e6, 1e-4}, {3e6, 2e-4}};
  bushing.axis(Axis::x).stops = stops;
  const auto first_loading = [&](double x) {
    double f = 0.0;
    for (const FrictionStop& stop : stops) f += stop.stiffness * std::min(x, stop.yield);
    return f;
  };
  PulledPair pair(bushing);
  for (int i = 1; i <= 300; ++i) pair.step(-amplitude * i / 300.0, 0.0, 1e-4);
  Worst masing{-first_loading(amplitude), pair.force()};
  for (int i = 1; i <= 600; ++i) {
    const double x = -amplitude + 2.0 * amplitude * i / 600.0;
    pair.step(x, 0.0, 1e-4);
    masing = worse(masing, {-first_loading(amplitude) + 2.0 * first_loading(0.5 * (x + amplitude)), pair.force()});
  }
  chapter.add({"three stops, force along the way back", "N", masing.reference, masing.measured,
               within(1e-6, "round-off of 1 kN"), "Masing 1926: the first loading doubled"});
  constexpr double growth = 1.0 / (amplitude * amplitude);  // the yield doubles at the turn
  bushing.axis(Axis::x).stops = {{k, yield}};
  bushing.axis(Axis::x).yield_growth = growth;
  const double growing = growing_stop_area(k, yield, growth, amplitude);
  // The pair's other joint, two pitches from its groove, slips nowhere with such a yield: all the loss is of this one.
  chapter.add({"yield that grows with strain: loss of a cycle in 4000 steps", "J", growing,
               2.0 * loss_of_cycle(bushing, amplitude, 4000),
               fraction(2.5e-6, growing, "(2 pi / 4000)²: the step in which slip begins"),
               "closed form: 2 k (integral of r dx - r²/2) from the onset of slip to the turn"});
}

void add_branches(Chapter& chapter) {
  constexpr double k = 1e7, tau = 2e-3, c = k * tau, amplitude = 2e-4;
  chapter.section("Maxwell branches",
                  "One branch of 1e7 N/m and 2 ms, shaken at 0.2 mm in 2000 steps a cycle until it is steady, and held "
                  "after a sudden stretch.");
  Bushing bushing = no_bushing();
  bushing.axis(Axis::x).branches = {{k, tau}};
  const char* stiffness = "closed form: K* = i w c / (1 + i w c / k)";
  for (const double frequency : {1.0, 10.0, 71.6, 500.0}) {
    const double omega = 2.0 * k_pi * frequency, wt = omega * tau, size = k * wt / std::sqrt(1.0 + wt * wt);
    const Harmonic at = shake(bushing, omega, amplitude, 2000);
    std::string name = std::to_string(frequency);
    name = name.substr(0, frequency == 71.6 ? 4 : name.find('.')) + " Hz: ";
    const double loss = k_pi * c * omega * amplitude * amplitude / (1.0 + wt * wt);
    chapter.add({name + "loss of a cycle", "J", loss, at.loss,
                 fraction(3e-6, loss, "(2 pi / 2000)² / 12: constant rate within a step"),
                 "closed form: pi c w X² / (1 + (w c / k)²)"});
    const char* because = "the polygon's harmonics fold back into its samples";
    chapter.add({name + "storage stiffness", "N/m", k * wt * wt / (1.0 + wt * wt), at.in_phase,
                 fraction(1e-4, size, because), stiffness});
    chapter.add({name + "loss stiffness", "N/m", k * wt / (1.0 + wt * wt), at.out_of_phase,
                 fraction(1e-4, size, because), stiffness});
  }
  PulledPair pair(bushing);
  constexpr double x = 1e-4;
  pair.step(x, 0.0, 1e-12);
  for (int i = 0; i < 100; ++i) pair.step(x, 0.0, 5e-5);
  chapter.add({"force 5 ms after a stretch by 0.1 mm", "N", k * x * std::exp(-2.5), pair.force(),
               within(1e-6, "the stretch took 1e-12 s"), "closed form: k x exp(-t / tau), exact for any step"});
  chapter.add({"loss until then", "J", 0.5 * k * x * x * (1.0 - std::exp(-5.0)), pair.step_loss,
               within(1e-7, "round-off of a stretch in 1e-12 s"), "closed form: k x² (1 - exp(-2 t / tau)) / 2"});
}

}  // namespace

void add_bushings(Chapter& chapter) {
  add_stops(chapter);
  add_branches(chapter);
}

}  // namespace grouser::validation
