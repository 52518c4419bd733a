#pragma once
#include <istream>
#include <string>
#include <string_view>

#include "model/sha256.h"

namespace grouser {

/// Lines of a text that is read in pieces, so that memory holds one piece, whatever the length of the text.
class CsvLines {
 public:
  static constexpr std::size_t k_piece = 4u << 20;  ///< bytes; also the longest line

  /// A byte order mark is passed over; `in` must outlive this.
  explicit CsvLines(std::istream& in);

  /// The next line without its line break; it may be looked at until the next call. False at the end, or at a line
  /// longer than a piece (see too_long).
  bool next(std::string_view& line);
  /// Number of the line that next() gave, counted from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] bool too_long() const { return too_long_; }
  /// Of a beginning that is no text ("UTF-16", "binary data"); empty for text.
  [[nodiscard]] const std::string& other_content() const { return other_content_; }
  /// Bytes given out as lines so far, and of the whole stream (0 where it cannot tell).
  [[nodiscard]] std::size_t consumed() const { return read_ - (end_ - begin_); }
  [[nodiscard]] std::size_t total() const { return total_; }
  /// SHA-256 of the whole stream, once all lines were taken.
  [[nodiscard]] std::string sha256() { return digest_.hex(); }

 private:
  bool fill();

  std::istream& in_;
  std::string piece_;
  std::size_t begin_ = 0, end_ = 0;  ///< of what is left in the piece
  std::size_t read_ = 0, total_ = 0, number_ = 0;
  bool too_long_ = false;
  char break_ = '\n';  ///< or '\r', where that alone ends the lines (classic Mac OS)
  std::string other_content_;
  Sha256 digest_;
};

}  // namespace grouser
