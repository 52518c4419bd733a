#include "model/replay.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "model/provenance.h"
#include "model/rig_writer.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

ReplayRecord record() {
  ReplayRecord replay;
  replay.specimen = "track bushing";
  replay.bushing = "law";
  for (const bool prediction : {false, true}) {
    TestFit& test = replay.tests.emplace_back();
    test.name = prediction ? "protocol" : "measured";
    test.axis = prediction ? Axis::ry : Axis::x;
    test.prediction = prediction;
    test.samples = 401;
    test.cycles = 2;
    test.cycles_used = 1;
    test.frequency = 0.5;
    test.amplitude = 1e-3;
    test.fitted = {1.01e8, 12.4, 1.9e4, 0.098, 0.96e8, 0.95e8, 0.94e7};
    test.per_cycle.push_back({2, true, "", 1e-3, {}, test.fitted, 0.0});
    test.curve = {{0.0, 1e-3}, {}, {0.0, 1.01e5}};
    if (prediction) continue;
    test.measured = test.per_cycle[0].measured = {1e8, 12.5, 2e4, 0.1, 0.97e8, 0.98e8, 0.99e7};
    test.nrmse = test.per_cycle[0].nrmse = 0.01;
    test.r_squared = 0.999;
    test.curve.force = {0.0, 1e5};
  }
  replay.warnings.push_back({"outside_valid_range", "protocol", "driven far"});
  replay.corrections.push_back({"rig_compliance", "", "taken out"});
  return replay;
}

TEST(ReplayFile, GivesTheSameBytesWhenWrittenAgain) {
  // Every member that is written is also read: one that the reader drops would come back as its default.
  const TemporaryFolder folder;
  write_replay(record(), folder.path() / "a.json");
  const ReplayRecord again = read_replay(folder.path() / "a.json");
  EXPECT_TRUE(again.tests.at(1).prediction);
  EXPECT_EQ(again.tests.at(1).per_cycle.at(0).fitted.dissipated_energy, 12.4);
  write_replay(again, folder.path() / "b.json");
  EXPECT_EQ(read_whole(folder.path() / "b.json"), read_whole(folder.path() / "a.json"));
}

TEST(ReplayFile, HoldsNothingMeasuredOfAPrediction) {
  const TemporaryFolder folder;
  write_replay(record(), folder.path() / "a.json");
  const auto tests = nlohmann::json::parse(read_whole(folder.path() / "a.json"))["tests"];
  for (const char* key : {"nrmse", "r_squared", "dissipated_energy_J", "loss_factor"}) {
    EXPECT_TRUE(tests[0].contains(key) && tests[0]["per_cycle"][0].contains(key) != (key == std::string("r_squared")));
    EXPECT_FALSE(tests[1].contains(key) || tests[1]["per_cycle"][0].contains(key)) << key;
  }
  EXPECT_FALSE(tests[1]["curve"].contains("force_N_m"));
  EXPECT_EQ(tests[1]["fitted"]["dissipated_energy_J"], 12.4);
}

TEST(RigWriter, WritesWhatTheReaderReadsToTheLastBit) {
  RigRecord rig;
  rig.specimen = "law";
  rig.synthetic = true;
  rig.synthetic_note = "computed";
  for (const Axis axis : {Axis::z, Axis::ry}) {
    RigTest& test = rig.tests.emplace_back();
    test.name = std::string("test ") + name_of(axis);
    test.axis = axis;
    test.kind = axis == Axis::z ? TestKind::static_ramp : TestKind::cyclic;
    test.file = std::string(name_of(axis)) + ".csv";
    test.time = {0.0, 0.1, 1.0 / 3.0};
    test.time_measured = true;
    test.displacement = {1e-9 / 3.0, -2.0 / 7.0, 0.3};
    test.force = {98066.5, -1.0 / 3.0, 5e-324};
  }
  rig.tests[1].preset = 0.1 + 0.2;
  rig.tests[1].discard_cycles = 4;
  const TemporaryFolder folder;
  write_rig(rig, folder.path());
  const RigRecord again = read_rig(folder.path() / "rig.json");
  EXPECT_EQ(again.specimen, rig.specimen);
  EXPECT_EQ(again.synthetic_note, rig.synthetic_note);
  ASSERT_EQ(again.tests.size(), rig.tests.size());
  for (std::size_t i = 0; i < rig.tests.size(); ++i) {
    const RigTest &a = again.tests[i], &b = rig.tests[i];
    EXPECT_EQ(std::tie(a.name, a.axis, a.kind, a.file, a.preset, a.discard_cycles, a.time_measured),
              std::tie(b.name, b.axis, b.kind, b.file, b.preset, b.discard_cycles, b.time_measured));
    EXPECT_EQ(std::tie(a.time, a.displacement, a.force), std::tie(b.time, b.displacement, b.force));
  }
}

}  // namespace
}  // namespace grouser
