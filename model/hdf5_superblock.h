#pragma once
#include <filesystem>

namespace grouser {

/// Makes a file that is being written in HDF5's single-writer mode look closed on the disk: clears the mark "open for
/// writing" and states the file's present length. After a kill the file then opens in every HDF5 program, not only in
/// those that ask for single-writer mode. Call after a flush; HDF5 writes its own marks again with its next change of
/// the superblock. Superblock version 3: HDF5 File Format Specification 3.0, II.A. Throws FileError.
void make_superblock_readable(const std::filesystem::path& file);

}  // namespace grouser
