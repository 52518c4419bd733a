#pragma once
#include <string>
#include <vector>

#include "model/errors.h"

namespace grouser {

/// Collects what is wrong in one file, so that its user learns of everything at once.
class Findings {
 public:
  static constexpr std::size_t k_most = 200;  ///< kept; a file of another kind would give one for each of its numbers

  explicit Findings(std::string file) : file_(std::move(file)) {}
  void add(std::string place, std::string expected, std::string found, std::string hint = {}) {
    add(InputFinding{file_, std::move(place), std::move(expected), std::move(found), std::move(hint)});
  }
  /// A finding about any file; the first beyond k_most says that there are more, and the others are left out.
  void add(InputFinding finding) {
    if (size() < k_most) {
      list_.push_back(std::move(finding));
    } else if (size() == k_most) {
      list_.push_back({file_, "", "at most " + std::to_string(k_most) + " faults to tell of", "more", ""});
    }
  }
  void add(const Findings& other) {
    for (const InputFinding& finding : other.list_) add(finding);
  }
  [[nodiscard]] bool full() const { return size() > k_most; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool empty() const { return list_.empty(); }
  [[nodiscard]] std::size_t size() const { return list_.size(); }
  template <typename Predicate>
  void remove_if(Predicate unwanted) {
    std::erase_if(list_, unwanted);
  }
  [[nodiscard]] const std::vector<InputFinding>& list() const { return list_; }
  void throw_if_any() const {
    if (!list_.empty()) throw InputError(list_);
  }

 private:
  std::string file_;
  std::vector<InputFinding> list_;
};

/// The candidate that `word` was probably meant to be (edit distance up to a third of its length, rounded up); empty
/// when none is near.
[[nodiscard]] std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// "did you mean X?", or nothing for an empty X.
[[nodiscard]] std::string did_you_mean(const std::string& word);

}  // namespace grouser
