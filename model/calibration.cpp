#include "model/calibration.h"

#include <algorithm>
#include <cmath>

namespace grouser {

double calibrated(const SensorCalibration& calibration, double reading) {
  const double above_offset = reading - calibration.offset;
  double higher_orders = 0.0;
  for (auto c = calibration.linearity.rbegin(); c != calibration.linearity.rend(); ++c) {
    higher_orders = (higher_orders + *c) * above_offset;
  }
  return above_offset * (calibration.sensitivity + higher_orders);
}

double calibration_residual(const SensorCalibration& calibration) {
  double residual = 0.0, full_scale = 0.0;
  for (std::size_t i = 0; i < calibration.record_reading.size(); ++i) {
    const double reference = calibration.record_quantity[i];
    residual = std::max(residual, std::abs(calibrated(calibration, calibration.record_reading[i]) - reference));
    full_scale = std::max(full_scale, std::abs(reference));
  }
  return full_scale > 0.0 ? residual / full_scale : 0.0;
}

}  // namespace grouser
