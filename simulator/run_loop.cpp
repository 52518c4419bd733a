#include "simulator/run_loop.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/errors.h"
#include "simulator/failures.h"

namespace grouser {
namespace {

constexpr long k_steps_between_reports = 500;
constexpr double k_save_period = 2.0;  // s simulated; what --resume computes again, and a chunk, at most
/// A chunk of samples fills a little before or after its time: the save that is due with it must not wait for the next.
constexpr double k_early = 0.5 * k_chunk_time;

}  // namespace

RunLoop::RunLoop(const System& system, const RunStart& start, const std::filesystem::path& folder)
    : system_(system),
      start_(start),
      folder_(folder),
      identity_(identity_of(system.scenario)),
      watch_(start.wall_time),
      stepper_(system, start.assembled.state, start.assembled.knobs),
      book_(open_book(stepper_.work().energy)),
      previous_book_(book_),
      recorder_(system, folder / "run.h5", start.kept_rows),
      track_watch_(system, start.assembled.state),
      energy_watch_(system, book_) {}

void RunLoop::begin() { recorder_.begin(snapshot()); }

void RunLoop::take(CheckpointReader& checkpoint) {
  checkpoint(*this);
  const double time = stepper_.state().time;
  checkpoint.require(time >= 0.0 && time <= system_.scenario.duration, "a time of the run");
  CheckpointWriter stored, found;
  Acceleration archived = stepper_.acceleration(), evaluated = stepper_.reevaluate();
  stored(archived);
  found(evaluated);
  if (stored.payload() != found.payload()) {
    throw InputError(InputFinding{(folder_ / "checkpoint").string(), "", "accelerations that this program finds again",
                                  "others: it was written by another build or machine",
                                  "start the run without --resume"});
  }
  recorder_.publish();
}

/// Times that a step must end on: corners of the drive tables, the end. Of corners closer than the smallest step one is
/// enough: a sliver of a step between them would make the slope form divide by it.
std::vector<double> RunLoop::corners() const {
  const double duration = system_.scenario.duration;
  std::vector<double> times{duration};
  for (const DriveTable& table : system_.scenario.drive) {
    for (const double t : table.time) {
      if (t > 0.0 && t < duration) times.push_back(t);
    }
  }
  std::sort(times.begin(), times.end());
  const double least = system_.scenario.integrator.min_step;
  std::vector<double> apart;
  for (const double t : times) {
    if (!apart.empty() && t - apart.back() < least) apart.pop_back();
    apart.push_back(t);
  }
  return apart;
}

RunStatus RunLoop::go(const Progress& progress, RunSummary& summary) {
  for (const double corner : corners()) {
    while (stepper_.state().time < corner) {
      if (const std::optional<std::string> reason = advance_to(corner)) {
        summary.message = *reason;
        return RunStatus::failed;
      }
      if (steps_.accepted % k_steps_between_reports == 0 && !report(progress, summary)) {
        save();
        return RunStatus::stopped;
      }
      if (recorder_.chunk_filled() || stepper_.state().time > std::max(saved_, 0.0) + k_save_period + k_early) keep();
    }
  }
  summary.message = fmt::format("{:.3f} s simulated", stepper_.state().time) + remarks(system_, measures());
  return RunStatus::completed;
}

std::optional<std::string> RunLoop::advance_to(double until) {
  const StepStatus status = stepper_.step(until);
  if (status != StepStatus::ok)
    return fmt::format("at {:.6f} s, {}", stepper_.state().time, step_failure(system_, stepper_, status));
  previous_book_ = book_;
  book_step(book_, stepper_.work().energy, stepper_.last_step());
  ++steps_.accepted;
  steps_.min = std::min(steps_.min, stepper_.last_step());
  steps_.max = std::max(steps_.max, stepper_.last_step());
  recorder_.record(
      {stepper_.previous_state(), stepper_.previous_work(), stepper_.previous_acceleration(), previous_book_},
      snapshot(), stepper_);
  energy_watch_.update(book_, stepper_);
  if (std::optional<std::string> lost = track_watch_.update(stepper_)) return lost;
  return energy_watch_.failure(book_, stepper_);
}

/// What the recorder kept, and what the tracks were seen to do.
RunMeasures RunLoop::measures() const {
  RunMeasures measures = recorder_.measures();
  for (const Side side : {Side::left, Side::right}) {
    const auto s = static_cast<std::size_t>(index_of(side));
    measures.skipped_teeth[s] = track_watch_.skipped_teeth(side);
    measures.slack[s] = track_watch_.slack(side);
  }
  return measures;
}

bool RunLoop::report(const Progress& progress, RunSummary& summary) const {
  if (!progress) return true;
  const double t = stepper_.state().time, duration = system_.scenario.duration;
  if (progress({t / duration, fmt::format("{:.2f} of {:g} s", t, duration)})) return true;
  summary.message = fmt::format("interrupted at {:.4f} s of {:g} s", t, duration);
  return false;
}

/// Makes the run so far safe from a kill. Samples may be so sparse that no chunk of them fills in time.
void RunLoop::keep() {
  if (stepper_.state().time >= saved_ + k_save_period - k_early) {
    save();
  } else {
    recorder_.flush();
  }
}

/// Writes the checkpoint, its rows before it.
void RunLoop::save() {
  saved_ = stepper_.state().time;
  RunStart now{start_.assembled, start_.assembly_wall_time, watch_.seconds(), recorder_.rows()};
  CheckpointWriter parts;
  parts(now);
  parts(*this);
  recorder_.sync([folder = folder_, identity = identity_, parts = std::move(parts)] {
    write_checkpoint(folder, identity, parts);
  });
}

void RunLoop::finish(RunSummary& summary) {
  recorder_.close();
  summary.wall_time = watch_.seconds();
  summary.assembly_wall_time = start_.assembly_wall_time;
  summary.simulated_time = stepper_.state().time;
  steps_.mean = steps_.accepted > 0 ? stepper_.state().time / static_cast<double>(steps_.accepted) : 0.0;
  summary.steps.accepted = steps_.accepted;
  summary.steps.rejected = stepper_.rejected();
  summary.steps.force_evaluations = stepper_.evaluations();
  summary.steps.min = steps_.accepted > 0 ? steps_.min : 0.0;
  summary.steps.mean = steps_.mean;
  summary.steps.max = steps_.max;
  summary.energy.input = book_.input;
  summary.energy.dissipated = book_.dissipated();
  summary.energy.residual = book_.residual();
  summary.energy.residual_fraction = book_.residual_fraction();
  add_results(system_, start_.assembled, measures(), book_, summary);
  summary.results.push_back({"mean_step_s", steps_.mean, "s", "mean accepted step"});
}

std::string remarks(const System& system, const RunMeasures& measures) {
  std::string beyond;
  for (int a = 0; a < k_num_axes; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto& valid = system.scenario.bushing.axes[axis].valid;
    if (!valid || valid->amplitude <= 0.0 || measures.rubber.largest_deflection[axis] <= valid->amplitude) continue;
    beyond += fmt::format("{} {} {:.2f} times", beyond.empty() ? "" : ",", k_axis_names[axis],
                          measures.rubber.largest_deflection[axis] / valid->amplitude);
  }
  std::string all;
  for (const Side side : {Side::left, Side::right}) {
    const SlackSpan& slack = measures.slack[static_cast<std::size_t>(index_of(side))];
    if (slack.time < 0.0) continue;
    all += fmt::format("; span at the {} sprocket slack at {:.3f} s", name_of(side), slack.time);
  }
  if (!beyond.empty())
    all += "; bushings deflected beyond what was identified (there the law is a straight line):" + beyond;
  return all;
}

}  // namespace grouser
