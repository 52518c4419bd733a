#pragma once
#include <array>
#include <complex>
#include <vector>

#include "identification/signal.h"
#include "model/fit.h"

namespace grouser {

/// Time, displacement and force of a record, sample by sample; SI and radians. `temperature` [K] may be empty.
struct Signals {
  std::vector<double> time, displacement, force, temperature;
};

/// Loop measures by definition of samples begin..end, closed by the chord; storage and loss stiffness stay 0.
/// `force_for_range`: the force without noise that would widen its range. frequency 0 = unknown. The force at an
/// extreme displacement, for the secant, is the mean over the samples within 3 `noise` of it: on the flat crest of a
/// sine, noise chooses one of many, and the force changes between them. What would be divided by a
/// displacement or a force that stands still is 0.
[[nodiscard]] LoopMeasures loop_measures(const std::vector<double>& displacement, const std::vector<double>& force,
                                         const std::vector<double>& force_for_range, CycleSpan span, double frequency,
                                         double noise = 0.0);

/// Harmonics of a signal whose fundamental is known: offset + drift t + Re sum_k amplitude[k-1] exp(i k omega t),
/// fitted together by least squares, so that neither offset nor drift nor a cut between two samples leaks into them. t
/// counts from the span's first sample.
struct Harmonics {
  static constexpr int k_count = 5;
  double offset = 0.0, drift = 0.0;
  std::array<std::complex<double>, k_count> amplitude{};
  double residual = 0.0;  ///< rms of what they leave
};
[[nodiscard]] Harmonics fit_harmonics(const std::vector<double>& time, const std::vector<double>& signal,
                                      CycleSpan span, double frequency);

/// First harmonic of force over first harmonic of displacement: K* = K' + i K''.
[[nodiscard]] std::complex<double> dynamic_stiffness(const std::vector<double>& time,
                                                     const std::vector<double>& displacement,
                                                     const std::vector<double>& force, CycleSpan span,
                                                     double frequency);

}  // namespace grouser
