#pragma once
#include "simulator/workspace.h"

namespace grouser {

/// Energy that went in, was stored and was lost since the book was opened [J]. The residual is the run's conscience:
/// bounded chatter hides from every other channel (P 5).
struct EnergyBook {
  EnergyTerms start;            ///< stored parts when opened
  EnergyTerms now;              ///< at the last accepted state
  double input = 0.0;           ///< work at the sprockets' joints, drag of the final drive taken off
  double absolute_input = 0.0;  ///< integral of |their power|
  double bushing_loss = 0.0, contact_loss = 0.0, friction_loss = 0.0, ground_loss = 0.0;
  double suspension_loss = 0.0, tensioner_loss = 0.0;
  double contact_way =
      0.0;  ///< what contacts took over the links' ways, less what their powers say (contact_step_loss)

  [[nodiscard]] double dissipated_by_powers() const {
    return bushing_loss + contact_loss + friction_loss + ground_loss + suspension_loss + tensioner_loss;
  }
  [[nodiscard]] double dissipated() const { return dissipated_by_powers() + contact_way; }
  [[nodiscard]] double residual() const { return now.stored() - start.stored() + dissipated() - input; }
  /// |residual| of the integral of |sprocket power|. Where that is small, of the energy that was lost (a vehicle that
  /// coasts downhill is driven by nobody), and at least of the strain energy in the tracks' rubber at the start: a
  /// thousandth of it moves no tension by more than 0.05 %, and a vehicle at rest turns over nothing to compare with.
  [[nodiscard]] double residual_fraction() const;
  /// The larger one of that and the same with the losses that powers say. A damper that shakes its body because the
  /// step is too long does work on it over its way: ways alone would book that as a loss below zero and close.
  [[nodiscard]] double chatter_fraction() const;

 private:
  [[nodiscard]] double turned_over() const;  ///< J, what residuals are measured by
};

[[nodiscard]] EnergyBook open_book(const EnergyTerms& terms);

/// Books one accepted step of length h: trapezoid for powers (a rectangle is wrong by 5e-3 with variable steps, P 5.2),
/// step energies as they are.
void book_step(EnergyBook& book, const EnergyTerms& next, double h);

}  // namespace grouser
