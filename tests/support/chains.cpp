#include "tests/support/chains.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include "simulator/links.h"
#include "tests/support/closed_forms.h"

namespace grouser::test {
namespace {

void run_to(Stepper& stepper) {
  if (stepper.step(1e9) != StepStatus::ok) throw std::runtime_error("a step of the chain failed");
}

}  // namespace

System chain_system(int num_links, const Bushing& bushing, double step) {
  Scenario scenario = parked(bare_vehicle(num_links), bushing, 0.0);
  scenario.integrator.fixed_step = step;
  return compile(scenario);
}

State thrown_chain(const System& system) {
  State state = strewn_state(system);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double size) -> Vector3d {
    return size * Vector3d(unit(random), unit(random), unit(random));
  };
  const int n = system.tracks[0].num_links;
  const double radius = 0.5 * system.tracks[0].pitch / std::tan(k_pi / n);
  for (const CompiledTrack& track : system.tracks) {
    const Vector3d center = far_from_chassis() + Vector3d(0.0, 50.0 * index_of(track.side), 0.0);
    place_polygon(track, center, radius, 3.0, state);
    for (int i = track.offset; i < track.offset + n; ++i) {
      LinkMotion link = get_link(state, i);
      link.velocity += Vector3d(2.0, -1.0, 0.5) + vector(0.3);
      link.angular_velocity += vector(3.0);
      set_link(state, i, link);
    }
  }
  relax_rubber(system, state);
  return state;
}

ChainDrift drift_of(const Bushing& bushing, double step) {
  const System system = chain_system(24, bushing, step);
  const State start = thrown_chain(system);
  const Momentum before = momentum(system.tracks[0], start);
  Stepper stepper(system, start, {});
  EnergyBook book = open_book(stepper.work().energy);
  constexpr double k_duration = 0.2;  // s
  for (int i = 0; i < static_cast<int>(std::lround(k_duration / step)); ++i) {
    run_to(stepper);
    book_step(book, stepper.work().energy, stepper.last_step());
  }
  const Momentum after = momentum(system.tracks[0], stepper.state());
  // Angular momentum about the chain's own middle, so that 1 km of lever does not magnify round-off.
  const auto about = [](const Momentum& m, const Vector3d& point) {
    return Vector3d(m.angular - point.cross(m.linear));
  };
  const double mass = 24 * system.tracks[0].mass;
  const Vector3d moved = far_from_chassis() + k_duration * before.linear / mass;
  const Vector3d l0 = about(before, far_from_chassis()), l1 = about(after, moved);
  return {(after.linear - before.linear).norm(),
          (l1 - l0).norm(),
          std::abs(book.residual()),
          before.linear.norm(),
          l0.norm(),
          book.dissipated()};
}

SpinningPolygon::SpinningPolygon(int num_links, double spin_rate, double step)
    : system(chain_system(num_links, elastic_bushing(), step)), start(strewn_state(system)), spin(spin_rate) {
  constexpr double stiffness = 1e8;  // N/m, of elastic_bushing() along x and z
  const CompiledTrack& track = system.tracks[0];
  force = spinning_polygon_force(num_links, track.pitch, track.mass, spin, stiffness);
  const double gap = force / stiffness, half = k_pi / num_links;
  const double radius = 0.5 * track.pitch / std::tan(half) + 0.5 * gap / std::sin(half);
  for (const CompiledTrack& t : system.tracks)
    place_polygon(t, center + Vector3d(0.0, 50.0 * index_of(t.side), 0.0), radius, spin, start);
  relax_rubber(system, start);
}

double SpinningPolygon::centripetal_error(const Acceleration& acceleration) const {
  double worst = 0.0;
  for (int i = 0; i < system.tracks[0].num_links; ++i) {
    const Vector3d wanted = -spin * spin * (get_link(start, i).position - center);
    worst = std::max(worst, (get_vector(acceleration.linear, i) - wanted).norm());
  }
  return worst;
}

HeldChain::HeldChain(int num_links, const Bushing& bushing, std::vector<int> held, double gravity)
    : system(compile(parked(bare_vehicle(num_links), bushing, gravity))),
      state(strewn_state(system)),
      work(make_workspace(system)),
      held_(std::move(held)),
      next_(state),
      f_(make_acceleration(system)),
      f_before_(f_),
      f_found_(f_) {
  system.tracks[1].num_links = 0;
}

const Acceleration& HeldChain::accelerate(const State& at) {
  next_ = at;
  close_chains(system, next_);
  AssemblyKnobs knobs;
  knobs.mass_damping = damping_;
  evaluate(system, knobs, next_.history, 0.0, next_, work, f_found_);
  f_found_.chassis = make_acceleration(system).chassis;
  for (const int i : held_) {
    for (int c = 0; c < 3; ++c) f_found_.linear[c][i] = f_found_.angular[c][i] = 0.0;
  }
  return f_found_;
}

void HeldChain::start() {
  f_ = accelerate(state);
  f_before_ = f_;
}

void HeldChain::chung_lee_step(double h) {
  State next = state;
  advance(system, h, h, state, f_, f_before_, next);
  state = std::move(next);
  f_before_ = f_;
  f_ = accelerate(state);
}

void HeldChain::runge_kutta(double h, int steps) {
  struct Rate {
    Vector3d velocity, linear, turn, angular;
  };
  const int n = system.tracks[0].num_links;
  const auto rates = [&](const State& at) {
    const Acceleration& f = accelerate(at);
    std::vector<Rate> rate;
    for (int i = 0; i < n; ++i) {
      const LinkMotion link = get_link(at, i);
      rate.push_back({link.velocity, get_vector(f.linear, i), link.angular_velocity, get_vector(f.angular, i)});
    }
    return rate;
  };
  const auto moved = [&](const std::vector<Rate>& rate, double by) {
    State to = state;
    for (int i = 0; i < n; ++i) {
      const Rate& r = rate[static_cast<std::size_t>(i)];
      const LinkMotion from = get_link(state, i);
      set_link(to, i,
               {from.position + by * r.velocity, (from.orientation * quaternion_exp(by * r.turn)).normalized(),
                from.velocity + by * r.linear, from.angular_velocity + by * r.angular});
    }
    return to;
  };
  const auto mean = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) -> Vector3d {
    return (a + 2.0 * b + 2.0 * c + d) / 6.0;
  };
  for (int step = 0; step < steps; ++step) {
    const auto k1 = rates(state), k2 = rates(moved(k1, 0.5 * h)), k3 = rates(moved(k2, 0.5 * h)),
               k4 = rates(moved(k3, h));
    std::vector<Rate> sum;
    for (std::size_t i = 0; i < k1.size(); ++i) {
      // Turning by the mean rate alone would be of second order: the commutator of the rates completes it.
      const Vector3d turn =
          mean(k1[i].turn, k2[i].turn, k3[i].turn, k4[i].turn) + h / 12.0 * k1[i].turn.cross(k4[i].turn);
      sum.push_back({mean(k1[i].velocity, k2[i].velocity, k3[i].velocity, k4[i].velocity),
                     mean(k1[i].linear, k2[i].linear, k3[i].linear, k4[i].linear), turn,
                     mean(k1[i].angular, k2[i].angular, k3[i].angular, k4[i].angular)});
    }
    state = moved(sum, h);
    state.time += h;
  }
}

void HeldChain::trapezoidal(double h, int steps) {
  const StepWeights weights{h, 0.5 * h, 0.5 * h, 0.25 * h * h, 0.25 * h * h};
  start();
  for (int step = 0; step < steps; ++step) {
    Acceleration after = f_;
    for (int iteration = 0;; ++iteration) {
      if (iteration == 200) throw std::runtime_error("the trapezoidal rule was not solved");
      State next = state;
      advance_links(system, weights, state, after, f_, next);
      const Acceleration& found = accelerate(next);
      double change = 0.0, size = 1.0;
      for (std::size_t k = 0; k < found.linear.data().size(); ++k) {
        change = std::max({change, std::abs(found.linear.data()[k] - after.linear.data()[k]),
                           std::abs(found.angular.data()[k] - after.angular.data()[k])});
        size = std::max({size, std::abs(found.linear.data()[k]), std::abs(found.angular.data()[k])});
      }
      after = found;
      if (change < 1e-6 * size) break;  // each iteration gains a factor of (omega h)^2 / 4 and better: 1e-2
    }
    State next = state;
    advance_links(system, weights, state, after, f_, next);
    next.time += h;
    state = std::move(next);
    f_ = after;
  }
}

void HeldChain::relax(double h, double rate, double small) {
  damping_ = rate;
  start();
  for (int step = 0; step < 2'000'000; ++step) {
    chung_lee_step(h);
    double largest = 0.0;
    for (int i = 0; i < system.tracks[0].num_links; ++i) {
      const LinkMotion m = link(i);
      largest = std::max(
          {largest, get_vector(f_.linear, i).norm() + rate * m.velocity.norm(),
           0.5 * system.tracks[0].pitch * (get_vector(f_.angular, i).norm() + rate * m.angular_velocity.norm())});
    }
    if (largest < small) {
      damping_ = 0.0;
      return;
    }
  }
  throw std::runtime_error("the chain did not come to rest");
}

double distance(const HeldChain& a, const HeldChain& b) {
  double worst = 0.0;
  for (int i = 0; i < a.system.tracks[0].num_links; ++i) {
    const LinkMotion x = a.link(i), y = b.link(i);
    worst = std::max({worst, (x.position - y.position).norm(),
                      0.5 * a.system.tracks[0].pitch * x.orientation.angularDistance(y.orientation)});
  }
  return worst;
}

}  // namespace grouser::test
