#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "model/run.h"
#include "simulator/energy_book.h"
#include "simulator/step.h"

/// What a run writes to run.h5, declared and filled in one place.
namespace grouser {

enum class RunTable : std::size_t { samples = 0, steps = 1, probes = 2 };

/// One accepted state as output sees it.
struct Snapshot {
  const State& state;
  const Workspace& work;
  const Acceleration& acceleration;
  const EnergyBook& book;
};

/// Fills rows of the three tables. Rows between two accepted states are interpolated linearly (quaternions
/// renormalised), so that output never changes the steps.
class ChannelRows {
 public:
  explicit ChannelRows(const System& system);
  [[nodiscard]] const std::vector<ChannelTable>& tables() const { return tables_; }
  [[nodiscard]] std::map<std::string, std::vector<std::string>> names() const;

  /// Row of `samples` / `probes` at one accepted state.
  void fill(RunTable table, const Snapshot& at, std::vector<double>& row) const;
  /// row = (1 - weight) a + weight b, quaternions renormalised.
  void blend(RunTable table, std::span<const double> a, std::span<const double> b, double weight,
             std::vector<double>& row) const;

 private:
  const System& system_;
  std::vector<ChannelTable> tables_;
  std::vector<std::size_t> quaternions_;  ///< first columns in `samples`
};

}  // namespace grouser
