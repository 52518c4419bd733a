#include "model/errors.h"

namespace grouser {
namespace {

std::string text_of(const std::vector<InputFinding>& findings) {
  std::string text;
  for (const InputFinding& finding : findings) {
    if (!text.empty()) text += '\n';
    text += finding.text();
  }
  return text;
}

}  // namespace

std::string InputFinding::text() const {
  std::string text = file;
  if (!place.empty()) text += (place.front() == '/' ? "#" : ": ") + place;
  text += ": expected " + expected;
  if (!found.empty()) text += ", found " + found;
  if (!hint.empty()) text += " (" + hint + ")";
  return text;
}

InputError::InputError(std::vector<InputFinding> findings)
    : std::runtime_error(text_of(findings)), findings_(std::move(findings)) {}

}  // namespace grouser
