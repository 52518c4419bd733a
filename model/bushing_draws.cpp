#include "model/bushing_draws.h"

#include <unistd.h>

#include <algorithm>
#include <system_error>

#include "model/descriptor.h"
#include "model/errors.h"
#include "model/replace_file.h"

namespace grouser {
namespace {

std::string padded(std::size_t number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), '0') + digits;
}

bool is_draw(const std::filesystem::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_regular_file() && name.starts_with("bushing_") && name.ends_with(".json");
}

}  // namespace

void require_only_draws(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder)) return;
  if (!std::filesystem::is_directory(folder)) {
    throw FileError("cannot write into " + folder.string() + ": expected a folder of draws, found a file");
  }
  if (::access(folder.c_str(), W_OK) != 0) fail_file("write into", folder);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (is_draw(entry)) continue;
    throw FileError("cannot write into " + folder.string() +
                    ": expected only draws of an earlier fit, which give way, found " +
                    entry.path().filename().string() + " (move it to another folder)");
  }
}

BushingDraws::BushingDraws(const std::vector<Bushing>& draws, const std::filesystem::path& folder)
    : folder_(folder), part_(folder.string() + ".part"), any_(!draws.empty()) {
  require_only_draws(folder_);
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
