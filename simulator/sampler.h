#pragma once
#include <algorithm>
#include <vector>

#include "simulator/channels.h"

namespace grouser {

/// Writes one of the sampled tables at a constant rate, between accepted states.
class Sampler {
 public:
  /// rate [Hz]
  Sampler(const ChannelRows& rows, RunTable table, double rate, RunWriter& writer)
      : rows_(rows), table_(table), period_(1.0 / rate), writer_(writer) {}

  [[nodiscard]] bool due(double time) const {
    return static_cast<double>(count_) * period_ <= time * (1.0 + 1e-12) + 1e-12;
  }

  /// Writes the rows due in (previous, now]. Returns true if any was written.
  bool write(const Snapshot& previous, const Snapshot& now) {
    if (!due(now.state.time)) return false;
    rows_.fill(table_, previous, before_);
    rows_.fill(table_, now, after_);
    const double span = now.state.time - previous.state.time;
    for (; due(now.state.time); ++count_) {
      const double at = static_cast<double>(count_) * period_;
      rows_.blend(table_, before_, after_, span > 0.0 ? std::clamp((at - previous.state.time) / span, 0.0, 1.0) : 1.0,
                  row_);
      row_[0] = at;
      writer_.append(static_cast<std::size_t>(table_), row_);
    }
    return true;
  }

  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(count_);
    a.require(count_ == static_cast<long>(writer_.rows().at(static_cast<std::size_t>(table_))), "the rows of run.h5");
  }

 private:
  const ChannelRows& rows_;
  RunTable table_;
  double period_;
  RunWriter& writer_;
  long count_ = 0;
  std::vector<double> before_, after_, row_;
};

}  // namespace grouser
