#pragma once
#include "model/fit.h"

namespace grouser {

/// Looks for play and hard stops in an axis' backbone and fills clearance and hard_stops.
/// Evidence: three straight pieces fit the backbone at least twice as well as one cubic does, and neighbouring pieces
/// differ at least fourfold in stiffness. Rubber that merely stiffens, even to twice its stiffness, is a cubic. Soft
/// between stiff is play while the soft piece is the smaller part of the range, else two stops. Where stops are found,
/// the part between them is searched for play in the same way; where there is play, the parts beyond it are searched
/// for stops.
void find_joint_limits(AxisFit& fit);

}  // namespace grouser
