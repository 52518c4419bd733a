#include "identification/law_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "identification/axis_fit.h"
#include "identification/nnls.h"
#include "model/errors.h"

namespace grouser {
namespace {

constexpr std::array k_spring_intervals{8, 14, 24, 40};  // 12 to 16 for rubber alone (I 3), more for play and stops
constexpr std::size_t k_usual_elements = 4;              // of each kind; each costs time in every step of a run (I 5.5)
constexpr std::size_t k_most_elements = 6;
constexpr double k_prune = 1e-3;             // of the total stiffness of its kind
constexpr double k_search_tolerance = 1e-4;  // relative cost: a tenth of a standard error of any comparison
constexpr double k_perturbation = 1.5;
// Growth of the cost that the fit does not notice. The left-out error cannot judge what one test alone shows (its
// stroke, a stop at its end): there the fit itself decides.
constexpr double k_unnoticed = 0.1;
constexpr double k_worth = 0.2;                       // least part of the cost that one element more must take away
constexpr std::array k_first_growths{0.3, 1.0, 3.0};  // of the yields at the largest displacement

struct Element {
  double place = 0.0, stiffness = 0.0;  // yield or relaxation time
};

// Ward's merging on the log axis: the neighbours whose union moves the least stiffness the least far become one.
std::vector<double> merge_to(std::vector<Element> elements, std::size_t count) {
  std::ranges::sort(elements, {}, &Element::place);
  double total = 0.0;
  for (const Element& element : elements) total += element.stiffness;
  std::erase_if(elements, [&](const Element& e) { return e.stiffness <= k_prune * total; });
  while (elements.size() > count) {
    if (count == 0) return {};
    std::size_t best = 0;
    double least = -1.0;
    for (std::size_t i = 0; i + 1 < elements.size(); ++i) {
      const double k1 = elements[i].stiffness, k2 = elements[i + 1].stiffness;
      const double distance = std::log(elements[i + 1].place / elements[i].place);
      const double cost = k1 * k2 / (k1 + k2) * distance * distance;
      if (least < 0.0 || cost < least) least = cost, best = i;
    }
    Element& a = elements[best];
    const Element& b = elements[best + 1];
    const double sum = a.stiffness + b.stiffness;
    a = {std::exp((a.stiffness * std::log(a.place) + b.stiffness * std::log(b.place)) / sum), sum};
    elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  }
  std::vector<double> places;
  for (const Element& element : elements) places.push_back(element.place);
  return places;
}

// At most so many elements that stand for all of the dictionary's.
Dictionary condense(const Dictionary& full, const Eigen::VectorXd& coefficients, std::size_t num_stops,
                    std::size_t num_branches) {
  std::vector<Element> stops, branches;
  Eigen::Index at = full.spring.size();
  for (const double yield : full.yields) stops.push_back({yield, coefficients(at++)});
  for (const double time : full.relaxation_times) branches.push_back({time, coefficients(at++)});
  return {full.spring, merge_to(stops, num_stops), merge_to(branches, num_branches), full.yield_growth};
}

// One size of law with its parameters at their optimum.
struct Candidate {
  PolishedLaw law;
  LeftOut left_out;

  [[nodiscard]] double cost() const { return law.summary.final_cost; }
  [[nodiscard]] std::size_t stops() const { return law.dictionary.yields.size(); }
  [[nodiscard]] std::size_t branches() const { return law.dictionary.relaxation_times.size(); }
};

// What costs more in every step of a run must explain a good part of what the law left unexplained, and must not
// predict clearly worse.
bool pays(const Candidate& more, const Candidate& less) {
  return more.cost() < (1.0 - k_worth) * less.cost() && !clearly_worse(more.left_out, less.left_out);
}

class Search {
 public:
  Search(const AxisData& data, const PolishOptions& options)
      : data_(&data), bounds_(search_bounds(data)), options_(options), full_(full_dictionary(data)) {
    options_.function_tolerance = k_search_tolerance;
  }

  LawChoice run() {
    choose_spring();
    Candidate chosen = several_starts();
    if (!data_->closed) return choice_of(chosen);
    chosen = grown(std::move(chosen));
    if (std::optional<Candidate> growing = with_growth(chosen)) chosen = std::move(*growing);
    chosen = reduced(std::move(chosen));
    return choice_of(chosen);
  }

 private:
  // A dictionary as it stands: its coefficients alone are fitted.
  struct Trial {
    Dictionary dictionary;
    Eigen::VectorXd coefficients;
    double cost = 0.0;
    LeftOut left_out;
  };
  Trial attempt(const Dictionary& dictionary) {
    const std::vector<BlockMoments> blocks = split_moments(*data_, dictionary, false);
    Eigen::MatrixXd sum = sum_of(blocks);
    regularise(sum, dictionary);
    const int n = dictionary.num_linear();
    const NnlsSolution fit = solve_nnls(sum.topLeftCorner(n, n), sum.col(n).head(n));
    LeftOut left_out = leave_one_out(*data_, dictionary, blocks, fit.free);
    note(dictionary, left_out);
    return {dictionary, fit.x, sum(n, n) - fit.x.dot(sum.col(n).head(n)), std::move(left_out)};
  }

  // With all elements at hand, so that the spring need not imitate them.
  void choose_spring() {
    std::vector<Trial> trials;
    for (const int intervals : k_spring_intervals) {
      Dictionary dictionary = full_;
      dictionary.spring = MonotoneBasis(data_->low, data_->high, intervals, data_->symmetry);
      trials.push_back(attempt(dictionary));
    }
    const LeftOut best =
        std::ranges::min(trials, {}, [](const Trial& t) { return left_out_error(t.left_out); }).left_out;
    const double least = std::ranges::min(trials, {}, &Trial::cost).cost;
    const auto chosen = std::ranges::find_if(trials, [&](const Trial& trial) {
      return trial.cost <= (1.0 + k_unnoticed) * least && !clearly_worse(trial.left_out, best);
    });
    // none: the fit asks for more than the prediction can bear; the fit is what the valid range promises
    const Trial& taken = chosen != trials.end() ? *chosen : *std::ranges::find_if(trials, [&](const Trial& trial) {
      return trial.cost <= (1.0 + k_unnoticed) * least;
    });
    full_ = taken.dictionary;
    full_coefficients_ = taken.coefficients;
  }

  Candidate refine(const Dictionary& start) {
    Candidate candidate{polish(*data_, bounds_, start, options_), {}};
    iterations_ += candidate.law.summary.iterations;
    ++starts_;
    // elements that want no stiffness are gone for good
    const Dictionary& found = candidate.law.dictionary;
    const Dictionary kept = used_elements(found, candidate.law.coefficients);
    if (kept.num_elements() < found.num_elements()) return refine(kept);
    candidate.left_out = leave_one_out(*data_, found, candidate.law.moments, candidate.law.free);
    note(found, candidate.left_out);
    return candidate;
  }

  // The full dictionary's elements merged; spread evenly; merged and perturbed: the search has local minima.
  Candidate several_starts() {
    const Dictionary merged = condense(full_, full_coefficients_, k_usual_elements, k_usual_elements);
    Candidate best = refine(merged);
    if (merged.num_elements() == 0) return best;
    Dictionary even = merged, moved = merged;
    const auto spread = [](std::vector<double>& places, double low, double high) {
      const auto n = static_cast<double>(places.size());
      for (std::size_t i = 0; i < places.size(); ++i) {
        places[i] = low * std::pow(high / low, (static_cast<double>(i) + 0.5) / n);
      }
    };
    spread(even.yields, bounds_.yield_low, bounds_.yield_high);
    spread(even.relaxation_times, bounds_.time_low, bounds_.time_high);
    double factor = k_perturbation;
    for (std::vector<double>* places : {&moved.yields, &moved.relaxation_times}) {
      for (double& place : *places) place *= factor, factor = 1.0 / factor;
    }
    for (const Dictionary& start : {even, moved}) {
      Candidate other = refine(start);
      if (other.law.summary.final_cost < best.law.summary.final_cost) best = std::move(other);
    }
    return best;
  }

  // More than the usual number of elements only where they pay.
  Candidate grown(Candidate best) {
    for (bool grew = true; grew;) {
      grew = false;
      for (const bool of_branches : {false, true}) {
        const std::size_t stops = best.stops() + (of_branches ? 0 : 1),
                          branches = best.branches() + (of_branches ? 1 : 0);
        if (std::max(stops, branches) > k_most_elements) continue;
        if ((of_branches ? branches : stops) <= k_usual_elements) continue;
        const Dictionary start = condense(full_, full_coefficients_, stops, branches);
        if (start.num_elements() <= best.law.dictionary.num_elements()) continue;
        Candidate more = refine(start);
        if (!pays(more, best)) continue;
        best = std::move(more);
        grew = true;
      }
    }
    return best;
  }

  // Fewer elements as long as the best prediction met on the way stays within a standard error and the fit hardly
  // notices.
  Candidate reduced(Candidate chosen) {
    LeftOut best = chosen.left_out;
    double least = chosen.cost();
    for (;;) {
      std::optional<Candidate> simpler;
      for (const bool of_branches : {true, false}) {
        const std::size_t stops = chosen.stops(), branches = chosen.branches();
        if ((of_branches ? branches : stops) == 0) continue;
        Candidate fewer = refine(condense(chosen.law.dictionary, chosen.law.coefficients, stops - (of_branches ? 0 : 1),
                                          branches - (of_branches ? 1 : 0)));
        least = std::min(least, fewer.cost());
        const bool spares = fewer.cost() <= (1.0 + k_unnoticed) * least && !clearly_worse(fewer.left_out, best);
        if (spares && (!simpler || fewer.cost() < simpler->cost())) simpler = std::move(fewer);
      }
      if (!simpler) return chosen;
      if (left_out_error(simpler->left_out) < left_out_error(best)) best = simpler->left_out;
      chosen = std::move(*simpler);
    }
  }

  // With yields that grow, when that pays. The growth to start from is searched with all elements at hand: yields that
  // were found without growth imitate it, and the search would not leave them.
  std::optional<Candidate> with_growth(const Candidate& plain) {
    if (plain.stops() == 0) return {};
    const double reach = std::max(std::abs(data_->low), std::abs(data_->high));
    std::vector<Trial> trials;
    for (const double growth : k_first_growths) {
      Dictionary dictionary = full_;
      dictionary.yield_growth = growth / (reach * reach);
      trials.push_back(attempt(dictionary));
    }
    const Trial best = std::ranges::min(trials, {}, &Trial::cost);
    Candidate growing = refine(condense(best.dictionary, best.coefficients, plain.stops(), plain.branches()));
    if (!pays(growing, plain)) return {};
    return growing;
  }

  void note(const Dictionary& dictionary, const LeftOut& left_out) {
    candidates_.push_back({dictionary.spring.intervals(), static_cast<int>(dictionary.yields.size()),
                           static_cast<int>(dictionary.relaxation_times.size()), dictionary.yield_growth > 0.0,
                           left_out_error(left_out), false});
  }

  LawChoice choice_of(const Candidate& chosen) {
    const Dictionary& dictionary = chosen.law.dictionary;
    note(dictionary, chosen.left_out);
    LawCandidate& last = candidates_.back();
    std::erase_if(candidates_, [&](const LawCandidate& other) {
      return &other != &last && other.spring_intervals == last.spring_intervals && other.stops == last.stops &&
             other.branches == last.branches && other.strain_dependent_yield == last.strain_dependent_yield;
    });
    candidates_.back().chosen = true;
    return {dictionary, std::move(candidates_), starts_, iterations_};
  }

  const AxisData* data_;
  PolishBounds bounds_;
  PolishOptions options_;
  Dictionary full_;
  Eigen::VectorXd full_coefficients_;
  std::vector<Eigen::VectorXd> coefficients_;
  std::vector<LawCandidate> candidates_;
  int starts_ = 0, iterations_ = 0;
};

}  // namespace

Dictionary used_elements(const Dictionary& dictionary, const Eigen::VectorXd& coefficients) {
  return condense(dictionary, coefficients, dictionary.yields.size(), dictionary.relaxation_times.size());
}

PolishBounds search_bounds(const AxisData& data) {
  const Dictionary full = full_dictionary(data);
  PolishBounds bounds;
  if (!full.yields.empty()) {
    bounds.yield_low = full.yields.front();
    bounds.yield_high = full.yields.back();
  }
  if (!full.relaxation_times.empty()) {
    bounds.time_low = full.relaxation_times.front();
    bounds.time_high = full.relaxation_times.back();
  }
  const double reach = std::max(std::abs(data.low), std::abs(data.high));
  bounds.growth_low = 0.01 / (reach * reach);
  bounds.growth_high = 30.0 / (reach * reach);
  return bounds;
}

LawChoice choose_law(const AxisData& data, const PolishOptions& options) { return Search(data, options).run(); }

}  // namespace grouser
