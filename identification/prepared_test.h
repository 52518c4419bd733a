#pragma once
#include <string>
#include <vector>

#include "identification/loop_measures.h"
#include "model/fit.h"
#include "model/rig.h"

namespace grouser {

/// One closed cycle of a test, or the one open ramp of a static test that never comes back.
struct Cycle {
  CycleSpan span;
  bool open = false;  ///< encloses no area: tells stiffness, not dissipation
  int part = 0;       ///< of a record that is cut at jumps, counted from 0
  int block = 0;      ///< amplitude block within the test, counted from 0
  bool used = false;
  std::string note;        ///< why not used
  double amplitude = 0.0;  ///< half displacement range, m or rad
  double centre = 0.0;     ///< middle of the displacement range
  LoopMeasures measured;
  /// False: so long before the first used cycle that its samples are left out of the prepared ones; its span is empty.
  [[nodiscard]] bool followed() const { return span.end > span.begin; }
};

/// A test as the fit sees it: displacement of one bushing without the rig's share, about 400 samples a cycle at most,
/// cycles cut and sorted. The record begins at most ten cycles before the first used one.
struct PreparedTest {
  const RigTest* source = nullptr;
  std::vector<double> time;          ///< s, strictly rising; rounding of the file's column removed
  std::vector<double> displacement;  ///< m or rad of one bushing, smoothed when noise would enter the histories
  std::vector<double> force;         ///< N or N m of the specimen
  std::vector<double> temperature;   ///< K; may be empty
  std::vector<double> smooth_force;  ///< for force ranges only
  double noise_displacement = 0.0, noise_force = 0.0;
  bool rate_known = false;  ///< false: only the order of the samples is known
  double cycle_rate = 0.0;  ///< cycles per unit of `time`, fitted: per sample of the file where the rate is unknown
  double frequency = 0.0;   ///< Hz; cycles a second for ramps; 0 where the rate is unknown
  double sine_residual_displacement = 0.0, sine_residual_force = 0.0;  ///< see SineFit; 0 for ramps
  std::vector<Cycle> cycles;
  int blocks = 0;
  std::string unusable;  ///< why the whole test stays out of the fit; empty = it is in

  [[nodiscard]] int cycles_used() const;
};

/// Adds storage and loss stiffness of a force over one cycle of the test's displacement, at the fitted frequency; where
/// the rate is unknown, at one turn a cycle. Ramps have none.
void add_dynamic_stiffness(const PreparedTest& test, const Cycle& cycle, const std::vector<double>& force,
                           LoopMeasures& measures);

/// Random part of one cycle's loop area [J]: force noise on every step of the displacement.
[[nodiscard]] double energy_noise(const PreparedTest& test, const Cycle& cycle);

/// Applies the corrections that the rig file asks for, cuts cycles, measures them, decides which enter the fit; adds to
/// `warnings` what the data show (drift, clipped sensor, swapped columns, reversed polarity, wrong frequency, ...) and
/// to `corrections` what was put right and by how much.
[[nodiscard]] PreparedTest prepare_test(const RigTest& test, const RigRecord& rig, std::vector<FitWarning>& warnings,
                                        std::vector<AppliedCorrection>& corrections);

}  // namespace grouser
