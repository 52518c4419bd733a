#pragma once
#include <string>
#include <vector>

#include "model/errors.h"

namespace grouser {

/// Collects what is wrong in one file, so that its user learns of everything at once.
class Findings {
 public:
  explicit Findings(std::string file) : file_(std::move(file)) {}
  void add(std::string place, std::string expected, std::string found, std::string hint = {}) {
    list_.push_back({file_, std::move(place), std::move(expected), std::move(found), std::move(hint)});
  }
  /// A finding about another file.
  void add(InputFinding finding) { list_.push_back(std::move(finding)); }
  void add(const Findings& other) { list_.insert(list_.end(), other.list_.begin(), other.list_.end()); }
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
