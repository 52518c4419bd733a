#pragma once
#include <filesystem>
#include <mutex>

namespace grouser {

/// Throws FileError for an HDF5 file that is not as a run's is: damaged, of another program, or made to do harm. HDF5
/// itself crashes on some such files, reads whatever file they name, and allocates whatever size they claim. So the
/// file's whole structure is read once in a process of its own that may crash, with a limit on memory and time; and
/// only what cannot lead further is let through: plain datasets of 32- or 64-bit numbers and texts, stored in the file
/// itself, chunks of sane size that are whole to the byte, no more values than the bytes stored can hold.
void survey_hdf5(const std::filesystem::path& file);

/// To be held by whoever calls HDF5 on a thread of its own: survey_hdf5() forks, and the child would wait for ever for
/// HDF5's own lock if another thread held it at that moment.
[[nodiscard]] std::mutex& hdf5_fork_mutex();

}  // namespace grouser
