#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/camera_view.h"
#include "model/progress.h"
#include "model/run.h"
#include "render/image.h"

namespace grouser {

struct RenderOptions {
  int width = 1280, height = 720;  ///< even
  double fps = 30.0;
  double speed = 1.0;                 ///< seconds of the run that pass in a second of the film; below 1: slow motion
  std::string camera = "chase";       ///< see camera_names()
  std::optional<CameraView> view;     ///< in place of a named camera
  std::vector<std::string> overlays;  ///< see overlay_names()
};

[[nodiscard]] std::vector<std::string> camera_names();

/// What can be drawn over the vehicle: `forces` (arrows of the contact forces on the links, by partner), `tension`
/// (links coloured by the tension that they carry), `pressure` (nominal ground pressure under each link), `paths`
/// (where the first and last road wheels' axles have been).
[[nodiscard]] std::vector<std::string> overlay_names();

/// Side by side from left to right, on one clock; a run that has ended stands still.
using Runs = std::vector<const RunFolder*>;

/// One picture at time t [s] of the runs (between samples interpolated, held at their ends).
[[nodiscard]] Image render_still(const Runs& runs, double time, const RenderOptions& options = {});

/// frame_000000.png ... into the folder; goes on where it was stopped when asked for the same again. Returns the number
/// of frames that stand there.
int render_frames(const Runs& runs, const std::filesystem::path& folder, const RenderOptions& options = {},
                  const Progress& progress = {});

/// H.264 MP4 (avc1), read back and checked (count, size, more than one colour). Until it is whole its frames are kept
/// beside it, so that a stopped film goes on where it was. Returns the number of frames, 0 when stopped. Throws
/// FileError.
int render_film(const Runs& runs, const std::filesystem::path& file, const RenderOptions& options = {},
                const Progress& progress = {});

/// Stands as text in every film that render_film makes of these runs: a digest of what their pictures show, whatever
/// the camera. Wherever a film was copied to, and when, this tells whether it shows a run as it is now.
[[nodiscard]] std::string film_mark(const Runs& runs);
[[nodiscard]] inline std::string film_mark(const RunFolder& run) { return film_mark(Runs{&run}); }

[[nodiscard]] inline Image render_still(const RunFolder& run, double time, const RenderOptions& options = {}) {
  return render_still(Runs{&run}, time, options);
}
inline int render_film(const RunFolder& run, const std::filesystem::path& file, const RenderOptions& options = {},
                       const Progress& progress = {}) {
  return render_film(Runs{&run}, file, options, progress);
}

}  // namespace grouser
