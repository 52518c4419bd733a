#include "simulator/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "model/errors.h"
#include "simulator/assembly.h"
#include "simulator/channels.h"
#include "simulator/checkpoint.h"
#include "simulator/drive.h"
#include "simulator/folder_lock.h"
#include "simulator/results.h"
#include "simulator/track_watch.h"

namespace grouser {
namespace {

/// Wall time, that of the run's earlier parts included.
class Stopwatch {
 public:
  explicit Stopwatch(double earlier = 0.0) : earlier_(earlier) {}
  [[nodiscard]] double seconds() const {
    return earlier_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double earlier_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Writes one of the sampled tables at a constant rate, between accepted states.
class Sampler {
 public:
  Sampler(const ChannelRows& rows, RunTable table, double rate, RunWriter& writer)
      : rows_(rows), table_(table), period_(1.0 / rate), writer_(writer) {}

  [[nodiscard]] bool due(double time) const {
    return static_cast<double>(count_) * period_ <= time * (1.0 + 1e-12) + 1e-12;
  }

  /// Writes the rows due in (previous, now]. Returns true if any was written; `last_row` holds the last one.
  bool write(const Snapshot& previous, const Snapshot& now) {
    if (!due(now.state.time)) return false;
    rows_.fill(table_, previous, before_);
    rows_.fill(table_, now, after_);
    const double span = now.state.time - previous.state.time;
    for (; due(now.state.time); ++count_) {
      const double at = static_cast<double>(count_) * period_;
      rows_.blend(table_, before_, after_, span > 0.0 ? std::clamp((at - previous.state.time) / span, 0.0, 1.0) : 1.0,
                  row_);
      row_[0] = at;
      writer_.append(static_cast<std::size_t>(table_), row_);
    }
    return true;
  }

  template <typename Archive>
  void archive(Archive& a) {
    a(count_);
  }

 private:
  const ChannelRows& rows_;
  RunTable table_;
  double period_;
  RunWriter& writer_;
  long count_ = 0;
  std::vector<double> before_, after_, row_;
};

/// What is known of a run when its first step is due, and what a resumed one starts from.
struct RunStart {
  Assembled assembled;
  double assembly_wall_time = 0.0;     // s
  double wall_time = 0.0;              // s, of the parts before
  std::vector<std::size_t> kept_rows;  // of run.h5, by table; empty for a run from its beginning
};

template <typename Archive>
void archive(Archive& a, RunStart& start) {
  auto& [assembled, assembly_wall_time, wall_time, kept_rows] = start;
  a(assembled, assembly_wall_time, wall_time, kept_rows);
}

/// A run from its assembled state to its end.
class Run {
 public:
  Run(const System& system, const RunStart& start, const std::filesystem::path& folder)
      : system_(system),
        start_(start),
        folder_(folder),
        identity_(identity_of(system.scenario)),
        watch_(start.wall_time),
        stepper_(system, start.assembled.state, start.assembled.knobs),
        book_(open_book(stepper_.work().energy)),
        previous_book_(book_),
        rows_(system),
        writer_(folder / "run.h5", rows_.tables(), rows_.names(), start.kept_rows),
        samples_(rows_, RunTable::samples, system.scenario.output.rate, writer_),
        probes_(rows_, RunTable::probes, system.scenario.output.probe_rate, writer_),
        counters_{ToothCounter(system, start.assembled.state, Side::left),
                  ToothCounter(system, start.assembled.state, Side::right)} {
    series_.least_tension = std::numeric_limits<double>::infinity();
    series_.largest_tension = -std::numeric_limits<double>::infinity();
    steady_ = steady_drive(system.scenario);
    for (const DriveTable& table : system.scenario.drive) {
      for (const double speed : table.speed) largest_rate_ = std::max(largest_rate_, std::abs(speed));
    }
  }

  /// Writes the state of time 0.
  void begin() {
    record(snapshot(), snapshot());
    writer_.flush();
  }

  /// Takes over the memory of the run so far.
  void take(CheckpointReader& checkpoint) {
    checkpoint(*this);
    CheckpointWriter stored, found;
    Acceleration archived = stepper_.acceleration(), evaluated = stepper_.reevaluate();
    stored(archived);
    found(evaluated);
    if (stored.payload() == found.payload()) return;
    throw InputError(InputFinding{(folder_ / "checkpoint").string(), "", "accelerations that this program finds again",
                                  "others: it was written by another build or machine",
                                  "start the run without --resume"});
  }

  /// What it remembers from step to step.
  template <typename Archive>
  void archive(Archive& a) {
    auto& [accepted, min, mean, max] = steps_;
    a(stepper_, book_, samples_, probes_, counters_, series_, accepted, min, mean, max, flushed_, saved_);
  }

  /// Steps to the end; returns the status and fills the summary's message.
  RunStatus go(const Progress& progress, RunSummary& summary) {
    const double duration = system_.scenario.duration;
    std::vector<double> corners{duration};
    for (const DriveTable& table : system_.scenario.drive) {
      for (const double t : table.time) {
        if (t > 0.0 && t < duration) corners.push_back(t);
      }
    }
    std::sort(corners.begin(), corners.end());
    for (const double corner : corners) {
      while (stepper_.state().time < corner) {
        if (const RunStatus status = advance_to(corner, summary); status != RunStatus::completed) return status;
        if (steps_.accepted % k_steps_between_reports != 0) continue;
        if (!report(progress, duration, summary)) {
          save();
          return RunStatus::stopped;
        }
        if (stepper_.state().time >= saved_ + k_save_period) save();
        if (stepper_.state().time >= flushed_ + k_flush_period) flush();
      }
    }
    if (book_.residual_fraction() >= k_largest_residual) return chatter(summary);
    summary.message = fmt::format("{:.3f} s simulated", stepper_.state().time) + beyond_identified() + not_modelled();
    return RunStatus::completed;
  }

  void finish(RunSummary& summary) {
    summary.wall_time = watch_.seconds();
    summary.assembly_wall_time = start_.assembly_wall_time;
    writer_.close();
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
    for (std::size_t s = 0; s < k_num_sides; ++s) series_.skipped_teeth[s] = counters_[s].skipped();
    add_results(system_, start_.assembled, series_, book_, summary);
    summary.results.push_back({"mean_step_s", steps_.mean, "s", "mean accepted step"});
  }

 private:
  static constexpr double k_largest_residual = 1e-3;
  static constexpr long k_steps_between_reports = 500;
  static constexpr long k_steps_between_tooth_counts = 20;  // far less than a tooth at any speed a step can follow
  static constexpr double k_flush_period = 0.25;            // s simulated; what a killed run loses at most
  static constexpr double k_save_period = 1.0;              // s simulated; what --resume computes again at most
  static constexpr double k_still_share = 0.02;             // of the largest sprocket speed

  void flush() {
    flushed_ = stepper_.state().time;
    writer_.flush();
  }

  /// Writes the checkpoint, its rows before it.
  void save() {
    saved_ = flushed_ = stepper_.state().time;
    RunStart now{start_.assembled, start_.assembly_wall_time, watch_.seconds(), writer_.sync()};
    CheckpointWriter parts;
    parts(now);
    parts(*this);
    write_checkpoint(folder_, identity_, parts);
  }

  [[nodiscard]] Snapshot snapshot() const {
    return {stepper_.state(), stepper_.work(), stepper_.acceleration(), book_};
  }

  RunStatus advance_to(double until, RunSummary& summary) {
    const StepStatus status = stepper_.step(until);
    if (status != StepStatus::ok) return numerical_failure(status, summary);
    previous_book_ = book_;
    book_step(book_, stepper_.work().energy, stepper_.last_step());
    ++steps_.accepted;
    steps_.min = std::min(steps_.min, stepper_.last_step());
    steps_.max = std::max(steps_.max, stepper_.last_step());
    const Snapshot previous{stepper_.previous_state(), stepper_.previous_work(), stepper_.previous_acceleration(),
                            previous_book_};
    record(previous, snapshot());
    const std::array<double, 4> step{stepper_.state().time, stepper_.last_step(), stepper_.last_error(),
                                     static_cast<double>(stepper_.last_limit())};
    writer_.append(static_cast<std::size_t>(RunTable::steps), step);
    watch_steps();
    watch_bushings();
    if (steps_.accepted % k_steps_between_tooth_counts == 0) {
      for (ToothCounter& counter : counters_) counter.update(system_, stepper_.state());
    }
    return watch_track(summary);
  }

  void record(const Snapshot& previous, const Snapshot& now) {
    if (probes_.write(previous, now)) {
      series_.probe_time.push_back(now.state.time);
      series_.probe_torque.push_back(now.work.chassis.joint_torque[system_.sprocket_body[0]]);
    }
    if (!samples_.write(previous, now)) return;
    const Matrix3d& R_WV = now.work.chassis.base_rotation;
    const Vector3d origin = now.state.chassis.position - R_WV * system_.chassis_center_V;
    series_.time.push_back(now.state.time);
    series_.x.push_back(origin.x());
    series_.y.push_back(origin.y());
    const double yaw = std::atan2(R_WV(1, 0), R_WV(0, 0));
    series_.yaw.push_back(
        series_.yaw.empty() ? yaw : series_.yaw.back() + std::remainder(yaw - series_.yaw.back(), 2.0 * k_pi));
    series_.speed.push_back(R_WV.col(0).dot(now.state.chassis.velocity));
    series_.yaw_rate.push_back(now.work.chassis.base_angular_velocity_W.z());
    double ground = 0.0;
    for (const double f : vertical_ground_force(now.work)) ground += f;
    series_.ground_force.push_back(ground);
    for (std::size_t c = 0; c < k_num_contact_cases; ++c)
      series_.case_total[c] += static_cast<double>(now.work.case_count[c]);
  }

  [[nodiscard]] std::span<const double> vertical_ground_force(const Workspace& work) const {
    const Field& ground = work.contact_force_W[static_cast<std::size_t>(Partner::ground)];
    return {ground[2], static_cast<std::size_t>(ground.length())};
  }

  /// Steps at rest and at a held speed apart (the paper's Fig. 4).
  void watch_steps() {
    const double t = stepper_.state().time, h = stepper_.last_step();
    double rate = 0.0;
    for (const int sprocket : system_.sprocket_body)
      rate = std::max(rate, std::abs(stepper_.state().chassis.rate[sprocket]));
    if (rate <= k_still_share * largest_rate_) series_.rest_steps.time += h, ++series_.rest_steps.count;
    if (steady_ && t > steady_->from && t <= steady_->to) series_.steady_steps.time += h, ++series_.steady_steps.count;
  }

  void watch_bushings() {
    for (const CompiledTrack& track : system_.tracks) {
      const double* tension = stepper_.work().bushing_force[0] + track.offset;
      const auto [low, high] = std::minmax_element(tension, tension + track.num_links);
      series_.least_tension = std::min(series_.least_tension, *low);
      series_.largest_tension = std::max(series_.largest_tension, *high);
      for (int a = 0; a < k_num_axes; ++a) {
        const double free = a == index_of(Axis::ry) ? track.free_twist : 0.0;
        double& largest = series_.largest_deflection[static_cast<std::size_t>(a)];
        const double* deflection = stepper_.work().deflection[a] + track.offset;
        for (int i = 0; i < track.num_links; ++i) {
          largest = std::max(largest, std::abs(deflection[i] - free) / track.bushings_in_series);
        }
      }
    }
  }

  RunStatus watch_track(RunSummary& summary) {
    for (const Side side : {Side::left, Side::right}) {
      const double offset = stepper_.work().lateral_guide_offset[static_cast<std::size_t>(index_of(side))];
      series_.largest_guide_offset = std::max(series_.largest_guide_offset, offset);
      if (offset < k_thrown_offset) continue;
      summary.message = fmt::format(
          "{} track thrown at {:.4f} s: a link stands {:.0f} mm beside the wheel it meets; the guide no longer holds "
          "it (pre-tension, "
          "guide geometry, steering speed)",
          name_of(side), stepper_.state().time, 1e3 * offset);
      return RunStatus::failed;
    }
    return RunStatus::completed;
  }

  RunStatus numerical_failure(StepStatus status, RunSummary& summary) {
    const std::string body = link_name(system_, stepper_.worst_link());
    const char* quantity = "the acceleration is no longer finite: the run diverged";
    if (status == StepStatus::turned_too_far)
      quantity = "it turned by more than half a radian in one step: the run diverged";
    if (status == StepStatus::underflow)
      quantity = "its local error asks for a step below integrator.min_step: step underflow";
    summary.message = fmt::format("at {:.6f} s, {}: {}", stepper_.state().time, body, quantity);
    return RunStatus::failed;
  }

  /// What a user must know of a run that is otherwise sound: rubber deflected further than was measured.
  [[nodiscard]] std::string beyond_identified() const {
    std::string beyond;
    for (int a = 0; a < k_num_axes; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const auto& valid = system_.scenario.bushing.axes[axis].valid;
      if (!valid || valid->amplitude <= 0.0 || series_.largest_deflection[axis] <= valid->amplitude) continue;
      beyond += fmt::format("{} {} {:.2f} times", beyond.empty() ? "" : ",", k_axis_names[axis],
                            series_.largest_deflection[axis] / valid->amplitude);
    }
    if (beyond.empty()) return beyond;
    return "; bushings deflected beyond what was identified (there the law is a straight line):" + beyond;
  }

  /// Inputs that are read but not yet in the equations.
  [[nodiscard]] std::string not_modelled() const {
    for (const CompiledTrack& track : system_.tracks) {
      if (track.bushings_in_series > 1)
        return "; double pin taken as two bushings in series, connector_length not used";
    }
    return "";
  }

  RunStatus chatter(RunSummary& summary) {
    summary.message = fmt::format(
        "energy residual {:.2e} of the integral of |sprocket power|, more than {:.0e}: hidden chatter; reduce "
        "integrator.stability_fraction "
        "or max_step, or soften the stiffest contact",
        book_.residual_fraction(), k_largest_residual);
    return RunStatus::failed;
  }

  bool report(const Progress& progress, double duration, RunSummary& summary) {
    if (!progress) return true;
    const double t = stepper_.state().time;
    if (progress({t / duration, fmt::format("{:.2f} of {:g} s", t, duration)})) return true;
    summary.message = fmt::format("interrupted at {:.4f} s of {:g} s", t, duration);
    return false;
  }

  const System& system_;
  const RunStart& start_;
  std::filesystem::path folder_;
  CheckpointIdentity identity_;
  Stopwatch watch_;
  Stepper stepper_;
  EnergyBook book_, previous_book_;
  ChannelRows rows_;
  RunWriter writer_;
  Sampler samples_, probes_;
  std::array<ToothCounter, k_num_sides> counters_;
  RunSeries series_;
  std::optional<Interval> steady_;
  double largest_rate_ = 0.0;  // rad/s, of any sprocket
  double flushed_ = 0.0;       // s, time of the last flush
  double saved_ = -1.0;        // s, time of the last checkpoint; the first one is due at once
  struct {
    long accepted = 0;
    double min = 1.0, mean = 0.0, max = 0.0;
  } steps_;
};

RunSummary start_summary(const System& system) {
  RunSummary summary;
  const Scenario& scenario = system.scenario;
  summary.name = scenario.name;
  summary.vehicle_name = scenario.vehicle.name;
  summary.bushing_name = scenario.bushing.name;
  summary.provenance = scenario.provenance;
  summary.counts.bodies = system.num_bodies();
  summary.counts.revolute_joints = system.num_revolute_joints();
  summary.counts.bushings = system.num_bushings();
  summary.counts.degrees_of_freedom = system.num_degrees_of_freedom();
  summary.counts.prescribed = system.num_prescribed();
  return summary;
}

/// Should this run be killed, its channels stand beside a summary that says so, not beside that of an earlier run.
void mark_as_running(RunSummary& summary, const std::filesystem::path& folder) {
  summary.status = RunStatus::stopped;
  summary.message = "still running, or killed";
  write_run_summary(summary, folder / "run.json");
}

RunSummary go(Run& run, RunSummary& summary, const std::filesystem::path& folder, const Progress& progress) {
  summary.status = run.go(progress, summary);
  run.finish(summary);
  write_run_summary(summary, folder / "run.json");
  return summary;
}

/// A run that came to its end, well or not, would come to the same end again.
void refuse_ended(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "run.json";
  if (!std::filesystem::exists(file)) return;
  const RunSummary earlier = read_run_summary(file);
  if (earlier.status == RunStatus::stopped) return;
  throw InputError(InputFinding{file.string(), "/status", "a run that was stopped or killed",
                                fmt::format("{}: {}", name_of(earlier.status), earlier.message),
                                "start the run without --resume"});
}

/// Share of the progress bar.
constexpr double k_assembly_share = 0.25;

}  // namespace

RunSummary simulate(const Scenario& scenario, const std::filesystem::path& folder, const Progress& progress) {
  const System system = compile(scenario);
  RunSummary summary = start_summary(system);
  const Stopwatch watch;
  RunStart start;
  start.assembled = assemble(system, [&](const ProgressReport& r) {
    return !progress || progress({k_assembly_share * r.fraction, r.what});
  });
  start.assembly_wall_time = watch.seconds();

  std::filesystem::create_directories(folder);
  const FolderLock lock(folder);
  std::filesystem::remove(folder / "checkpoint");
  mark_as_running(summary, folder);
  write_inputs(scenario, folder);
  Run run(system, start, folder);
  run.begin();
  return go(run, summary, folder, [&](const ProgressReport& r) {
    return !progress || progress({k_assembly_share + (1.0 - k_assembly_share) * r.fraction, r.what});
  });
}

RunSummary resume(const Scenario& scenario, const std::filesystem::path& folder, const Progress& progress) {
  const FolderLock lock(folder);
  refuse_ended(folder);
  const System system = compile(scenario);
  RunSummary summary = start_summary(system);
  CheckpointReader checkpoint = read_checkpoint(folder, identity_of(scenario));
  RunStart start;
  checkpoint(start);
  Run run(system, start, folder);
  run.take(checkpoint);
  mark_as_running(summary, folder);
  return go(run, summary, folder, progress);
}

}  // namespace grouser
