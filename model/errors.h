#pragma once
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace grouser {

/// Text of a file as one line that a terminal shows and does not obey: control characters and bytes that are no UTF-8
/// as
/// `\x1b`, a very long text cut.
[[nodiscard]] std::string printable(std::string_view text);

/// One thing that is wrong in an input, with the evidence.
struct InputFinding {
  std::string file;      ///< path as the user gave it
  std::string place;     ///< JSON pointer ("/tracks/left/pitch_mm") or "row 12, column force_kN"; empty = whole file
  std::string expected;  ///< "a length > 0"
  std::string found;     ///< "-194"
  std::string hint;      ///< "did you mean pitch_mm?"; may be empty

  /// `vehicle.json#/tracks/left/pitch_mm: expected a length > 0, found -194 (hint)`
  [[nodiscard]] std::string text() const;
};

/// All findings of one or more inputs. Exit code 3.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<InputFinding> findings);
  explicit InputError(InputFinding finding) : InputError(std::vector{std::move(finding)}) {}
  [[nodiscard]] const std::vector<InputFinding>& findings() const { return findings_; }

 private:
  std::vector<InputFinding> findings_;
};

/// A computation that did not reach its result (fit not optimal, assembly not closed). Exit code 4.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that could not be read or written (permission, disk, vanished). Exit code 5.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace grouser
