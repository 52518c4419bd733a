#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "model/fit.h"
#include "model/run.h"
#include "render/figure.h"

namespace grouser {

/// Names of the figures that a run folder can show ("step_size", "tension", "contact_forces", ...), with a line on
/// each.
struct FigureEntry {
  std::string name, meaning;
};
[[nodiscard]] std::vector<FigureEntry> run_figures();
/// Throws InputError for an unknown name.
[[nodiscard]] Figure make_run_figure(const RunFolder& run, const std::string& name);

/// One HTML file (and the same numbers in a .json beside it) over fit, virtual rig and run folders in any mix.
/// Uses DIR/film.mp4 of a run folder when it is there. Written whole or not at all.
void write_report(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& html_file);

/// The demo's front page: links the reports of its folders, with headline numbers and pictures.
void write_index(const std::filesystem::path& folder);

}  // namespace grouser
