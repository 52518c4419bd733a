#include "model/bushing_draws.h"

#include <algorithm>
#include <system_error>

#include "model/replace_file.h"

namespace grouser {
namespace {

std::string padded(std::size_t number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), '0') + digits;
}

}  // namespace

BushingDraws::BushingDraws(const std::vector<Bushing>& draws, const std::filesystem::path& folder)
    : folder_(folder), part_(folder.string() + ".part"), any_(!draws.empty()) {
  std::filesystem::remove_all(part_);  // what a killed fit left
  if (!any_) return;
  try {
    std::filesystem::create_directories(part_);
    const std::size_t width = std::max<std::size_t>(2, std::to_string(draws.size()).size());
    for (std::size_t i = 0; i < draws.size(); ++i) {
      write_bushing(draws[i], part_ / ("bushing_" + padded(i + 1, width) + ".json"));
    }
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(part_, ignored);
    throw;
  }
}

BushingDraws::~BushingDraws() {
  std::error_code ignored;
  if (any_) std::filesystem::remove_all(part_, ignored);
}

void BushingDraws::publish() {
  any_ ? replace_folder(part_, folder_) : static_cast<void>(std::filesystem::remove_all(folder_));
}

}  // namespace grouser
