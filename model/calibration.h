#pragma once
#include "model/rig.h"

namespace grouser {

/// SI quantity that belongs to a raw SI reading.
[[nodiscard]] double calibrated(const SensorCalibration& calibration, double reading);

}  // namespace grouser
