#pragma once
#include <optional>
#include <vector>

#include "identification/prepared_test.h"

namespace grouser {

/// Whether the rig file asks for a correction, for all its tests or for this one.
[[nodiscard]] bool asks_for(const RigTest& test, CorrectionKind kind);

/// What holds sample by sample: the load cell's sign, and force at the reference temperature
/// F_ref = F / (1 + a (T - T_ref)). Each correction adds a sentence with its amount.
void correct_readings(const RigTest& test, const RigRecord& rig, Signals& record,
                      std::vector<AppliedCorrection>& corrections);

/// From the columns of the rig to one bushing; needs the cycles, and for the first the fitted frequency:
/// - force = cell - m x'': the load cell sits at the moving side and drives the moving parts too, both counted along
/// +x.
///   x'' comes from the harmonics of each cycle, never from differences of noisy samples. Ramps have none.
/// - displacement = (column - C F) / n: rig compliance C (m/N, or rad/(N m) for rotations) and n bushings in series.
void correct_rig(PreparedTest& test, const RigRecord& rig, std::vector<AppliedCorrection>& corrections);

/// What correct_rig did for every test alike (compliance, bushings in series), a sentence each with the largest amount.
[[nodiscard]] std::vector<AppliedCorrection> campaign_corrections(const std::vector<PreparedTest>& tests,
                                                                  const RigRecord& rig);

/// remove_creep and remove_backlash: both belong to the displacement.
void correct_displacement(PreparedTest& test, std::vector<AppliedCorrection>& corrections);

/// remove_conditioning; needs measured cycles sorted into blocks.
void correct_conditioning(PreparedTest& test, std::vector<AppliedCorrection>& corrections);

/// Logarithmic creep of the cycles' middles: middle(t) = a + b log(1 + t / t0), t from the first cycle.
struct Creep {
  double rate = 0.0;      ///< b, m or rad
  double time = 0.0;      ///< t0, s
  double start = 0.0;     ///< when it begins, s
  double residual = 0.0;  ///< rms of the middles about it
  [[nodiscard]] double at(double t) const;
};
[[nodiscard]] std::optional<Creep> fit_creep(const PreparedTest& test);

/// Free play of a fixture: the force stands while the displacement crosses a gap, in both directions at the same force.
struct Play {
  double width = 0.0;      ///< m or rad, of one bushing
  double force = 0.0;      ///< at which the force stands
  double band = 0.0;       ///< half width of the force band taken for standing
  double slackness = 0.0;  ///< path in that band over the path that the stiffness beside it would need
};
/// From the later half of the closed cycles; none where no piece of both branches is eight times slacker than its
/// surroundings (a pure cubic spring: 5.6 times) and longer than 3 % of the range.
[[nodiscard]] std::optional<Play> find_play(const PreparedTest& test);

/// Decay of the force range over the cycles k = 0.5, 1.5 ... of a block: range = settled (1 + share exp(-k / cycles)).
struct Conditioning {
  double settled = 0.0, share = 0.0, cycles = 0.0;
};
[[nodiscard]] std::optional<Conditioning> fit_conditioning(const std::vector<double>& force_ranges);

}  // namespace grouser
