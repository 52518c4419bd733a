#pragma once
#include <filesystem>
#include <vector>

#include "model/bushing.h"

/// Bushings as likely as the fitted one in the light of the data: folder/bushing_01.json, bushing_02.json ... Each is
/// an ordinary bushing file, so that a run with each of them shows what the uncertainty of the fit does to the vehicle.
namespace grouser {

/// Throws FileError where `folder` holds anything but draws, for it is replaced as a whole, and a user's files with it;
/// also where it may not be written into.
void require_only_draws(const std::filesystem::path& folder);

/// A folder of draws in the making. Only publish() makes it seen, in place of the draws of an earlier fit: a reader
/// finds all of the one or all of the other, whenever this program is killed.
class BushingDraws {
 public:
  /// Writes the draws beside `folder`, which holds nothing else; none for an empty list. The draws' names are the
  /// caller's ("..., draw 3 of 60").
  BushingDraws(const std::vector<Bushing>& draws, const std::filesystem::path& folder);
  /// Leaves nothing behind unless published.
  ~BushingDraws();
  BushingDraws(const BushingDraws&) = delete;
  BushingDraws& operator=(const BushingDraws&) = delete;

  void publish();

 private:
  std::filesystem::path folder_, part_;
  bool any_;
};

}  // namespace grouser
