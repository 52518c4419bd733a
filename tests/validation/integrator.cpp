#include "simulator/integrator.h"

#include <array>
#include <cmath>
#include <random>

#include "tests/support/chains.h"
#include "tests/support/closed_forms.h"
#include "tests/support/scalar_run.h"
#include "tests/support/tops.h"
#include "tests/support/tree_references.h"
#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

constexpr double k_beta = 28.0 / 27.0;
constexpr const char* k_method = "Chung & Lee 1994, IJNME 37:3961";

/// Order of convergence between the errors at two steps, the coarse one `ratio` times the fine one.
double order_of(double coarse, double fine, double ratio = 2.0) { return std::log(coarse / fine) / std::log(ratio); }

void add_spectrum(Chapter& chapter) {
  chapter.section(
      "One free oscillator: spectrum of a step",
      "Roots of the step as the program weighs it, on u'' + 2 xi w u' + w² u = 0 with W = w h. The closed forms "
      "follow from the characteristic polynomial E³ + [b W² + 3 xi W - 2] E² + [1 + (2 - 2 b) W² - 4 xi W] E + "
      "(b - 1) W² + xi W, b = beta.");
  Worst limit, damping, period, radius;
  for (const double beta : {1.0, 1.02, k_beta}) {
    for (const double xi : {0.0, 0.01, 0.05, 0.2, 0.5, 1.0, 5.0}) {
      const double known = (std::sqrt(xi * xi + beta - 0.75) - xi) / (beta - 0.75);
      limit = worse(limit, {known, stability_limit(beta, xi, 1.0, 0.5 * known, 1.1 * known)});
    }
  }
  chapter.add({"largest stable W for three beta and seven xi", "", limit.reference, limit.measured,
               within(1e-6, "growth is seen from 1e-9 a step"),
               std::string(k_method) + "; closed form [sqrt(xi² + b - 3/4) - xi] / (b - 3/4), root E = -1"});
  // |E|, algorithmic damping and period error at beta = 28/27, undamped.
  struct Known {
    double W, radius, damping, period;
  };
  for (const Known& known :
       {Known{0.1, 0.99999815, 1.85006e-5, -2.3264e-4}, Known{0.2, 0.99997046, 1.47584e-4, -9.4446e-4},
        Known{0.4, 0.99953095, 1.16821e-3, -3.9982e-3}, Known{0.8, 0.99263209, 9.06365e-3, -1.9468e-2},
        Known{1.2, 0.96220501, 3.02466e-2, -5.7497e-2}, Known{1.5, 0.89978776, 6.20258e-2, -1.1722e-1},
        Known{1.8, 0.69606330, 1.43628e-1, -2.7897e-1}}) {
    const Amplification a = amplification(k_beta, 0.0, known.W);
    radius = worse(radius, {known.radius, a.radius});
    damping = worse(damping, {known.damping, a.damping});
    period = worse(period, {known.period, a.period_error});
  }
  const char* roots = "roots of the characteristic polynomial by an independent program (Python), 5 to 8 digits";
  chapter.add(
      {"|E| at W = 0.1 to 1.8", "", radius.reference, radius.measured, within(1e-8, "digits of the table"), roots});
  chapter.add({"algorithmic damping at W = 0.1 to 1.8", "", damping.reference, damping.measured,
               within(1e-6, "digits of the table"), roots});
  chapter.add({"relative period error at W = 0.1 to 1.8", "", period.reference, period.measured,
               within(1e-5, "digits of the table"), roots});
  const Amplification small = amplification(k_beta, 0.0, 0.02);
  chapter.add({"period error / W² as W tends to 0", "", (12.0 * k_beta - 13.0) / 24.0, small.period_error / 4e-4,
               fraction(1e-3, (12.0 * k_beta - 13.0) / 24.0, "next term, W² = 4e-4"), "closed form (12 b - 13) / 24"});
  chapter.add({"algorithmic damping / W³ as W tends to 0", "", 0.5 * (k_beta - 1.0), small.damping / 8e-6,
               fraction(1e-3, k_beta - 1.0, "next term, W² = 4e-4"), "closed form (b - 1) / 2"});
  Worst joined;
  for (const double rho : {0.9, 0.8, 0.7, 0.6}) {
    const double beta = 1.0 + rho * rho * (1.0 - rho) / std::pow(1.0 + rho, 3);
    joined = worse(joined, {rho, amplification(beta, 0.0, std::sqrt(std::pow(1.0 + rho, 3) / (2.0 * rho))).radius});
  }
  chapter.add({"|E| where two roots meet, beta = 1 + r² (1 - r) / (1 + r)³, r from 0.6 to 0.9", "", joined.reference,
               joined.measured, within(1e-6, "a double root is known to the root of round-off"),
               std::string(k_method) + "; closed form -r at W² = (1 + r)³ / 2r"});
  const double bifurcation = std::sqrt(27.0 / 8.0);
  chapter.add({"|E| where all three roots meet, W = sqrt(27/8)", "", 0.5,
               amplification(k_beta, 0.0, bifurcation).radius,
               within(1e-4, "a triple root is known to the cube root of round-off"),
               std::string(k_method) + "; closed form -1/2, beta = 28/27"});
}

void add_alternating_steps(Chapter& chapter) {
  chapter.section("One free oscillator: steps in turn h, h / R",
                  "Largest stable W of the longer step, by the spectral radius of two steps of the slope form.");
  constexpr std::array<double, 6> k_ratio{1.05, 1.10, 1.25, 1.5, 2.0, 3.0};
  struct Known {
    double beta, damping;
    std::array<double, 6> limit;
  };
  const std::vector<Known> table{{1.0, 0.0, {1.411, 1.408, 1.406, 1.411, 1.427, 1.458}},
                                 {k_beta, 0.0, {1.910, 1.422, 1.404, 1.401, 1.411, 1.436}},
                                 {k_beta, 0.02, {1.840, 1.878, 1.403, 1.394, 1.403, 1.429}},
                                 {k_beta, 0.10, {1.587, 1.620, 1.697, 1.446, 1.405, 1.420}}};
  for (const Known& known : table) {
    Worst worst;
    for (std::size_t i = 0; i < k_ratio.size(); ++i)
      worst = worse(worst, {known.limit[i], stability_limit(known.beta, known.damping, k_ratio[i], 1.0, 2.1)});
    const char* beta = known.beta == 1.0 ? "1" : "28/27";
    chapter.add({"beta " + std::string(beta) + ", xi " +
                     (known.damping == 0.0   ? "0"
                      : known.damping < 0.05 ? "0.02"
                                             : "0.1") +
                     ": six R from 1.05 to 3",
                 "", worst.reference, worst.measured, within(2e-3, "digits of the table"),
                 "monodromy matrix by an independent program (Python), 3 to 4 digits"});
  }
}

void add_exact_trajectories(Chapter& chapter) {
  chapter.section(
      "One free oscillator: exact trajectories",
      "w = 1, u = 1, v = 0 at the start, h = 0.1: the numbers that the formulas give in rational arithmetic.");
  const char* source = "rational arithmetic of an independent program (Python), 16 digits";
  const auto run = [&](double beta, double damping, const std::vector<double>& steps) {
    ScalarRun oscillator(
        beta, [damping](double, double u, double v) { return -2.0 * damping * v - u; }, 1.0, 0.0);
    for (const double h : steps) oscillator.step(h);
    return vector_of({oscillator.u, oscillator.v});
  };
  const auto add = [&](const char* quantity, double beta, double damping, const std::vector<double>& steps,
                       const Eigen::VectorXd& known) {
    const Worst worst = worst_of(run(beta, damping, steps), known);
    chapter.add({quantity, "", worst.reference, worst.measured,
                 within(2e-15 * static_cast<double>(steps.size()) + 1e-14, "round-off"), source});
  };
  const auto same = [](std::size_t n) { return std::vector<double>(n, 0.1); };
  add("6 steps, beta 1", 1.0, 0.0, same(6), vector_of({0.8251942694005, -0.5667569329925}));
  add("6 steps, beta 28/27", k_beta, 0.0, same(6), vector_of({0.8252387226519330, -0.5667638324654404}));
  add("6 steps, beta 28/27, xi 0.05", k_beta, 0.05, same(6), vector_of({0.8286051452707935, -0.5504229437967891}));
  add("1000 steps, beta 1", 1.0, 0.0, same(1000), vector_of({0.8826849673165413, 0.4719448904978930}));
  add("1000 steps, beta 28/27", k_beta, 0.0, same(1000), vector_of({0.8722622521941948, 0.4873899628592685}));
  add("variable steps 0.1 0.1 0.05 0.05 0.1 0.2", k_beta, 0.0, {0.1, 0.1, 0.05, 0.05, 0.1, 0.2},
      vector_of({0.8259933149895188, -0.5677512421401999}));
}

const Oscillator k_driven{2.0 * k_pi, 0.05, 3.0, 1.7 * k_pi, 1.0, 0.5};

/// Largest errors (u, v) over 4 s of the driven oscillator, its steps given as parts of 4 s.
Eigen::Vector2d driven_errors(const std::vector<double>& steps) {
  ScalarRun run(
      k_beta, [](double t, double u, double v) { return k_driven.acceleration(t, u, v); }, k_driven.u0, k_driven.v0);
  Eigen::Vector2d worst = Eigen::Vector2d::Zero();
  for (const double h : steps) {
    run.step(h);
    const auto [u, v] = k_driven.at(run.t);
    worst = worst.cwiseMax(Eigen::Vector2d(std::abs(run.u - u), std::abs(run.v - v)));
  }
  return worst;
}

std::vector<double> random_steps(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.5, 1.0);
  std::vector<double> steps(static_cast<std::size_t>(count));
  double sum = 0.0;
  for (double& h : steps) sum += h = part(random);
  for (double& h : steps) h *= 4.0 / sum;
  return steps;
}

/// Mean error of the speed of rebound over where in a step the touch-down falls: 28 kg on f = k d (1 + a d'), W = w h.
double rebound_error(double W) {
  constexpr double mass = 28.0, k = 2e7, a = 0.5;
  const double h = W / std::sqrt(k / mass);
  const auto force = [&](double, double u, double v) {
    return u < 0.0 ? std::max(0.0, -k * u * (1.0 - a * v)) / mass : 0.0;
  };
  constexpr double restitution = 0.7484349;  // (1 + e) a v = ln[(1 + a v) / (1 - e a v)] at a v = 0.5
  double sum = 0.0;
  constexpr int k_phases = 40;
  for (int i = 0; i < k_phases; ++i) {
    ScalarRun run(k_beta, force, h * (3.0 + (i + 0.5) / k_phases), -1.0);
    while (run.u <= 0.0 || run.v < 0.0) run.step(h);
    for (int after = 0; after < 3; ++after) run.step(h);  // f_{n-1} of the contact still counts
    sum += std::abs(run.v - restitution);
  }
  return sum / k_phases;
}

void add_orders(Chapter& chapter) {
  chapter.section(
      "One driven oscillator and one bouncing mass: order",
      "u'' + 2 (0.05)(2 pi) u' + (2 pi)² u = 3 cos(1.7 pi t) over 4 s; and 28 kg falling at 1 m/s on a contact "
      "f = k d (1 + a d'), error of the rebound over 40 phases of touch-down.");
  const auto same = [](int n) { return std::vector<double>(static_cast<std::size_t>(n), 4.0 / n); };
  const auto in_turn = [](int n) {
    std::vector<double> steps;
    for (int i = 0; i < n / 2; ++i) steps.insert(steps.end(), {8.0 / n / 3.0, 16.0 / n / 3.0});
    return steps;
  };
  const char* table = "independent program (Python), 3 to 4 digits";
  const Eigen::Vector2d at_800 = driven_errors(same(800)), at_6400 = driven_errors(same(6400));
  chapter.add({"largest error of u with 800 equal steps", "", 1.618e-4, at_800.x(),
               fraction(2e-3, 1.618e-4, "digits of the table"), table});
  chapter.add({"largest error of v with 6400 equal steps", "", 2.954e-5, at_6400.y(),
               fraction(2e-3, 2.954e-5, "digits of the table"), table});
  const auto add_order = [&](const char* quantity, double order, double limit, const char* because) {
    chapter.add({quantity, "", 2.0, order, within(limit, because), std::string(k_method) + ": second order"});
  };
  add_order("order with equal steps", order_of(driven_errors(same(3200)).x(), at_6400.x()), 0.02,
            "the h³ term at 6400 steps");
  add_order("order with steps in turn h, 2 h",
            order_of(driven_errors(in_turn(3200)).x(), driven_errors(in_turn(6400)).x()), 0.05,
            "the h³ term at 6400 steps");
  double coarse = 0.0, fine = 0.0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    coarse += driven_errors(random_steps(1600, seed)).x();
    fine += driven_errors(random_steps(6400, 100 + seed)).x();
  }
  add_order("order with random steps of 1 : 2, ten seeds", order_of(coarse, fine, 4.0), 0.05, "scatter of ten seeds");
  add_order("order through touch-down, W = 0.05 to 0.0125", order_of(rebound_error(0.05), rebound_error(0.0125), 4.0),
            0.2, "the force has a kink at touch-down, met at any phase of a step");
}

/// Embedded estimate over the true local error of one step h, the step before h / r: velocity, displacement.
Eigen::Vector2d estimate_over_error(double h, double r) {
  constexpr double t0 = 0.37;  // s, where neither f' nor f'' is near zero
  const auto force = [](double t) {
    const auto [u, v] = k_driven.at(t);
    return k_driven.acceleration(t, u, v);
  };
  const auto [u, v] = k_driven.at(t0);
  const auto [end_u, end_v] = k_driven.at(t0 + h);
  const double before = force(t0 - h / r), now = force(t0);
  const StepWeights w = step_weights(k_beta, h, h / r);
  const double next_u = u + h * v + w.position_now * now + w.position_before * before;
  const double next_v = v + w.velocity_now * now + w.velocity_before * before;
  const double next = k_driven.acceleration(t0 + h, next_u, next_v);
  const ErrorWeights e = error_weights(k_beta, h, h / r);
  return {e.velocity * std::abs(next - now - e.ratio * (now - before)) / std::abs(end_v - next_v),
          e.position * std::max(e.ratio * std::abs(now - before), std::abs(next - now)) / std::abs(end_u - next_u)};
}

void add_estimates(Chapter& chapter) {
  chapter.section(
      "One driven oscillator: embedded error estimates",
      "The estimate that chooses the step, over the true error of that step, at h = 1.25 ms of the oscillator "
      "above and for steps that follow one of h / r.");
  for (const double r : {0.5, 1.0, 2.0}) {
    const Eigen::Vector2d ratio = estimate_over_error(0.00125, r);
    const std::string name = r == 0.5 ? "r = 0.5: " : r == 1.0 ? "r = 1: " : "r = 2: ";
    const char* because = "linear in h: 2 pi h = 0.8 %";
    chapter.add({name + "velocity", "", 1.0, ratio.x(), within(0.01, because),
                 "closed form: (1/6 + 1/4r) h³ f'', the estimate h (2r + 3) / (6 + 6r) times the bend of f"});
    chapter.add({name + "displacement", "", 1.0, ratio.y(), within(0.02, because),
                 "closed form: (2/3 - b) h³ f', the estimate |b - 2/3| h² times the change of f"});
  }
}

/// Swinging garland of `num_links` between two held links, in gravity, smooth bushings.
HeldChain garland() {
  constexpr int n = 12;
  HeldChain chain(n + 2, viscous_bushing(), {0, n + 1}, 9.81);
  const double pitch = chain.system.tracks[0].pitch, sagging = 0.35;
  // A regular arc from link 0 to link n + 1, which lean inwards.
  Vector3d pin(0.0, 20.0, 10.0);
  for (int i = 0; i <= n + 1; ++i) {
    const double slope = sagging * (1.0 - 2.0 * i / (n + 1.0));
    const Quaterniond q(Eigen::AngleAxisd(slope, Vector3d::UnitY()));
    const Vector3d half = q * Vector3d(0.5 * pitch, 0.0, 0.0);
    set_link(chain.state, i, {pin + half, q});
    pin += 2.0 * half;
  }
  chain.relax(1e-4, 30.0, 1e-6);
  for (int i = 1; i <= n; ++i) {  // swing sideways and up, at rest at the ends
    const double part = std::pow(std::sin(k_pi * i / (n + 1.0)), 2);
    LinkMotion link = chain.link(i);
    link.velocity = part * Vector3d(0.3, 1.0, 0.5);
    set_link(chain.state, i, link);
  }
  return chain;
}

void add_reference_integrators(Chapter& chapter) {
  chapter.section(
      "A swinging chain against other integrators",
      "Twelve links between two held ones, hung in gravity, thrown sideways and up at 1 m/s; stiffening bushings "
      "with dampers, no friction. Distance after 20 ms, links' places and half a pitch times their turn, to a "
      "Runge-Kutta solution of fourth order at 5 us.");
  const HeldChain start = garland();
  constexpr double k_duration = 0.02;
  const auto run = [&](void (HeldChain::*method)(double, int), int steps) {
    HeldChain chain = start;
    (chain.*method)(k_duration / steps, steps);
    return chain;
  };
  const HeldChain exact = run(&HeldChain::runge_kutta, 4000);
  const auto error = [&](void (HeldChain::*method)(double, int), int steps) {
    return distance(run(method, steps), exact);
  };
  void (HeldChain::*chung_lee)(double, int) = &HeldChain::chung_lee;
  const double coarse = error(chung_lee, 500), fine = error(chung_lee, 1000);
  chapter.add({"Chung-Lee at 20 us: distance to Runge-Kutta", "m", 0.0, fine,
               within(1e-7, "its h² term, of 20 mm moved"), "Kutta 1901; Munthe-Kaas 1998 for rotations"});
  chapter.add({"Chung-Lee at 40 and 20 us: order", "", 2.0, order_of(coarse, fine), within(0.1, "next term"),
               std::string(k_method) + ": second order"});
  const double implicit_coarse = error(&HeldChain::trapezoidal, 500), implicit = error(&HeldChain::trapezoidal, 1000);
  chapter.add({"implicit trapezoidal rule at 20 us: distance to Runge-Kutta", "m", 0.0, implicit,
               within(1e-7, "its h² term, of 20 mm moved"), "Newmark 1959; Bruels & Cardona 2010 for rotations"});
  chapter.add({"implicit trapezoidal rule at 40 and 20 us: order", "", 2.0, order_of(implicit_coarse, implicit),
               within(0.1, "next term"), "Newmark 1959: second order"});
  chapter.add({"Runge-Kutta at 80 and 40 us: order", "", 4.0,
               order_of(error(&HeldChain::runge_kutta, 250), error(&HeldChain::runge_kutta, 500)),
               within(0.3, "next term"), "Kutta 1901: fourth order"});
}

void add_tops(Chapter& chapter) {
  chapter.section("A free body that turns",
                  "One link of other inertia, free of forces, through the program's own steps.");
  const TopReference euler = euler_top(), tumbling = tumbling_top();
  const auto found = [](const TopReference& top, std::size_t at, int steps) -> Vector3d {
    return spin_top(top.inertia, top.spin, top.known[at].time, steps).angular_velocity;
  };
  const char* jacobi = "closed form: Jacobi's elliptic functions (Landau & Lifshitz, Mechanics, section 37)";
  Worst worst;
  for (std::size_t at = 0; at < euler.known.size(); ++at)
    worst = worse(worst, worst_of(found(euler, at, static_cast<int>(euler.known[at].time * 400.0)),
                                  euler.known[at].angular_velocity));
  chapter.add({"Euler's top, I = (3, 2, 1), w = (1, 0, 1): angular velocity at 0.5 to 10 s", "rad/s", worst.reference,
               worst.measured, within(3e-5, "h² at 2.5 ms, 10 s"), jacobi});
  const auto error = [&](const TopReference& top, std::size_t at, int steps) {
    return (found(top, at, steps) - top.known[at].angular_velocity).norm();
  };
  chapter.add({"Euler's top: order of the angular velocity", "", 2.0,
               order_of(error(euler, 4, 2000), error(euler, 4, 4000)), within(0.05, "next term"),
               std::string(k_method) + ": second order"});
  worst = {};
  for (std::size_t at = 0; at < tumbling.known.size(); ++at)
    worst =
        worse(worst, worst_of(reference_top(tumbling.inertia, tumbling.spin, tumbling.known[at].time).angular_velocity,
                              tumbling.known[at].angular_velocity));
  chapter.add({"top spun about its middle axis, through the reference integrator: angular velocity at 1 to 10 s",
               "rad/s", worst.reference, worst.measured, within(1e-6, "errors grow e^2.9 times a second"),
               "Euler's equations and DOP853 (scipy)"});
  const Worst turned = worst_of(found(tumbling, 3, 40000), tumbling.known[3].angular_velocity);
  chapter.add({"top spun about its middle axis, after its first turn-over at 4 s", "rad/s", turned.reference,
               turned.measured, within(2e-4, "h² at 0.1 ms, grown e^2.9 times a second"),
               "Euler's equations and DOP853 (scipy)"});
  const Vector3d inertia(1.0, 2.0, 3.5), spin(0.4, 2.0, 0.3);
  const Quaterniond exact = reference_top(inertia, spin, 5.0).orientation;
  const auto turn_error = [&](int steps) {
    return quaternion_distance(spin_top(inertia, spin, 5.0, steps).orientation, exact);
  };
  chapter.add({"top of I = (1, 2, 3.5): order of the orientation, 5 s in 1000 and 2000 steps", "", 2.0,
               order_of(turn_error(1000), turn_error(2000)), within(0.05, "next term"),
               std::string(k_method) + ": second order; rotations by the exponential"});
}

}  // namespace

void add_integrator(Chapter& chapter) {
  add_spectrum(chapter);
  add_alternating_steps(chapter);
  add_exact_trajectories(chapter);
  add_orders(chapter);
  add_estimates(chapter);
  add_reference_integrators(chapter);
  add_tops(chapter);
}

}  // namespace grouser::validation
