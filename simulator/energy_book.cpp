#include "simulator/energy_book.h"

#include <algorithm>
#include <cmath>

namespace grouser {

double EnergyBook::turned_over() const {
  constexpr double k_no_rubber = 1.0;  // J, for tracks without strain
  return std::max({absolute_input, dissipated_by_powers(), start.bushing, k_no_rubber});
}

double EnergyBook::residual_fraction() const { return std::abs(residual()) / turned_over(); }

double EnergyBook::chatter_fraction() const {
  return std::max(std::abs(residual()), std::abs(residual() - contact_way)) / turned_over();
}

EnergyBook open_book(const EnergyTerms& terms) {
  EnergyBook book;
  book.start = book.now = terms;
  return book;
}

void book_step(EnergyBook& book, const EnergyTerms& next, double h) {
  const EnergyTerms& last = book.now;
  const auto mean = [h](double a, double b) { return 0.5 * h * (a + b); };
  book.input += mean(last.input_power, next.input_power);
  book.absolute_input += mean(std::abs(last.input_power), std::abs(next.input_power));
  book.bushing_loss += mean(last.bushing_power, next.bushing_power) + next.bushing_step_loss;
  book.contact_loss += mean(last.contact_power, next.contact_power);
  book.contact_way += next.contact_step_loss;
  book.friction_loss += mean(last.friction_power, next.friction_power);
  book.ground_loss += mean(last.ground_power, next.ground_power) + next.ground_step_loss;
  book.suspension_loss += mean(last.suspension_power, next.suspension_power);
  book.tensioner_loss += mean(last.tensioner_power, next.tensioner_power);
  book.now = next;
}

}  // namespace grouser
