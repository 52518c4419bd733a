#include "simulator/step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "simulator/bushings.h"
#include "simulator/contacts.h"
#include "simulator/drive.h"
#include "simulator/links.h"
#include "simulator/stability.h"
#include "simulator/suspension.h"

namespace grouser {
namespace {

void reset(Workspace& work) {
  work.energy = {};
  work.loss_force_W.fill(0.0);
  work.loss_torque_W.fill(0.0);
  if (work.bounds_step) {
    for (Field* field : {&work.plane_stiffness, &work.plane_damping, &work.side_stiffness, &work.side_damping})
      field->fill(0.0);
    work.stability.fill(0.0);
    std::fill(work.rim.begin(), work.rim.end(), RimSums{});
    work.bounding = {};
  }
  work.bottomed_unit = -1;
  for (Field& field : work.contact_force_W) field.fill(0.0);
  work.lateral_guide_offset = {};
  work.case_count = {};
}

void place_bodies(const System& system, const State& state, Workspace& work) {
  place_tree(system.tree, state.chassis, system.gravity_W, work.chassis);
  place_links(system, state, work);
}

void chassis_accelerations(const System& system, const AssemblyKnobs& knobs, const State& state, Workspace& work,
                           Acceleration& acceleration) {
  TreeAcceleration& a = acceleration.chassis;
  tree_accelerations(system.tree, state.chassis, work.prescribed_acceleration, work.chassis, a);
  work.energy.kinetic += work.chassis.kinetic_energy;
  work.energy.gravity += gravity_energy(system.tree, state.chassis, system.gravity_W, work.chassis);
  for (const int sprocket : system.sprocket_body) {
    work.energy.input_power += work.chassis.joint_torque[sprocket] * state.chassis.rate[sprocket];
  }
  if (knobs.mass_damping == 0.0) return;
  a.linear -= knobs.mass_damping * state.chassis.velocity;
  a.angular -= knobs.mass_damping * state.chassis.angular_velocity;
  for (Eigen::Index j = 0; j < a.joint.size(); ++j) {
    if (!system.tree.bodies[static_cast<std::size_t>(j)].prescribed)
      a.joint[j] -= knobs.mass_damping * state.chassis.rate[j];
  }
}

void advance_chassis(const System& system, const StepWeights& w, double time, const TreeState& now,
                     const TreeAcceleration& f, const TreeAcceleration& f0, TreeState& next) {
  next.position = now.position + w.h * now.velocity + w.position_now * f.linear + w.position_before * f0.linear;
  next.velocity = now.velocity + w.velocity_now * f.linear + w.velocity_before * f0.linear;
  const Vector3d angle = w.h * now.angular_velocity + w.position_now * f.angular + w.position_before * f0.angular;
  next.orientation = (now.orientation * quaternion_exp(angle)).normalized();
  next.angular_velocity = now.angular_velocity + w.velocity_now * f.angular + w.velocity_before * f0.angular;
  next.angle = now.angle + w.h * now.rate + w.position_now * f.joint + w.position_before * f0.joint;
  next.rate = now.rate + w.velocity_now * f.joint + w.velocity_before * f0.joint;
  for (std::size_t side = 0; side < k_num_sides; ++side) {  // prescribed motion is exact, not integrated
    const int body = system.sprocket_body[side];
    const DriveTable& table = system.scenario.drive[side];
    if (table.kind != DriveKind::speed) continue;
    const DriveMotion from = drive_motion(table, time), to = drive_motion(table, time + w.h);
    next.angle[body] = now.angle[body] + (to.angle - from.angle);
    next.rate[body] = to.speed;
  }
}

/// Largest embedded error of the tree over its tolerance, and whose it is.
struct TreeError {
  double ratio = 0.0;
  int body = -1;  ///< tree body; -1: the chassis itself
};

/// Errors of the chassis' velocity, of its angular velocity as the speed of the pivot furthest from its centre
/// (`reach` [m]), and of the joints' rates as the speed of a point 0.3 m from the axis.
TreeError tree_error(const System& system, double reach, const ErrorWeights& w, const TreeAcceleration& next,
                     const TreeAcceleration& now, const TreeAcceleration& before) {
  constexpr double k_arm = 0.3;  // m
  const auto bend = [&](const auto& n, const auto& f, const auto& b) { return n - f - w.ratio * (f - b); };
  const double per_tolerance = w.velocity / system.scenario.integrator.velocity_tolerance;
  TreeError worst{per_tolerance * std::max(Vector3d(bend(next.linear, now.linear, before.linear)).norm(),
                                           reach * Vector3d(bend(next.angular, now.angular, before.angular)).norm()),
                  -1};
  for (Eigen::Index j = 0; j < now.joint.size(); ++j) {
    if (system.tree.bodies[static_cast<std::size_t>(j)].prescribed) continue;
    const double error = per_tolerance * k_arm * std::abs(bend(next.joint[j], now.joint[j], before.joint[j]));
    if (error > worst.ratio) worst = {error, static_cast<int>(j)};
  }
  return worst;
}

/// Distance of the furthest joint of the base from its centre of mass [m].
double furthest_pivot(const Tree& tree) {
  double reach = 0.0;
  for (const TreeBody& body : tree.bodies) {
    if (body.parent < 0) reach = std::max(reach, body.origin.norm());
  }
  return reach;
}

bool finite(const TreeAcceleration& chassis, double sum_of_links) {
  return std::isfinite(chassis.linear.sum() + chassis.angular.sum() + chassis.joint.sum() + sum_of_links);
}

/// Steps between two looks for the stable one: it changes as links pass, in 14 ms at 50 km/h, of which four steps are a
/// 25th. What is unstable meanwhile, by a few per cent of a step, has no time to grow.
constexpr int k_steps_a_bound = 4;

/// Until the next look no step is taken that is longer than the growth limit lets it be: what is stable beyond that
/// (and a little, to tell which of both limits the next step) need not be known.
double longest_of_interest(const IntegratorOptions& options, double h) {
  constexpr double k_more = 1.001;
  const double growth = std::pow(options.growth_limit, k_steps_a_bound);
  return h > 0.0 && options.fixed_step == 0.0 ? k_more * growth * h / options.stability_fraction
                                              : std::numeric_limits<double>::infinity();
}

}  // namespace

void evaluate(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
              Workspace& work, Acceleration& acceleration) {
  reset(work);
  place_bodies(system, state, work);
  bushing_forces(system, knobs, before, h, state, work);
  disc_contacts(system, knobs, state, work);
  sprocket_contacts(system, knobs, state, work);
  ground_contacts(system, before, h, state, work);
  suspension_forces(knobs, state, work);
  drive_sprockets(system, state, work, acceleration);
  chassis_accelerations(system, knobs, state, work, acceleration);
  link_accelerations(system, knobs, state, work, acceleration);
  if (!work.bounds_step) return;
  bound_step(system, !knobs.rubber_memory, longest_of_interest(system.scenario.integrator, h), work);
}

double advance(const System& system, double h, double previous_h, const State& now, const Acceleration& f_now,
               const Acceleration& f_before, State& next) {
  const StepWeights weights = step_weights(system.scenario.integrator.beta, h, previous_h);
  next.time = now.time + h;
  advance_chassis(system, weights, now.time, now.chassis, f_now.chassis, f_before.chassis, next.chassis);
  for (std::size_t side = 0; side < k_num_sides; ++side) {
    next.driver[side] =
        now.driver[side] + weights.velocity_now * f_now.driver[side] + weights.velocity_before * f_before.driver[side];
  }
  const double turn = advance_links(system, weights, now, f_now, f_before, next);
  close_chains(system, next);
  return turn;
}

Stepper::Stepper(const System& system, State start, const AssemblyKnobs& start_knobs)
    : knobs(start_knobs),
      system_(system),
      states_{start, start},
      works_{make_workspace(system), make_workspace(system)},
      accelerations_{make_acceleration(system), make_acceleration(system), make_acceleration(system)},
      reach_(furthest_pivot(system.tree)) {
  for (Workspace& work : works_) work.keeps_joint_torques = false;
  restart();
}

void Stepper::restart() {
  // history is both the memory before and, for a step of length 0, after this evaluation
  states_[1 - now_].history = states_[now_].history;
  works_[now_].bounds_step = true;
  evaluate(system_, knobs, states_[1 - now_].history, 0.0, states_[now_], works_[now_], accelerations_[f_now_]);
  take_bound(works_[now_]);
  ++evaluations_;
  accelerations_[f_before_] = accelerations_[f_now_];  // start f_{-1} = f_0 keeps the order
  const IntegratorOptions& options = system_.scenario.integrator;
  h_ = options.fixed_step > 0.0 ? options.fixed_step : std::min(options.max_step, 0.5 * stable_step_);
  previous_h_ = h_;
  limit_ = options.fixed_step > 0.0 ? StepLimit::fixed : StepLimit::growth;
  limiting_ = bounding_;
}

const Acceleration& Stepper::reevaluate() {
  State& now = states_[now_];
  const State& before = states_[1 - now_];
  const double time = now.time;
  now.time =
      before.time + previous_h_;  // as advance() had it; the last step to `until` was set to that time afterwards
  evaluate(system_, knobs, before.history, previous_h_, now, works_[now_], accelerations_[f_next_]);
  now.time = time;
  return accelerations_[f_next_];
}

StepStatus Stepper::step(double until) {
  const IntegratorOptions& options = system_.scenario.integrator;
  for (;;) {
    const State& now = states_[now_];
    State& next = states_[1 - now_];
    Workspace& next_work = works_[1 - now_];
    const double left = until - now.time;
    // The last two steps share what is left: a sliver of a step would make the slope form divide by it.
    const bool last = left <= h_ * (1.0 + 1e-9);
    const double h = last ? left : (left < 2.0 * h_ ? 0.5 * left : h_);
    const double turn = advance(system_, h, previous_h_, now, accelerations_[f_now_], accelerations_[f_before_], next);
    if (turn >= 0.5) return StepStatus::turned_too_far;  // rad in one step
    next_work.bounds_step = since_bound_ + 1 >= k_steps_a_bound;
    evaluate(system_, knobs, now.history, h, next, next_work, accelerations_[f_next_]);
    ++evaluations_;

    const double ratio = judge(h);
    if (!(ratio <= 1.0)) {  // also what is no number: a smaller step may find one
      const bool least = options.fixed_step > 0.0 || h <= options.min_step;
      if (least) return std::isnan(ratio) ? StepStatus::not_finite : StepStatus::underflow;
      const double shrink = ratio > 1.0 ? std::clamp(0.9 * std::cbrt(1.0 / ratio), 0.2, 0.9) : 0.2;
      h_ = std::max(options.min_step, h * shrink);
      limit_ = StepLimit::error;
      limiting_ = worst_;
      ++rejected_;
      continue;
    }
    if (next_work.bottomed_unit >= 0) {
      worst_ = {-1, next_work.bottomed_unit};
      return StepStatus::bottomed;
    }
    last_limit_ = h < h_ ? StepLimit::end : limit_;
    last_limiting_ = limiting_;
    last_error_ = ratio;
    const std::size_t oldest = f_before_;
    f_before_ = f_now_;
    f_now_ = f_next_;
    f_next_ = oldest;
    now_ = 1 - now_;
    previous_h_ = h;
    if (last) states_[now_].time = until;
    take_bound(works_[now_]);
    choose_next_step(ratio);
    return StepStatus::ok;
  }
}

void Stepper::take_bound(const Workspace& work) {
  ++since_bound_;
  if (!work.bounds_step) return;
  stable_step_ = work.largest_stable_step;
  bounding_ = work.bounding;
  since_bound_ = 0;
}

double Stepper::judge(double h) {
  const IntegratorOptions& options = system_.scenario.integrator;
  const ErrorWeights weights = error_weights(options.beta, h, previous_h_);
  const Acceleration &next = accelerations_[f_next_], &now = accelerations_[f_now_],
                     &before = accelerations_[f_before_];
  Workspace& next_work = works_[1 - now_];
  worst_ = {};
  if (!finite(next.chassis, next_work.sum_of_accelerations)) return std::numeric_limits<double>::quiet_NaN();
  const LinkVerdict links = judge_links(system_, weights, step_weights(options.beta, h, previous_h_),
                                        {works_[now_], next_work, before, now, next});
  next_work.energy.contact_step_loss = links.contact_step_loss;
  if (options.fixed_step > 0.0) return 0.0;
  const TreeError tree = tree_error(system_, reach_, weights, next.chassis, now.chassis, before.chassis);
  worst_ = tree.ratio > links.error.ratio ? Part{-1, tree.body} : Part{links.error.link, -1};
  return std::max(tree.ratio, links.error.ratio);
}

void Stepper::choose_next_step(double error_ratio) {
  const IntegratorOptions& options = system_.scenario.integrator;
  if (options.fixed_step > 0.0) {
    h_ = options.fixed_step;
    limit_ = StepLimit::fixed;
    limiting_ = bounding_;
    return;
  }
  const double used = previous_h_;
  constexpr double k_safety = 0.9;
  const double grown = options.growth_limit / k_safety;
  h_ = std::numeric_limits<double>::infinity();
  if (error_ratio * grown * grown * grown >= 1.0) h_ = used * std::max(0.2, k_safety * std::cbrt(1.0 / error_ratio));
  limit_ = StepLimit::error;
  limiting_ = worst_;
  const auto bound = [&](double h, StepLimit why) {
    if (h < h_) h_ = h, limit_ = why;
  };
  bound(options.stability_fraction * stable_step_, StepLimit::stability);
  if (limit_ == StepLimit::stability) limiting_ = bounding_;
  bound(options.growth_limit * used, StepLimit::growth);
  bound(options.max_step, StepLimit::max_step);
  if (h_ < options.min_step) h_ = options.min_step, limit_ = StepLimit::min_step;
}

}  // namespace grouser
