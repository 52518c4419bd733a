#include "tests/support/chains.h"

#include <cmath>
#include <stdexcept>

#include "tests/support/closed_forms.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

constexpr double k_stiffness = 1e8;  // N/m, of elastic_bushing() along x and z
const Vector3d k_place(0.0, 20.0, 10.0);

void add_momentum(Chapter& chapter) {
  chapter.section(
      "A free chain keeps its momentum",
      "A closed chain of 24 links turning at 3 rad/s, every link with a random velocity on top, no gravity and no "
      "contact, for 0.2 s. Angular momentum about the chain's own middle. Errors in h², steps of 50 and 25 us.");
  const ChainDrift rubber = drift_of(rubber_bushing(), 5e-5);
  chapter.add({"change of linear momentum, the whole law of the rubber", "N s", 0.0, rubber.linear,
               fraction(1e-12, rubber.linear_scale, "round-off of 4000 steps"), "closed form: no outer force"});
  const ChainDrift coarse = drift_of(viscous_bushing(), 5e-5), fine = drift_of(viscous_bushing(), 2.5e-5);
  chapter.add({"change of angular momentum, springs and dampers", "N m s", 0.0, fine.angular,
               fraction(1e-5, fine.angular_scale, "the integrator's h² at 25 us"), "closed form: no outer moment"});
  const char* order = "Chung & Lee 1994, IJNME 37:3961: second order";
  chapter.add({"order of the change of angular momentum", "", 2.0, std::log2(coarse.angular / fine.angular),
               within(0.2, "joints ring at kHz, the h³ term is seen"), order});
  chapter.add({"order of the energy residual", "", 2.0, std::log2(coarse.energy / fine.energy),
               within(0.2, "joints ring at kHz, the h³ term is seen"), order});
}

void add_hoop(Chapter& chapter) {
  constexpr int n = 76;
  constexpr double spin = 5.0;
  chapter.section("Tension of a spinning polygon",
                  "A closed chain of 76 links turning at 5 rad/s (11.7 m/s), free in space, joints of "
                  "1e8 N/m.");
  const SpinningPolygon polygon(n, spin, 5e-5);
  const CompiledTrack& track = polygon.system.tracks[0];
  const char* form =
      "closed form: m w² p / (4 sin(pi/N) tan(pi/N)), divided by 1 - m w² / (4 k sin²(pi/N)) for the stretch";
  Stepper stepper(polygon.system, polygon.start, {});
  chapter.add({"link's acceleration against the centripetal one", "m/s²", 0.0,
               polygon.centripetal_error(stepper.acceleration()), within(1e-5, "a gap 1 km up is known to 1e-13 m"),
               form});
  double mean = 0.0;
  int samples = 0;
  while (stepper.state().time < 0.5 * k_pi / spin) {
    if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the polygon failed");
    mean += get_vector(stepper.work().joint_force_W, samples % n).norm();
    ++samples;
  }
  chapter.add({"mean joint force over a quarter of a turn", "N", polygon.force, mean / samples,
               fraction(1e-5, polygon.force, "h² at 50 us"), form});
  const double v = spin * n * track.pitch / (2.0 * k_pi);
  chapter.add({"the same against rho v² of a thin hoop", "N", track.mass / track.pitch * v * v, mean / samples,
               fraction(2e-3, polygon.force, "links of finite length 0.03 %, stretch 0.10 %"),
               "closed form: rho v², v = w N p / 2 pi"});
}

/// Nothing but springs that pull along and across, so that a joint bends freely.
Bushing pin_joint() {
  Bushing bushing = elastic_bushing();
  bushing.axis(Axis::ry).spring = SpringSpline::linear(0.0, 1.0);
  return bushing;
}

/// n free links in line between two held ones, stretched to `tension` [N].
HeldChain taut_row(int n, double tension, double gravity) {
  HeldChain chain(n + 2, pin_joint(), {0, n + 1}, gravity);
  const double step = chain.system.tracks[0].pitch + tension / k_stiffness;
  for (int i = 0; i <= n + 1; ++i) set_link(chain.state, i, {k_place + Vector3d(i * step, 0.0, 0.0)});
  return chain;
}

void add_catenary(Chapter& chapter) {
  chapter.section(
      "A chain hangs between two held links",
      "Eight links, joints of 1e8 N/m that bend freely, pins as far apart as a straight chain of 50.1 or 100.3 kN "
      "would be; relaxed to rest.");
  constexpr int n = 8;
  for (const double tension : {50.1e3, 100.3e3}) {
    HeldChain chain = taut_row(n, tension, 9.81);
    const CompiledTrack& track = chain.system.tracks[0];
    chain.relax(1e-4, 60.0, 1e-6);
    const double weight = track.mass * 9.81, span = n * track.pitch + (n + 1) * tension / k_stiffness;
    const double known = hanging_chain_force(n, track.pitch, weight, k_stiffness, span, 2.0 * tension);
    const double found = std::abs(chain.joint_force(0).x());
    const LinkMotion middle = chain.link(n / 2);
    const double sag = k_place.z() - (middle.position + middle.orientation * Vector3d(0.5 * track.pitch, 0.0, 0.0)).z();
    const std::string name = tension < 60e3 ? "50 kN: " : "100 kN: ";
    const char* polygon = "closed form: rigid links along the mean of their joints' forces, gaps force / k";
    chapter.add({name + "horizontal force", "N", known, found, fraction(1e-6, known, "relaxed to 1e-6 m/s²"), polygon});
    const HangingChain exact = hanging_chain(n, track.pitch, weight, k_stiffness, known);
    chapter.add({name + "sag", "mm", 1e3 * exact.sag, 1e3 * sag,
                 fraction(1e-5, 1e3 * exact.sag, "relaxed to 1e-6 m/s²"), polygon});
    const double per_length = weight / (track.pitch + tension / k_stiffness);
    const double catenary = 1e3 * catenary_sag(span, known, per_length);
    chapter.add({name + "sag against a catenary", "mm", catenary, 1e3 * sag,
                 fraction(3e-3, catenary, "gaps are weightless, one more than links"),
                 "closed form: a (cosh(L/2a) - 1), a = H/w"});
  }
}

/// Frequency [rad/s] of a coordinate that starts at zero upwards, by its upward passages of zero.
class ZeroPassages {
 public:
  void see(double time, double value) {
    if (last_ < 0.0 && value >= 0.0) {
      const double at = last_time_ + (time - last_time_) * last_ / (last_ - value);
      if (count_ == 0) first_ = at;
      latest_ = at;
      ++count_;
    }
    last_ = value;
    last_time_ = time;
  }
  [[nodiscard]] double frequency() const { return 2.0 * k_pi * (count_ - 1) / (latest_ - first_); }

 private:
  int count_ = 0;
  double last_ = 0.0, last_time_ = 0.0, first_ = 0.0, latest_ = 0.0;
};

/// One transverse mode through the program's integrator, steps of 0.01 rad.
double run_transverse(int n, double tension, const TautChain& linear, int mode) {
  HeldChain chain = taut_row(n, tension, 0.0);
  const Eigen::VectorXd shape = linear.mode.col(mode),
                        start = 1e-5 * linear.frequency[mode] * shape / shape.cwiseAbs().maxCoeff();
  for (int i = 1; i <= n; ++i) {
    LinkMotion link = chain.link(i);
    link.velocity.z() = start[i - 1];
    link.angular_velocity.y() = -start[n + i - 1];
    set_link(chain.state, i, link);
  }
  ZeroPassages passages;
  const CompiledTrack& track = chain.system.tracks[0];
  chain.chung_lee(0.01 / linear.frequency[mode], 6 * 630, [&] {
    double coordinate = 0.0;
    for (int i = 1; i <= n; ++i) {
      const LinkMotion link = chain.link(i);
      const double slope = (link.orientation * Vector3d::UnitX()).z();
      coordinate +=
          track.mass * shape[i - 1] * (link.position.z() - k_place.z()) + track.inertia.y() * shape[n + i - 1] * slope;
    }
    passages.see(chain.state.time, coordinate);
  });
  return passages.frequency();
}

double run_longitudinal(int n, int mode, double frequency) {
  HeldChain chain = taut_row(n, 0.0, 0.0);
  const double step = chain.system.tracks[0].pitch;
  const auto shape = [&](int i) { return std::sin(k_pi * mode * i / (n + 1)); };
  for (int i = 1; i <= n; ++i) {
    LinkMotion link = chain.link(i);
    link.velocity.x() = 1e-5 * frequency * shape(i);
    set_link(chain.state, i, link);
  }
  ZeroPassages passages;
  chain.chung_lee(0.01 / frequency, 6 * 630, [&] {
    double coordinate = 0.0;
    for (int i = 1; i <= n; ++i) coordinate += shape(i) * (chain.link(i).position.x() - k_place.x() - i * step);
    passages.see(chain.state.time, coordinate);
  });
  return passages.frequency();
}

void add_frequencies(Chapter& chapter) {
  chapter.section(
      "Vibration of a span",
      "Links in line between two held ones, set moving in one mode with an amplitude of 10 um; frequency from the "
      "passages of zero over six periods. Across: eight links under 100.3 kN. Along: 37 links, which have the "
      "frequencies of a closed row of 76.");
  constexpr int n = 8;
  constexpr double tension = 100.3e3;
  const CompiledTrack track = taut_row(n, tension, 0.0).system.tracks[0];
  const TautChain linear = taut_chain(n, track.pitch, track.mass, track.inertia.y(), tension, k_stiffness);
  const double first = run_transverse(n, tension, linear, 0), last = run_transverse(n, tension, linear, 2 * n - 1);
  const char* model = "eigenvalues of the linear model: rigid links with height and slope, springs, tension";
  const char* steps = "0.01 rad a step: period error 2e-6";
  chapter.add({"across, lowest mode", "Hz", linear.frequency[0] / (2.0 * k_pi), first / (2.0 * k_pi),
               fraction(1e-5, linear.frequency[0] / (2.0 * k_pi), steps), model});
  const double span = n * track.pitch + (n + 1) * tension / k_stiffness;
  const double string = std::sqrt(tension * (track.pitch + tension / k_stiffness) / track.mass) / (2.0 * span);
  chapter.add({"across, lowest mode, against a string", "Hz", string, first / (2.0 * k_pi),
               fraction(0.01, string, "links turn as rigid bodies: (pi/n)² (1/6 - I/m p²)/2 = 0.7 %"),
               "closed form: c / 2L, c² = T/rho"});
  chapter.add({"across, highest mode (links pitch)", "rad/s", linear.frequency[2 * n - 1], last,
               fraction(1e-5, linear.frequency[2 * n - 1], steps), model});
  chapter.add({"across, highest mode, against the endless chain", "rad/s",
               std::sqrt(k_stiffness * track.pitch * track.pitch / track.inertia.y()), last,
               fraction(0.02, last, "held ends, tension"), "closed form: sqrt(k p² / I_y), all links pitching alike"});
  for (const int mode : {1, 10, 37}) {
    const double known = longitudinal_frequency(37, mode, k_stiffness, track.mass);
    chapter.add({"along, mode " + std::to_string(mode), "rad/s", known, run_longitudinal(37, mode, known),
                 fraction(1e-5, known, steps), "closed form: 2 sqrt(k/m) sin(j pi/76)"});
  }
}

void add_wave(Chapter& chapter) {
  chapter.section("A wave along the chain",
                  "150 links in line; a pulse of Gaussian shape, eight links wide (standard deviation), started to run "
                  "one way; speed of "
                  "the middle of its kinetic energy over 70 links.");
  constexpr int n = 150;
  constexpr double width = 8.0, begin = 40.0;
  HeldChain chain = taut_row(n, 0.0, 0.0);
  const CompiledTrack& track = chain.system.tracks[0];
  const double c = track.pitch * std::sqrt(k_stiffness / track.mass);  // m/s
  for (int i = 1; i <= n; ++i) {
    const double x = (i - begin) / width, bump = 1e-4 * std::exp(-0.5 * x * x);
    LinkMotion link = chain.link(i);
    link.position.x() += bump;
    link.velocity.x() = c / track.pitch * x / width * bump;
    set_link(chain.state, i, link);
  }
  const auto middle = [&] {
    double sum = 0.0, weight = 0.0;
    for (int i = 1; i <= n; ++i) {
      const double energy = chain.link(i).velocity.squaredNorm();
      sum += i * energy, weight += energy;
    }
    return track.pitch * sum / weight;
  };
  const double start = middle();
  constexpr double h = 2e-5;
  const int steps = static_cast<int>(70.0 * track.pitch / c / h);
  chain.chung_lee(h, steps);
  // Group velocity c cos(kappa/2), weighted by the pulse's spectrum kappa^2 exp(-kappa^2 width^2): mean of kappa^2 is 3
  // / (2 width^2).
  chapter.add({"speed of the pulse", "m/s", c, (middle() - start) / (steps * h),
               fraction(5e-3, c, "dispersion of a pulse this long: 3 / (16 width²) = 0.3 %"),
               "closed form: p sqrt(k/m)"});
  const double dispersed = c * (1.0 - 3.0 / (16.0 * width * width));
  chapter.add({"speed of the pulse, with its dispersion", "m/s", dispersed, (middle() - start) / (steps * h),
               fraction(1e-4, c, "next term of the group velocity"),
               "closed form: p sqrt(k/m) cos(kappa/2), mean over the pulse's spectrum"});
}

}  // namespace

void add_chains(Chapter& chapter) {
  add_momentum(chapter);
  add_hoop(chapter);
  add_catenary(chapter);
  add_frequencies(chapter);
  add_wave(chapter);
}

}  // namespace grouser::validation
