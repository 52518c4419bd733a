#pragma once
#include "simulator/workspace.h"

/// One step of the whole vehicle: kinematics, forces, accelerations, Chung-Lee update.
namespace grouser {

/// Forces and accelerations at `state` (positions, velocities and time given). `before` is the memory at the last
/// accepted state and h the step that led from it (0: none). Fills state.history, work and acceleration. Allocates
/// nothing.
void evaluate(const System& system, const AssemblyKnobs& knobs, const History& before, double h, State& state,
              Workspace& work, Acceleration& acceleration);

/// Positions and velocities of `next` from `now` (history apart). Returns the largest turn of a link [rad].
double advance(const System& system, double h, double previous_h, const State& now, const Acceleration& f_now,
               const Acceleration& f_before, State& next);

/// What bounded a step's size.
enum class StepLimit { error, stability, growth, max_step, min_step, end, fixed };
inline constexpr const char* k_step_limit_names[] = {"error",    "stability", "growth", "max_step",
                                                     "min_step", "end",       "fixed"};

enum class StepStatus { ok, not_finite, turned_too_far, underflow, bottomed };

/// What a step that failed had tried; forces and accelerations only where no link turned too far.
struct Trial {
  const State& state;
  const Workspace& work;
  const Acceleration& acceleration;
};

/// The state that a run moves through: two states and workspaces taken in turn, three accelerations.
class Stepper {
 public:
  Stepper(const System& system, State start, const AssemblyKnobs& knobs);

  /// One accepted step, at most to `until`. Otherwise the last good state stays current.
  [[nodiscard]] StepStatus step(double until);

  /// Evaluates the current state anew after knobs or options changed; the next step starts like the first.
  void restart();

  /// What it remembers from step to step, for a checkpoint (simulator/checkpoint.h).
  template <typename Archive>
  void archive(Archive& a) {
    a(states_[now_], states_[1 - now_], accelerations_[f_now_], accelerations_[f_before_], h_, previous_h_, limit_,
      last_limit_, limiting_, last_limiting_, last_error_, rejected_, evaluations_, worst_, stable_step_, bounding_,
      since_bound_);
    for (const Part& part : {limiting_, last_limiting_, worst_, bounding_})
      a.require(is_part(part), "links and bodies of the vehicle");
    for (const StepLimit limit : {limit_, last_limit_})
      a.require(limit >= StepLimit::error && limit <= StepLimit::fixed, "a limit of a step");
  }
  /// Fills the workspace of an archived state as the step that led to it did. Returns the accelerations that come out;
  /// the same program on the same machine finds those that were archived, to the last bit.
  [[nodiscard]] const Acceleration& reevaluate();

  AssemblyKnobs knobs;
  [[nodiscard]] State& state() { return states_[now_]; }
  [[nodiscard]] const State& state() const { return states_[now_]; }
  [[nodiscard]] const State& previous_state() const { return states_[1 - now_]; }
  [[nodiscard]] const Workspace& work() const { return works_[now_]; }
  [[nodiscard]] const Workspace& previous_work() const { return works_[1 - now_]; }
  [[nodiscard]] const Acceleration& acceleration() const { return accelerations_[f_now_]; }
  [[nodiscard]] const Acceleration& previous_acceleration() const { return accelerations_[f_before_]; }
  [[nodiscard]] double last_step() const { return previous_h_; }
  [[nodiscard]] double last_error() const { return last_error_; }
  [[nodiscard]] StepLimit last_limit() const { return last_limit_; }
  /// Whose error or stability set the size of the last step (error, stability), or would have (fixed).
  [[nodiscard]] Part last_limiting() const { return last_limiting_; }
  /// Largest step that was stable for certain when it was last looked for, some steps ago [s].
  [[nodiscard]] double stable_step() const { return stable_step_; }
  [[nodiscard]] Part bounding() const { return bounding_; }  ///< what set it
  [[nodiscard]] long rejected() const { return rejected_; }
  [[nodiscard]] long evaluations() const { return evaluations_; }
  /// Part with the largest error of the last trial, or the arm whose gas unit bottomed.
  [[nodiscard]] Part worst() const { return worst_; }
  [[nodiscard]] Trial trial() const { return {states_[1 - now_], works_[1 - now_], accelerations_[f_next_]}; }

 private:
  [[nodiscard]] bool is_part(const Part& part) const {
    return part.link >= -1 && part.link < system_.link_array_length && part.body >= -1 &&
           part.body < static_cast<int>(system_.tree.bodies.size());
  }
  /// Largest local error of the trial over its tolerance, and worst_, whose it is; 0 and nobody's at a fixed step, a
  /// NaN where an acceleration is no number. In the same pass over the accelerations the trial's energy book gets what
  /// contacts took over the step (contact_step_loss).
  [[nodiscard]] double judge(double h);
  void choose_next_step(double error_ratio);
  /// Keeps the bound that an accepted evaluation found, if it looked for one.
  void take_bound(const Workspace& work);

  const System& system_;
  std::array<State, 2> states_;
  std::array<Workspace, 2> works_;
  std::array<Acceleration, 3> accelerations_;
  std::size_t now_ = 0;
  std::size_t f_before_ = 0, f_now_ = 1, f_next_ = 2;
  double h_ = 0.0;           ///< wanted next
  double previous_h_ = 0.0;  ///< last accepted
  StepLimit limit_ = StepLimit::max_step, last_limit_ = StepLimit::max_step;
  double last_error_ = 0.0;
  long rejected_ = 0, evaluations_ = 0;
  Part limiting_, last_limiting_, worst_;
  double stable_step_ = 0.0;  ///< s
  Part bounding_;             ///< what set it
  int since_bound_ = 0;       ///< accepted steps since
  double reach_ = 0.0;        ///< m, of the chassis' furthest pivot
};

}  // namespace grouser
