#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "model/run.h"

/// The columns of run.h5 by name: as `grouser export` writes them and as measured channels are called.
namespace grouser {

/// One value of a dataset's row.
struct RunColumn {
  std::string dataset;             ///< "/probes/right_20/bushing_force"
  std::vector<std::size_t> index;  ///< behind the row: {0}
  std::string name;                ///< within its dataset, without the unit: "bushing_force_x"
  std::string unit;                ///< "N"
};

/// All values of a row, in the order of storage. Entries are called by the names that the file gives ("left/arm_1"),
/// by components of vectors, by the sides of a pair, else by their index.
[[nodiscard]] std::vector<RunColumn> columns_of(const RunReader& run, const std::string& dataset);

/// Datasets of words end so: /joints/names, /steps/limit_names.
[[nodiscard]] bool holds_names(const std::string& dataset);
/// "/probes/right_20/bushing_force" -> "probes_right_20_bushing_force": the file of a dataset, and what makes a
/// column's name one among all.
[[nodiscard]] std::string flat_name(const std::string& dataset);
/// "N m/rad" -> "N_m_per_rad": the spelling of columns in files, which the readers understand; empty for "1".
[[nodiscard]] std::string unit_suffix(const std::string& unit);
/// The dataset `time` that belongs to a dataset: the nearest one up its groups with as many rows. Empty: it is a time,
/// or none fits.
[[nodiscard]] std::string time_of(const RunReader& run, const std::string& dataset, std::size_t rows);

}  // namespace grouser
