#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/bushing.h"
#include "model/rig.h"

namespace grouser {

/// Loop measures by definition. SI: N/m (or N m/rad), J, N s/m (or N m s/rad).
struct LoopMeasures {
  double effective_stiffness = 0.0;  ///< force range / displacement range
  double dissipated_energy = 0.0;    ///< loop area
  double equivalent_damping = 0.0;   ///< E / (pi omega X^2); 0 where no frequency is known
  double loss_factor = 0.0;          ///< E / (pi k X^2)
  double secant_stiffness = 0.0;     ///< (F at largest x - F at smallest x) / displacement range
  /// First harmonic of force over first harmonic of displacement at the fitted frequency: K' in phase, K'' = eta K' in
  /// quadrature. 0 for ramps.
  double storage_stiffness = 0.0;
  double loss_stiffness = 0.0;
};

struct CycleFit {
  int index = 0;           ///< 1-based, in file order
  bool used = false;       ///< entered the fit
  std::string note;        ///< why not: "conditioning", "transition", "discarded by the rig file"
  double amplitude = 0.0;  ///< half displacement range
  LoopMeasures measured;
  LoopMeasures fitted;
  double nrmse = 0.0;  ///< of this cycle, fraction of its force range
};

/// Measured and fitted loop for the plots, decimated, SI.
struct LoopCurve {
  std::vector<double> displacement, force, fitted;
};

struct TestFit {
  std::string name;
  Axis axis = Axis::x;
  TestKind kind = TestKind::cyclic;
  bool prediction =
      false;  ///< nothing was measured: there is `fitted` alone; measures, errors and force stay 0 or empty
  long samples = 0;
  int cycles = 0;
  int cycles_used = 0;
  double frequency = 0.0;  ///< Hz, fitted from the data; 0 where unknown
  double amplitude = 0.0;  ///< mean of the used cycles
  LoopMeasures measured;   ///< mean over the used cycles
  LoopMeasures fitted;
  double nrmse = 0.0;  ///< over the used samples, fraction of the force range
  double r_squared = 0.0;
  double gain = 0.0;         ///< by what fraction this test's force is larger than the law's (remounting, conditioning)
  double weight = 1.0;       ///< robust weight in the joint fit, 1 = full say
  double force_zero = 0.0;   ///< offset of the force's zero, taken out in the fit, N or N m
  double force_drift = 0.0;  ///< change of that zero over the used cycles, taken out in the fit, N or N m
  double left_out_nrmse = 0.0;  ///< of this test by a law fitted to all the others; 0 = not computed
  std::vector<CycleFit> per_cycle;
  LoopCurve curve;
};

/// One fitted coefficient.
struct FitParameter {
  std::string name;  ///< "spring.increment[3]", "stop[1].stiffness", "maxwell[0].relaxation_time"
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 % interval
  bool identified = true;        ///< false: the data cannot tell it from others
};

struct SolverSummary {
  std::string termination;  ///< "CONVERGENCE" ...
  int iterations = 0;
  double initial_cost = 0.0, final_cost = 0.0;
  double kkt_residual = 0.0;  ///< largest violation of the optimality conditions, relative
  int starts = 1;             ///< different starts tried; the best is kept
};

/// Response that the data do determine, with its 95 % band.
struct BandPoint {
  double x = 0.0, value = 0.0, low = 0.0, high = 0.0;
};

/// A value and its 95 % interval.
struct Interval {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// Settled response to a sine of this amplitude and frequency, one cell of the campaign's grid.
struct ResponsePoint {
  double amplitude = 0.0;                      ///< m or rad
  double frequency = 0.0;                      ///< Hz; 0: no rate is known
  Interval energy;                             ///< J a cycle
  Interval storage_stiffness, loss_stiffness;  ///< N/m or N m/rad
  Interval loss_factor;
};

/// One choice of the law's size and its error on tests that it was not fitted to.
struct LawCandidate {
  int spring_intervals = 0, stops = 0, branches = 0;
  bool strain_dependent_yield = false;
  /// Typical error on a left-out test, as a fraction of its force range: force and energy errors together, where 5 % of
  /// energy counts as much as 3 % of force; a mean of logarithms over tests, so that no single test decides it.
  double left_out_error = 0.0;
  bool chosen = false;
};

/// Play and hard stops that the backbone shows; absent where it shows none.
struct Clearance {
  double low = 0.0, high = 0.0;  ///< m or rad: between them the joint hardly resists
  double stiffness_ratio = 0.0;  ///< inside over outside
};
struct HardStop {
  double at = 0.0;               ///< m or rad: beyond it the joint hardly yields
  double stiffness_ratio = 0.0;  ///< beyond over before
};

struct AxisFit {
  Axis axis = Axis::x;
  std::vector<FitParameter> parameters;
  std::vector<std::vector<double>> covariance;  ///< in the order of `parameters`
  double condition_number = 0.0;
  std::vector<std::string> not_identified;  ///< sentences
  SolverSummary solver;
  std::vector<BandPoint> backbone;       ///< displacement -> force
  std::vector<BandPoint> tangent;        ///< displacement -> stiffness over the stated window
  double tangent_window = 0.0;           ///< half width, m or rad
  std::vector<ResponsePoint> responses;  ///< amplitude by amplitude, frequency ascending within
  std::vector<LawCandidate> selection;
  std::optional<Clearance> clearance;
  std::vector<HardStop> hard_stops;
  double preset = 0.0;  ///< m or rad: middle that the loops run about
  int draws = 0;        ///< bushings drawn for the intervals
};

struct FitWarning {
  std::string code;  ///< "drift", "clipped_sensor", "swapped_columns", "reversed_polarity", "wrong_frequency",
                     ///< "wrong_amplitude", "time_gap", "offset", "backlash", "preload", "conditioning_cycles",
                     ///< "trailing_cycles", "phase_break", "thermal_softening", "unsettled_cycles",
                     ///< "transition_cycles", "few_samples", "tilted_specimen", "rate_unknown", "open_ramp",
                     ///< "unusable_test", "axis_without_test", "no_measurement"
  std::string test;  ///< empty: whole campaign
  std::string text;  ///< a sentence with the evidence
};

/// What was put right before the fit because the rig file asks for it.
struct AppliedCorrection {
  std::string code;  ///< name_of(CorrectionKind), or "rig_compliance", "bushings_in_series", "moving_mass", "thermal"
  std::string test;  ///< empty: whole campaign
  std::string text;  ///< a sentence with the amount
};

/// How we know (fit.json). The bushing itself stands in bushing.json.
struct FitRecord {
  std::string specimen;
  bool synthetic = false;
  std::string synthetic_note;
  std::vector<TestFit> tests;
  std::vector<AxisFit> axes;
  std::vector<FitWarning> warnings;
  std::vector<AppliedCorrection> corrections;
  double calibration_residual = 0.0;  ///< fraction of full scale, largest of all sensors
  Provenance provenance;
};

[[nodiscard]] FitRecord read_fit(const std::filesystem::path& file);
void write_fit(const FitRecord& fit, const std::filesystem::path& file);

}  // namespace grouser
