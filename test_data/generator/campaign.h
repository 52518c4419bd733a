#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/fit.h"
#include "model/rig.h"
#include "test_data/generator/rubber.h"

namespace grouser {

inline constexpr std::uint64_t k_campaign_seed = 20261122;

/// Errors of rig, sensors and specimen that one axis' tests share; SI.
struct RigErrors {
  double displacement_noise = 0.0, displacement_quantum = 0.0;  ///< m or rad
  double force_noise = 0.0, force_quantum = 0.0;                ///< N or N m
  double force_offset = 0.0, force_drift = 0.0;                 ///< deviation over tests; drift is over a whole test
  double displacement_zero = 0.0;                               ///< deviation over tests, m or rad
  double remounting_gain = 0.0;                                 ///< relative deviation over tests
  double conditioning = 0.0, conditioning_cycles = 1.0;  ///< extra force of the first cycle, and its decay (Mullins)
  double compliance = 0.0;                               ///< rig's share in the measured displacement, m/N
};

/// One planned test. A ramp runs at constant rate 0 -> high -> low (-> 0), by displacement or, one-sided, up to
/// `peak_force`.
struct PlannedTest {
  std::string name;
  Axis axis = Axis::x;
  TestKind kind = TestKind::cyclic;
  double amplitude = 0.0;   ///< m or rad
  double frequency = 0.0;   ///< Hz, cyclic
  double preset = 0.0;      ///< m or rad, mean of a loop
  double rate = 0.0;        ///< m/s or rad/s, ramp
  double peak_force = 0.0;  ///< N; > 0: tension only, up to this force and back to zero force
  int cycles = 0;
  int samples_per_cycle = 0;
};

/// What the sensors saw and what the settled rubber truly does.
struct GeneratedTest {
  PlannedTest plan;
  std::vector<double> time, displacement, force;      ///< SI; measured: with every error of the rig
  double tilt_per_force = 0.0;                        ///< half difference of two LVDTs, m/N
  LoopMeasures truth;                                 ///< of the last cycle without any error
  double storage_stiffness = 0.0;                     ///< of its fundamental, true
  std::vector<double> true_displacement, true_force;  ///< last cycle
};

/// All tests of one axis with their rubber and rig.
struct AxisCampaign {
  Axis axis = Axis::x;
  TrueRubber rubber;
  RigErrors errors;
  std::vector<PlannedTest> tests;
};

/// The reference campaign: the paper's static test and loops on every axis.
[[nodiscard]] std::vector<AxisCampaign> reference_campaign(std::uint64_t seed = k_campaign_seed);

/// The hinge turned as far as a track throws it: a ramp to +-60 degrees, and loops about the preset of 14 degrees that
/// reach 60, against a metal stop at 52 degrees (ten times the hinge's stiffness beyond) when asked for.
[[nodiscard]] AxisCampaign large_torsion_campaign(bool with_stop, std::uint64_t seed = k_campaign_seed);

/// Runs one test. The random numbers depend on seed and test name alone, so tests can be made in any order.
[[nodiscard]] GeneratedTest run_test(const AxisCampaign& campaign, const PlannedTest& plan,
                                     std::uint64_t seed = k_campaign_seed);

/// Mean of the loading and unloading force of the settled rubber on a slow triangle.
struct Backbone {
  std::vector<double> displacement, force;  ///< SI; force is 0 at displacement 0 for a symmetric range
};
/// Over [low, high] at `period` seconds a cycle, at 41 equal stations.
[[nodiscard]] Backbone true_backbone(const TrueRubber& rubber, double low, double high, double period);
/// Over the stroke of the axis' own static test.
[[nodiscard]] Backbone true_backbone(const AxisCampaign& campaign);

}  // namespace grouser
