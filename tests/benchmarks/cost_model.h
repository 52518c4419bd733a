#pragma once
#include <map>
#include <string>

#include "tests/benchmarks/stages.h"

/// What a step's formulas need, and what a core of this machine can do.
namespace grouser::benchmarks {

/// Additions, multiplications and choices, divisions and roots, and numbers loaded and stored by a stage.
struct Cost {
  double operations = 0.0, roots = 0.0, numbers = 0.0;
  friend Cost operator*(double n, const Cost& c) { return {n * c.operations, n * c.roots, n * c.numbers}; }
  friend Cost operator+(const Cost& a, const Cost& b) {
    return {a.operations + b.operations, a.roots + b.roots, a.numbers + b.numbers};
  }
};

/// Of every stage by its name: what its formulas need, counted by hand to about a tenth. Only what touches counts, not
/// lanes that touch nothing nor the search for who is near.
[[nodiscard]] std::map<std::string, Cost> count_costs(const Scene& scene);

/// What this machine can do on one core, measured: per second.
struct Machine {
  double operations, roots, bytes;
};

/// Measures it.
[[nodiscard]] Machine measure_machine();
/// The longer of arithmetic and traffic [s].
[[nodiscard]] double limit(const Machine& machine, const Cost& cost);

}  // namespace grouser::benchmarks
