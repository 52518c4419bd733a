#pragma once
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <utility>

#include "model/errors.h"

// A run is read while its writer's thread writes.
#ifndef H5_HAVE_THREADSAFE
#error "expected an HDF5 library that was built for threads (Debian's is)"
#endif

namespace grouser {

/// Owner of one HDF5 identifier.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Handle() { reset(); }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }
  /// Lets go of what is not to be closed.
  void release() { id_ = H5I_INVALID_HID; }
  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Call before anything else of HDF5, in every thread that uses it. It prints its error stack by default; ours are
/// exceptions. And at the end of a process it would close once more, and crash on, a file that a full disk kept it from
/// closing.
inline void silence_hdf5() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// As a file with a writer first: after a kill amid a flush its tables point beyond the length that the file states,
/// where HDF5 reads in this mode only. A file that was written otherwise is opened plainly.
[[nodiscard]] inline Hdf5Handle open_hdf5(const std::filesystem::path& file) {
  // HDF5 tries again where a checksum is wrong, for a writer may be at work, and waits twice as long each time: 20
  // times are 1 ms, the 100 of its default never end.
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_metadata_read_attempts(access.id(), 20);
  Hdf5Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id()), H5Fclose);
  if (!opened) opened = Hdf5Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  return opened;
}

/// Why a file could not be opened: the system's reason, or `otherwise` where the system can open it.
[[nodiscard]] std::string why_not_opened(const std::filesystem::path& file, const std::string& otherwise);

/// Type of a text in memory: UTF-8 of any length.
[[nodiscard]] inline Hdf5Handle text_in_memory() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

/// Call right after what HDF5 refused: the reason is the system's where it was a call of the system that failed.
[[noreturn]] void fail_hdf5(const std::string& action, const std::filesystem::path& file);

/// `handle` itself, or a FileError when HDF5 refused.
[[nodiscard]] inline Hdf5Handle checked(Hdf5Handle handle, const std::string& action,
                                        const std::filesystem::path& file) {
  if (!handle) fail_hdf5(action, file);
  return handle;
}

}  // namespace grouser
