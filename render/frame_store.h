#pragma once
#include <filesystem>
#include <string>

#include "render/image.h"
#include "render/render.h"

namespace grouser {

/// What frames are made of: equal digests give equal frames.
[[nodiscard]] std::string frames_digest(const Runs& runs, const RenderOptions& options);

/// Numbered PNG files of a folder, written one after the other. A hidden file beside them says of which digest they are
/// and how many are whole; with another digest they are begun anew.
class FrameStore {
 public:
  /// Makes the folder. Throws FileError.
  FrameStore(std::filesystem::path folder, std::string digest);

  [[nodiscard]] int done() const { return done_; }
  void add(const Image& image);

 private:
  [[nodiscard]] std::filesystem::path file_of(int frame) const;
  [[nodiscard]] std::filesystem::path mark() const { return folder_ / ".frames"; }

  std::filesystem::path folder_;
  std::string digest_;
  int done_ = 0;
};

}  // namespace grouser
