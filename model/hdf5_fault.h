#pragma once
#include <filesystem>
#include <string>

namespace grouser {

/// What is wrong with an HDF5 file that is to be a run's, empty for nothing: links that lead elsewhere, types, shapes
/// and sizes that no run has, chunks that are not whole to the byte. HDF5 may crash, hang, or allocate whatever the
/// file claims: survey_hdf5() calls it in a process of its own. Throws what the standard library throws.
[[nodiscard]] std::string fault_of_hdf5(const std::filesystem::path& file);

}  // namespace grouser
