#pragma once
#include <array>
#include <vector>

#include "model/bushing.h"
#include "model/rig.h"

namespace grouser {

/// What the load cell of the virtual rig reads at every sample: forces x, y, z [N] and moments rx, ry, rz [N m] on the
/// clamped link at the pin, in its frame; positive where the bushing resists a positive displacement.
using RigWrench = std::array<std::vector<double>, k_num_axes>;

/// The virtual rig: the bushing element of the vehicle run (bushing_forces, the very kernel) between two link bodies,
/// one clamped, the other moved along `axis` alone through `displacement` [m or rad] at the times `time` [s,
/// non-decreasing]. The rubber is relaxed at the first sample and its memory is committed at every other, as in a run.
///
/// One step a sample: between samples the displacement moves at a constant rate, for which the updates of stops and
/// Maxwell branches are exact; with AxisLaw::yield_growth they are of second order in the step.
///
/// Along x, y, z and about the hinge ry (any angle) the displacement is the very coordinate of the law. About rx and rz
/// the element's coordinate is 2 sin(angle / 2): its moment differs from the law of the angle by angle^2 / 6 of it at
/// most, 4e-6 at 0.3 degree.
///
/// Axes other than `axis` may have no law; they are free. `axis` must have one.
[[nodiscard]] RigWrench run_virtual_rig(const Bushing& bushing, Axis axis, const std::vector<double>& time,
                                        const std::vector<double>& displacement);

/// Drives a test by its protocol (see TestProtocol) and returns it with the samples recorded: time, displacement and
/// the load on the tested axis. Displacement goes through equal steps on every way out and back, at a constant rate.
///
/// A ramp turns where the load meets `to_force` within k_turn_tolerance of its change since the first sample; the turn
/// is searched from the state in which the ramp sets out, which only the accepted steps change. Its load grows
/// monotonically, for spring, stops and branches only ever add to it at a constant rate. Throws NumericalError where no
/// displacement up to 1000 times the reach of the law's points has that load.
[[nodiscard]] RigTest run_protocol(const Bushing& bushing, const RigTest& test);
inline constexpr double k_turn_tolerance = 1e-6;

}  // namespace grouser
