#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "model/progress.h"
#include "model/run.h"
#include "render/image.h"

namespace grouser {

struct RenderOptions {
  int width = 1280, height = 720;  ///< even
  double fps = 30.0;
  std::string camera = "chase";  ///< see camera_names()
};

[[nodiscard]] std::vector<std::string> camera_names();

/// One picture of the vehicle at time t [s] of the run (nearest sample, interpolated).
[[nodiscard]] Image render_still(const RunFolder& run, double time, const RenderOptions& options = {});

/// frame_000000.png ... into the folder. Returns the number of frames.
int render_frames(const RunFolder& run, const std::filesystem::path& folder, const RenderOptions& options = {},
                  const Progress& progress = {});

/// H.264 MP4 (avc1), read back and checked (count, size). Returns the number of frames. Throws FileError.
int render_film(const RunFolder& run, const std::filesystem::path& file, const RenderOptions& options = {},
                const Progress& progress = {});

}  // namespace grouser
