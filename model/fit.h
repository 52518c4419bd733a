#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "model/bushing.h"
#include "model/rig.h"

namespace grouser {

/// Loop measures by definition (D 6.1). SI: N/m (or N m/rad), J, N s/m (or N m s/rad).
struct LoopMeasures {
  double effective_stiffness = 0.0;  ///< force range / displacement range
  double dissipated_energy = 0.0;    ///< loop area
  double equivalent_damping = 0.0;   ///< E / (pi omega X^2); 0 where no frequency is known
  double loss_factor = 0.0;          ///< E / (pi k X^2)
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
  long samples = 0;
  int cycles = 0;
  int cycles_used = 0;
  double frequency = 0.0;  ///< Hz, fitted from the data; 0 where unknown
  double amplitude = 0.0;  ///< mean of the used cycles
  LoopMeasures measured;   ///< mean over the used cycles
  LoopMeasures fitted;
  double nrmse = 0.0;  ///< over the used samples, fraction of the force range
  double r_squared = 0.0;
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
};

/// Response that the data do determine, with its 95 % band.
struct BandPoint {
  double x = 0.0, value = 0.0, low = 0.0, high = 0.0;
};

struct AxisFit {
  Axis axis = Axis::x;
  std::vector<FitParameter> parameters;
  std::vector<std::vector<double>> covariance;  ///< in the order of `parameters`
  double condition_number = 0.0;
  std::vector<std::string> not_identified;  ///< sentences
  SolverSummary solver;
  std::vector<BandPoint> backbone;  ///< displacement -> force
  std::vector<BandPoint> tangent;   ///< displacement -> stiffness over the stated window
  double tangent_window = 0.0;      ///< half width, m or rad
};

struct FitWarning {
  std::string code;  ///< "drift", "clipped_sensor", "swapped_columns", "reversed_polarity", "wrong_frequency",
                     ///< "wrong_amplitude", "time_gap", "unsettled_cycles", "transition_cycles", "few_samples",
                     ///< "tilted_specimen", "rate_unknown", "open_ramp", "unusable_test", "axis_without_test"
  std::string test;  ///< empty: whole campaign
  std::string text;  ///< a sentence with the evidence
};

/// How we know (fit.json). The bushing itself stands in bushing.json.
struct FitRecord {
  std::string specimen;
  bool synthetic = false;
  std::string synthetic_note;
  std::vector<TestFit> tests;
  std::vector<AxisFit> axes;
  std::vector<FitWarning> warnings;
  double calibration_residual = 0.0;  ///< fraction of full scale, largest of all sensors
  Provenance provenance;
};

[[nodiscard]] FitRecord read_fit(const std::filesystem::path& file);
void write_fit(const FitRecord& fit, const std::filesystem::path& file);

}  // namespace grouser
