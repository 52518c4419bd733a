#include "tests/support/trees.h"

#include "tests/validation/chapters.h"

namespace grouser::validation {
namespace {

using namespace grouser::test;

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  return Eigen::VectorXd::Map(values.begin(), static_cast<Eigen::Index>(values.size()));
}

void add_falls_from_rest(Chapter& chapter) {
  chapter.section(
      "Trees that fall from rest",
      "Unit bodies on hinges, released at rest in gravity along -y: joint accelerations of the first moment.");
  const Tree tree = five_body_tree();
  const TreeState rest = make_state(tree);
  const Eigen::VectorXd found =
      accelerate(tree, rest, Vector3d(0.0, -9.81, 0.0), Eigen::VectorXd::Zero(5)).acceleration.joint;
  const Worst worst = worst_of(
      found, vector_of({-1.6031906614786, -0.534396887159533, 4.1034046692607, 0.267198443579767, 5.30579766536965}));
  chapter.add({"five branching bodies: joint acceleration", "rad/s²", worst.reference, worst.measured,
               within(1e-12, "round-off"), "RBDL, tests/DynamicsTests.cc, published to 15 digits"});
}

}  // namespace

void add_trees(Chapter& chapter) { add_falls_from_rest(chapter); }

}  // namespace grouser::validation
