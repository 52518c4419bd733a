#include "model/csv_lines.h"

#include <algorithm>
#include <cstring>

namespace grouser {
namespace {

std::size_t size_of(std::istream& in) {
  const auto here = in.tellg();
  in.seekg(0, std::ios::end);
  const auto end = in.tellg();
  in.clear();
  in.seekg(here);
  in.clear();
  return end > here && here >= 0 ? static_cast<std::size_t>(end - here) : 0;
}

/// A small text needs a small piece.
std::size_t piece_for(std::size_t total) {
  constexpr std::size_t k_least = 1u << 16;
  return total == 0 ? CsvLines::k_piece : std::clamp(total + 1, k_least, CsvLines::k_piece);
}

}  // namespace

CsvLines::CsvLines(std::istream& in) : in_(in), total_(size_of(in)) {
  piece_.resize(piece_for(total_));
  fill();
  const std::string_view start(piece_.data(), end_);
  const std::size_t zero = start.find('\0');
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF") || zero < 2) {
    other_content_ = "UTF-16";
  } else if (zero != std::string_view::npos) {
    other_content_ = "binary data";
  }
  if (start.starts_with("\xEF\xBB\xBF")) begin_ = 3;
  if (start.find('\n') == std::string_view::npos && start.find('\r') != std::string_view::npos) break_ = '\r';
}

/// Moves what is left to the front of the piece and reads on; false when nothing came.
bool CsvLines::fill() {
  std::memmove(piece_.data(), piece_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  in_.read(piece_.data() + end_, static_cast<std::streamsize>(piece_.size() - end_));
  const auto came = static_cast<std::size_t>(in_.gcount());
  digest_.add({piece_.data() + end_, came});
  end_ += came;
  read_ += came;
  return came > 0;
}

bool CsvLines::next(std::string_view& line) {
  if (too_long_) return false;
  const char* const start = piece_.data();
  const auto* newline = static_cast<const char*>(std::memchr(start + begin_, break_, end_ - begin_));
  if (newline == nullptr) {
    if (end_ - begin_ == piece_.size()) {
      too_long_ = true;
      ++number_;
      return false;
    }
    if (fill()) return next(line);
    if (begin_ == end_) return false;
  }
  const std::size_t stop = newline == nullptr ? end_ : static_cast<std::size_t>(newline - start);
  line = std::string_view(start + begin_, stop - begin_);
  begin_ = std::min(stop + 1, end_);
  ++number_;
  return true;
}

}  // namespace grouser
