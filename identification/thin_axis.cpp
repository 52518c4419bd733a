#include "identification/thin_axis.h"

#include <algorithm>
#include <map>

namespace grouser {
namespace {

// A sine through 100 chords has (2 pi / 100)^2 / 6 = 0.07 % less area: small beside any fit's energy error.
constexpr std::size_t k_samples_per_cycle = 100;
constexpr std::size_t k_cycles_of_history = 2;  // stops forget within one, slow branches only keep an offset

// Samples begin .. end at the stride, with the reversals between them.
void select(const std::vector<double>& x, std::size_t begin, std::size_t end, std::size_t stride,
            std::vector<std::size_t>& chosen) {
  for (std::size_t i = begin; i < end; i += stride) {
    chosen.push_back(i);
    const std::size_t next = std::min(i + stride, end);
    const auto from = x.begin() + static_cast<std::ptrdiff_t>(i),
               to = x.begin() + static_cast<std::ptrdiff_t>(next) + 1;
    const auto [low, high] = std::minmax_element(from, to);
    const auto inner = [&](auto at) { return at != from && at != to - 1; };
    std::size_t a = inner(low) ? static_cast<std::size_t>(low - x.begin()) : i;
    std::size_t b = inner(high) ? static_cast<std::size_t>(high - x.begin()) : i;
    if (a > b) std::swap(a, b);
    if (a > i) chosen.push_back(a);
    if (b > std::max(a, i)) chosen.push_back(b);
  }
}

class TestThinner {
 public:
  TestThinner(const PreparedTest& test, const std::vector<CycleSpan>& cycles) : test_(&test) {
    std::size_t shortest = test.displacement.size();
    for (const CycleSpan& span : cycles) shortest = std::min(shortest, span.end - span.begin);
    const std::size_t stride = std::max<std::size_t>((shortest + k_samples_per_cycle / 2) / k_samples_per_cycle, 1);
    const CycleSpan first = cycles.front();
    std::size_t at = first.begin - std::min(first.begin, k_cycles_of_history * (first.end - first.begin));
    for (const CycleSpan& span : cycles) {
      select(test.displacement, at, span.begin, stride, chosen_);
      select(test.displacement, span.begin, span.end, stride, chosen_);
      at = span.end;
    }
    chosen_.push_back(at);
  }

  [[nodiscard]] PreparedTest test() const {
    PreparedTest result;
    result.source = test_->source;
    for (const std::size_t i : chosen_) {
      result.time.push_back(test_->time[i]);
      result.displacement.push_back(test_->displacement[i]);
      result.force.push_back(test_->force[i]);
    }
    return result;
  }
  [[nodiscard]] CycleSpan span(const CycleSpan& whole) const { return {place(whole.begin), place(whole.end)}; }

 private:
  [[nodiscard]] std::size_t place(std::size_t i) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(chosen_, i) - chosen_.begin());
  }
  const PreparedTest* test_;
  std::vector<std::size_t> chosen_;
};

}  // namespace

ThinAxis thin(const AxisData& data) {
  ThinAxis result;
  result.data = data;
  std::map<const PreparedTest*, std::vector<CycleSpan>> cycles;
  for (DataBlock& block : result.data.blocks) {
    if (const std::size_t count = block.cycles.size(); count > 2) {
      const std::size_t middle = (count - 1) / 2;  // as conditioned as the mean of all
      block.cycles = {block.cycles[middle], block.cycles[middle + 1]};
    }
    std::ranges::copy(block.cycles, std::back_inserter(cycles[block.test]));
  }
  const PreparedTest* whole = nullptr;
  std::optional<TestThinner> thinner;
  for (DataBlock& block : result.data.blocks) {
    if (block.test != whole) {
      whole = block.test;
      thinner.emplace(*whole, cycles[whole]);
      result.tests.push_back(thinner->test());
    }
    for (CycleSpan& span : block.cycles) span = thinner->span(span);
    block.test = &result.tests.back();
  }
  return result;
}

}  // namespace grouser
