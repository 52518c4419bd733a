#include "simulator/energy_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "simulator/failures.h"

namespace grouser {
namespace {

constexpr double k_sound_residual = 0.1 * k_largest_residual;

constexpr int k_num_accounts = 6;
constexpr std::array<const char*, k_num_accounts> k_account_names{
    "the rubber of the joints", "damping in contacts", "friction at wheels and sprocket",
    "friction on the ground",   "the suspension",      "the tensioner"};
std::array<double, k_num_accounts> losses(const EnergyBook& book) {
  return {book.bushing_loss, book.contact_loss,    book.friction_loss,
          book.ground_loss,  book.suspension_loss, book.tensioner_loss};
}

/// What presses hardest on a link; k_num_partners when nothing does.
std::size_t pressing_partner(const Workspace& work, int link) {
  std::size_t hardest = k_num_partners;
  double largest = 0.0;
  for (std::size_t p = 0; p < k_num_partners; ++p) {
    const Field& f = work.contact_force_W[p];
    const double square = f[0][link] * f[0][link] + f[1][link] * f[1][link] + f[2][link] * f[2][link];
    if (square > largest) largest = square, hardest = p;
  }
  return hardest;
}

const char* place_of(std::size_t partner) {
  constexpr std::array<const char*, k_num_partners + 1> k_places{
      "links under road wheels",         "links on support rollers", "links on an idler",       "links on a sprocket",
      "links whose guide meets a wheel", "links on the ground",      "links that touch nothing"};
  return k_places[partner];
}

int largest_of(const std::vector<long>& counts) {
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

}  // namespace

EnergyWatch::EnergyWatch(const System& system, const EnergyBook& book)
    : system_(system),
      sound_(book),
      links_(static_cast<std::size_t>(system.link_array_length)),
      bodies_(system.tree.bodies.size()) {}

void EnergyWatch::mark_sound(const EnergyBook& book, double time) {
  sound_ = book;
  sound_time_ = time;
  steps_ = by_error_ = 0;
  std::fill(links_.begin(), links_.end(), 0);
  std::fill(bodies_.begin(), bodies_.end(), 0);
  partners_ = {};
}

void EnergyWatch::update(const EnergyBook& book, const Stepper& stepper) {
  constexpr long k_steps_between_marks = 100;
  ++steps_;
  const StepLimit limit = stepper.last_limit();
  if (limit == StepLimit::error || limit == StepLimit::stability || limit == StepLimit::fixed) {
    if (limit == StepLimit::error) ++by_error_;
    const Part part = stepper.last_limiting();
    if (part.body >= 0) ++bodies_[static_cast<std::size_t>(part.body)];
    if (part.link >= 0) {
      ++links_[static_cast<std::size_t>(part.link)];
      ++partners_[pressing_partner(stepper.work(), part.link)];
    }
  }
  if (steps_ >= k_steps_between_marks && book.chatter_fraction() < k_sound_residual)
    mark_sound(book, stepper.state().time);
}

std::string EnergyWatch::growing_account(const EnergyBook& book) const {
  const auto before = losses(sound_), now = losses(book);
  const double all_before = sound_.dissipated_by_powers(), all_since = book.dissipated_by_powers() - all_before;
  if (all_since <= 0.0) return "nothing was lost since";
  const auto share_before = [&](std::size_t i) { return all_before > 0.0 ? before[i] / all_before : 0.0; };
  std::size_t grown = 0;
  double largest = -1.0;
  for (std::size_t i = 0; i < k_num_accounts; ++i) {
    const double growth = (now[i] - before[i]) / all_since - share_before(i);
    if (growth > largest) largest = growth, grown = i;
  }
  const double share = 100.0 * (now[grown] - before[grown]) / all_since;
  std::string text = fmt::format("{} takes {:.0f} % of all losses", k_account_names[grown], share);
  if (all_before > 0.0) text += fmt::format(" ({:.0f} % before)", 100.0 * share_before(grown));
  return text;
}

std::string EnergyWatch::bounding_part() const {
  const auto bounded = [this](long count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(std::max(1L, steps_));
  };
  const int body = largest_of(bodies_), link = largest_of(links_);
  const auto partner =
      static_cast<std::size_t>(std::max_element(partners_.begin(), partners_.end()) - partners_.begin());
  const long by_body = bodies_[static_cast<std::size_t>(body)];
  if (by_body > partners_[partner])
    return fmt::format("{:.0f} % of the steps are bounded by {}", bounded(by_body), part_name(system_, {-1, body}));
  if (partners_[partner] == 0) return "no part of the vehicle bounds the steps";
  return fmt::format("{:.0f} % of the steps are bounded by {}, most often {}", bounded(partners_[partner]),
                     place_of(partner), part_name(system_, {link, -1}));
}

std::string EnergyWatch::remedy(const Stepper& stepper) const {
  const IntegratorOptions& options = system_.scenario.integrator;
  if (options.fixed_step > 0.0) {
    return fmt::format(
        "reduce integrator.fixed_step, which is {:.2f} times the bound that stability_fraction ({:.2f}) is meant for",
        options.fixed_step / stepper.stable_step(), options.stability_fraction);
  }
  if (stepper.last_limit() == StepLimit::min_step)
    return "reduce integrator.min_step, which holds the steps above the stable ones";
  return fmt::format("reduce integrator.{} or soften what bounds the step",
                     2 * by_error_ > steps_ ? "velocity_tolerance" : "stability_fraction");
}

std::optional<std::string> EnergyWatch::failure(const EnergyBook& book, const Stepper& stepper) const {
  const double fraction = book.chatter_fraction();
  if (fraction < k_largest_residual) return std::nullopt;
  return fmt::format(
      "energy residual {:.2e} of the energy turned over (sprocket work, losses or strain of the rubber, whichever is "
      "most) at {:.4f} s, more than {:.0e}: the steps chatter. "
      "Since {:.4f} s {}; {}; {}",
      fraction, stepper.state().time, k_largest_residual, sound_time_, growing_account(book), bounding_part(),
      remedy(stepper));
}

}  // namespace grouser
