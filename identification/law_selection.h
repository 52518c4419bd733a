#pragma once
#include <vector>

#include "identification/leave_one_out.h"
#include "identification/polish.h"
#include "model/fit.h"

namespace grouser {

/// The law's size and, near their optimum, its nonlinear parameters.
struct LawChoice {
  Dictionary dictionary;
  std::vector<LawCandidate> candidates;  ///< all sizes tried, the chosen one marked
  int starts = 0;                        ///< of the search for yields and times
  int iterations = 0;
};

/// Chooses numbers of spring intervals, stops and branches and whether yields grow, by leave-one-out error: the fewest
/// elements that do not predict clearly worse than the best (see clearly_worse) and whose fit is not more than 10 %
/// costlier. More than 4 stops or branches, or growth, must take away a fifth of the cost. `data` should be thin():
/// every size is searched on it.
[[nodiscard]] LawChoice choose_law(const AxisData& data, const PolishOptions& options = {});

/// The dictionary without elements of less than 0.1 % of the stiffness of their kind, the others ascending.
[[nodiscard]] Dictionary used_elements(const Dictionary& dictionary, const Eigen::VectorXd& coefficients);

/// Where a search on these data may go: yields between the smallest and largest of full_dictionary(), times likewise;
/// growth from 1 % to 30 times the yield at the largest displacement.
[[nodiscard]] PolishBounds search_bounds(const AxisData& data);

}  // namespace grouser
