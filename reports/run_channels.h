#pragma once
#include <string>
#include <vector>

#include "model/run.h"
#include "model/run_columns.h"
#include "reports/common_base.h"

/// Everything of a run that can be held against a measurement or another run, by name.
namespace grouser {

/// One curve over time that a run holds or that follows from what it holds.
struct RunChannel {
  std::string name;     ///< "speed", "sprocket_torque_left", "chassis_velocity_x"
  std::string unit;     ///< SI
  std::string meaning;  ///< what it is, in which frame, with which sign
  RunColumn column;     ///< where it stands; of a derived channel the dataset is empty
};

/// Derived channels (speed, yaw rate, ...), then every column of run.h5 that stands over time.
[[nodiscard]] std::vector<RunChannel> channels_of(const RunFolder& run);
/// Throws InputError naming run.h5 and the dataset when the run does not hold it.
[[nodiscard]] TimeSeries read_channel(const RunFolder& run, const RunChannel& channel);

/// Channels that a name may mean: its own name; else the name of a column within its dataset, as exported files call
/// it. Of those the ones of `dataset` (flat name), where there are any.
[[nodiscard]] std::vector<const RunChannel*> channels_called(const std::vector<RunChannel>& channels,
                                                             const std::string& name, const std::string& dataset = "");

/// What runs are compared by, as far as this one holds it: drive, tension of the track, torque.
[[nodiscard]] std::vector<RunChannel> main_channels(const RunFolder& run);

/// A unit that figures can show so large a value in.
struct ShownUnit {
  std::string unit;  ///< "kN"
  double scale;      ///< from SI
};
[[nodiscard]] ShownUnit shown_unit(const std::string& unit, double largest);

}  // namespace grouser
