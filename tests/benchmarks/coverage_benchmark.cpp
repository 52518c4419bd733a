// How honest are stated intervals? coverage_benchmark [FIRST_SEED [NUM_SEEDS]]: identifies a new random rubber for
// every seed and prints how often its 95 % intervals hold the truth, how wide they are, and how well the fitted law
// recovers the rubber. The recipe was chosen on the seeds 5000-5059; the default seeds were never looked at before.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "model/errors.h"
#include "tests/identification/coverage.h"

namespace {

using namespace grouser;

void print_row(const char* name, const Coverage& coverage, double bar = 0.0) {
  std::printf("%-28s %6d   %5.1f %%    %5.2f %%", name, coverage.stated, 100.0 * coverage.fraction(),
              100.0 * coverage.mean_half_width());
  if (bar > 0.0) std::printf("   <= %.1f %%", 100.0 * bar);
  std::printf("\n");
}

void print_families(const char* title, const std::vector<SeedCoverage>& seeds, int outside = -1) {
  std::printf("\n%-28s %6s   %7s    %s\n", title, "stated", "covered", "mean half width");
  for (std::size_t f = 0; f < k_coverage_families.size(); ++f) {
    Coverage sum;
    for (const SeedCoverage& seed : seeds) {
      if (outside < 0 || static_cast<int>(seed.outside) == outside) sum.add(seed.families[f]);
    }
    if (sum.stated > 0) print_row(k_coverage_families[f].name, sum, k_coverage_families[f].half_width_bar);
  }
}

void print_quantities(const std::vector<SeedCoverage>& seeds) {
  std::map<std::string, Coverage> sums;
  for (const SeedCoverage& seed : seeds) {
    for (const auto& [name, coverage] : seed.quantities) sums[name].add(coverage);
  }
  std::printf("\n%-28s %6s   %7s    %s\n", "quantity", "stated", "covered", "mean half width");
  for (const auto& [name, coverage] : sums) print_row(name.c_str(), coverage);
}

void print_recovery(const char* name, std::vector<double> worst, double bar) {
  std::sort(worst.begin(), worst.end());
  std::printf("%-28s %5.2f %%   %5.2f %%   %5.2f %%   <= %.1f %%\n", name, 100.0 * worst[worst.size() / 2],
              100.0 * worst[worst.size() * 95 / 100], 100.0 * worst.back(), 100.0 * bar);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t first = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 7000;
  const std::uint64_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 200;
  std::vector<SeedCoverage> seeds;
  const std::clock_t start = std::clock();
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    try {
      seeds.push_back(coverage_of_seed(seed));
    } catch (const NumericalError& error) {
      std::printf("seed %llu: no result: %s\n", static_cast<unsigned long long>(seed), error.what());
    }
  }
  if (seeds.empty()) return 4;
  std::printf("%zu random rubbers, seeds %llu ...; %.2f s of processor time each, generation included\n", seeds.size(),
              static_cast<unsigned long long>(first),
              static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / static_cast<double>(seeds.size()));

  print_families("all", seeds);
  constexpr const char* mechanisms[] = {"law's own mechanisms", "with a springpot", "with a growing yield",
                                        "with both"};
  for (int m = 0; m < k_num_outside_mechanisms; ++m) print_families(mechanisms[m], seeds, m);
  print_quantities(seeds);

  std::vector<double> energy, storage, tangent;
  for (const SeedCoverage& seed : seeds) {
    energy.push_back(seed.worst_energy);
    storage.push_back(seed.worst_storage_stiffness);
    tangent.push_back(seed.worst_tangent);
  }
  std::printf("\n%-28s %7s   %7s   %7s   bar of the median\n", "fitted law, worst cell", "median", "95 %", "worst");
  print_recovery("energy", energy, 0.02);
  print_recovery("storage stiffness", storage, 0.015);
  print_recovery("tangent over +-0.15 mm", tangent, 0.02);
  return 0;
}
