#include "tests/identification/bench.h"

#include <algorithm>

namespace grouser {

const PlannedTest& Bench::plan(Axis a, const std::string& name) const {
  return *std::ranges::find(axis(a).tests, name, &PlannedTest::name);
}

RigTest Bench::measure(Axis a, const std::string& name) const { return measure(a, name, axis(a).errors); }

RigTest Bench::measure(Axis a, const std::string& name, const RigErrors& errors) const {
  AxisCampaign bent = axis(a);
  bent.errors = errors;
  return as_rig_test(run_test(bent, plan(a, name)));
}

RigTest as_rig_test(const GeneratedTest& generated) {
  const PlannedTest& plan = generated.plan;
  RigTest test;
  test.name = plan.name;
  test.axis = plan.axis;
  test.kind = plan.kind;
  if (plan.kind == TestKind::static_ramp)
    test.rate = plan.rate;
  else
    test.frequency = plan.frequency;
  test.time = generated.time;
  test.time_measured = true;
  test.displacement = generated.displacement;
  test.force = generated.force;
  return test;
}

RigRecord record_of(std::vector<RigTest> tests) {
  RigRecord rig;
  rig.specimen = "bench";
  rig.synthetic = true;
  rig.tests = std::move(tests);
  return rig;
}

}  // namespace grouser
