#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "simulator/energy_book.h"
#include "simulator/step.h"

namespace grouser {

/// A larger residual ends the run (P 3, P 5.4: clean runs stay below a tenth of it, chatter jumps to 1e-2 and more).
inline constexpr double k_largest_residual = 1e-3;

/// Watches the energy book while a run goes, and remembers what it looked like when it last was sound, so that it can
/// tell the likely cause when it no longer closes: the account that grew, and the part of the vehicle that bounded the
/// steps since.
class EnergyWatch {
 public:
  EnergyWatch(const System& system, const EnergyBook& book);

  /// One accepted step.
  void update(const EnergyBook& book, const Stepper& stepper);
  /// Time, size and likely cause of a residual that is too large; nothing while the book is sound.
  [[nodiscard]] std::optional<std::string> failure(const EnergyBook& book, const Stepper& stepper) const;

  /// Its memory, for a checkpoint.
  template <typename Archive>
  void archive(Archive& a) {
    a(sound_, sound_time_, steps_, by_error_, links_, bodies_, partners_);
  }

 private:
  [[nodiscard]] std::string growing_account(const EnergyBook& book) const;
  [[nodiscard]] std::string bounding_part() const;
  [[nodiscard]] std::string remedy(const Stepper& stepper) const;
  void mark_sound(const EnergyBook& book, double time);

  const System& system_;
  EnergyBook sound_;         ///< when the residual last was below a tenth of what ends a run
  double sound_time_ = 0.0;  ///< s
  // since then
  long steps_ = 0, by_error_ = 0;
  std::vector<long> links_, bodies_;                 ///< steps that each link (array index), each tree body bounded
  std::array<long, k_num_partners + 1> partners_{};  ///< by what pressed most on the bounding link; last: nothing
};

}  // namespace grouser
