#include <gtest/gtest.h>

#include "tests/support/simbody_trees.h"

namespace grouser::test {
namespace {

TEST(TreeAgainstSimbody, RandomFloatingTreesAccelerateAlike) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) EXPECT_LT(difference_to_simbody(seed), 1e-9) << "seed " << seed;
}

}  // namespace
}  // namespace grouser::test
