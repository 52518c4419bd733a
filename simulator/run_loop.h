#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "model/progress.h"
#include "simulator/checkpoint.h"
#include "simulator/energy_watch.h"
#include "simulator/run_recorder.h"
#include "simulator/stopwatch.h"
#include "simulator/track_watch.h"

namespace grouser {

/// What is known of a run when its first step is due, and what a resumed one starts from.
struct RunStart {
  Assembled assembled;
  double assembly_wall_time = 0.0;     ///< s
  double wall_time = 0.0;              ///< s, of the parts before
  std::vector<std::size_t> kept_rows;  ///< of run.h5, by table; empty for a run from its beginning
};

template <typename Archive>
void archive(Archive& a, RunStart& start) {
  auto& [assembled, assembly_wall_time, wall_time, kept_rows] = start;
  a(assembled, assembly_wall_time, wall_time, kept_rows);
}

/// A run from its assembled state to its end.
class RunLoop {
 public:
  RunLoop(const System& system, const RunStart& start, const std::filesystem::path& folder);

  /// Writes the state of time 0.
  void begin();
  /// Takes over the memory of the run so far. Throws InputError when this program finds other accelerations; the run so
  /// far stays as it was then.
  void take(CheckpointReader& checkpoint);
  /// Steps to the end; returns the status and fills the summary's message.
  [[nodiscard]] RunStatus go(const Progress& progress, RunSummary& summary);
  /// Closes the channels and fills the summary's figures.
  void finish(RunSummary& summary);

  /// What it remembers from step to step.
  template <typename Archive>
  void archive(Archive& a) {
    auto& [accepted, min, mean, max] = steps_;
    a(stepper_, book_, recorder_, track_watch_, energy_watch_, accepted, min, mean, max, saved_);
  }

 private:
  [[nodiscard]] std::vector<double> corners() const;
  /// One step. Returns the reason where it ends the run as failed.
  [[nodiscard]] std::optional<std::string> advance_to(double until);
  [[nodiscard]] RunMeasures measures() const;
  bool report(const Progress& progress, RunSummary& summary) const;
  void keep();
  void save();
  [[nodiscard]] Snapshot snapshot() const {
    return {stepper_.state(), stepper_.work(), stepper_.acceleration(), book_};
  }

  const System& system_;
  const RunStart& start_;
  std::filesystem::path folder_;
  CheckpointIdentity identity_;
  Stopwatch watch_;
  Stepper stepper_;
  EnergyBook book_, previous_book_;
  RunRecorder recorder_;
  TrackWatch track_watch_;
  EnergyWatch energy_watch_;
  double saved_ = -std::numeric_limits<double>::infinity();  // s, time of the last checkpoint; the first is due at once
  struct {
    long accepted = 0;
    double min = 1.0, mean = 0.0, max = 0.0;
  } steps_;
};

/// What a user must know of a run that is otherwise sound: rubber deflected further than was measured, a span that
/// went slack. Begins with "; ", empty when there is nothing.
[[nodiscard]] std::string remarks(const System& system, const RunMeasures& measures);

}  // namespace grouser
