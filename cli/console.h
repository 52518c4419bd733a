#pragma once
#include <string>
#include <string_view>

#include "model/progress.h"

namespace grouser::cli {

/// `text` as a terminal shows and does not obey it, whole: names out of files come to it by many ways.
[[nodiscard]] std::string for_terminal(std::string_view text);

/// Everything that is not a result: errors, notes and progress, on stderr.
class Console {
 public:
  explicit Console(bool quiet) : quiet_(quiet) {}

  /// `grouser: error: text`, also when quiet.
  void error(std::string_view text);
  /// A line on its own that goes with an error.
  void hint(std::string_view text);
  /// `grouser: text`, unless quiet.
  void note(std::string_view text);

  /// A callback for long work: a bar with rate and time left on a terminal, a line every tenth elsewhere, nothing when
  /// quiet. It asks the work to stop once the process was interrupted. The bar goes when the last copy of the callback
  /// does.
  [[nodiscard]] Progress progress(std::string title);

 private:
  bool quiet_;
};

/// `callback` for a part of the work that begins at `from` and ends at `to` of the whole.
[[nodiscard]] Progress part_of(const Progress& callback, double from, double to);

}  // namespace grouser::cli
