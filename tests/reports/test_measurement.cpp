#include "reports/measurement.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "model/errors.h"
#include "model/provenance.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// A mock run and tables that were "measured" on it.
class Measurements : public testing::Test {
 protected:
  void SetUp() override { mock::write_run(folder_ / "run", {.name = "Run A"}); }

  Measurement read(const std::string& text, const ReportOptions& options = {}, const std::string& name = "drive.csv") {
    write_whole(folder_ / name, text);
    return read_measurement(folder_ / name, channels_of(open_run(folder_ / "run")), options);
  }
  std::string refused(const std::string& text, const ReportOptions& options = {}) {
    try {
      read(text, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }
  /// The run's own torque in kN m, changed by `change`, by a clock that is `late`.
  template <typename Change>
  std::string table(const Change& change, double late = 0.0) {
    const RunFolder run = open_run(folder_ / "run");
    const std::vector<RunChannel> channels = channels_of(run);
    const TimeSeries torque = read_channel(run, *channels_called(channels, "sprocket_torque_left").front());
    std::string text = "Time [ms];Sprocket_torque_left [kN m];Remark\n";
    for (std::size_t i = 0; i < torque.time.size(); ++i)
      text += std::to_string(1e3 * (torque.time[i] + late)) + ";" + std::to_string(1e-3 * change(torque.value[i])) +
              ";ok\n";
    return text;
  }
  json report(const std::string& text, const ReportOptions& given = {}) {
    write_whole(folder_ / "drive.csv", text);
    ReportOptions options = given;
    options.against = folder_ / "drive.csv";
    verdicts_ = write_report({folder_ / "run"}, folder_ / "report.html", options);
    return json::parse(read_whole(folder_ / "report.json"));
  }
  static json cell(const json& row, const std::string& key) {
    for (const char* list : {"cells", "further"})
      for (const json& entry : row[list])
        if (entry["key"] == key) return entry;
    return {};
  }
  test::TemporaryFolder folder_;
  std::vector<ChannelVerdict> verdicts_;
};

TEST_F(Measurements, ColumnsAreFoundByTheNameOfAChannelWhateverTheUnit) {
  const Measurement found = read("time_ms,Speed_km_per_h,chassis_velocity_x_m_per_s,note\n0,36,1,a\n10,72,2,b\n");
  ASSERT_THAT(found.channels, SizeIs(2));
  EXPECT_EQ(found.channels[0].channel.name, "speed");
  EXPECT_THAT(found.channels[0].series.value, ElementsAre(10.0, 20.0));
  EXPECT_THAT(found.channels[0].series.time, ElementsAre(0.0, 0.01));
  EXPECT_EQ(found.channels[1].channel.name, "chassis_velocity_x");
  EXPECT_THAT(found.left_out, ElementsAre("note"));
  EXPECT_THAT(found.sha256, SizeIs(64));
}

TEST_F(Measurements, AnExportedFileIsReadAsItStands) {
  const Measurement found = read("time_s,bushing_force_x_N\n0,1\n1,2\n", {}, "probes_right_20_bushing_force.csv");
  EXPECT_EQ(found.channels[0].channel.name, "probes_right_20_bushing_force_x");
}

TEST_F(Measurements, OtherNamesAndSignsAreSaidOnTheCommandLine) {
  ReportOptions options;
  options.channels = {{"Zeit", "time"}, {"DMS 12", "-sprocket_torque_left"}};
  options.shift = -2.0;
  const Measurement found = read("Zeit [s];DMS 12 [kN m];speed [m/s]\n2;5;1\n3;-6;1\n", options);
  ASSERT_THAT(found.channels, SizeIs(1));
  EXPECT_TRUE(found.channels[0].reversed);
  EXPECT_THAT(found.channels[0].series.value, ElementsAre(-5000.0, 6000.0));
  EXPECT_THAT(found.channels[0].series.time, ElementsAre(0.0, 1.0));
}

TEST_F(Measurements, FieldsThatAreLeftFreeAreNoSamples) {
  const Measurement found = read("time_s,speed_m_per_s,yaw_rate_deg_per_s\n0,1,\n1,,180\n2,3,NaN\n");
  EXPECT_THAT(found.channels[0].series.time, ElementsAre(0.0, 2.0));
  EXPECT_THAT(found.channels[1].series.time, ElementsAre(1.0));
}

TEST_F(Measurements, NamesInLatin1ComeOutInUtf8) {
  EXPECT_THAT(read("time_s,speed_m_per_s,R\xFC"
                   "cklauf_N\n0,1,1\n1,2,1\n")
                  .left_out,
              ElementsAre("Rücklauf_N"));
}

TEST_F(Measurements, WhatIsWrongIsToldWithTheNearestChannel) {
  EXPECT_THAT(
      refused("time_s,sped_m_per_s\n0,1\n1,2\n"),
      HasSubstr("drive.csv: row 1, column sped_m_per_s: expected the name of a channel, found sped (did you mean "
                "speed?)"));
  EXPECT_THAT(refused("time_s,speed_kN\n0,1\n1,2\n"), HasSubstr("expected a unit of speed for speed"));
  EXPECT_THAT(refused("time_s,speed\n0,1\n1,2\n"), HasSubstr("found no unit"));
  EXPECT_THAT(refused("speed_m_per_s,x_m\n1,2\n"), HasSubstr("expected a column time with its unit"));
  EXPECT_THAT(refused("time_s,oil temperature_degC\n0,1\n1,2\n"), HasSubstr("called like a channel of the run"));
  EXPECT_THAT(refused("time_s,bushing_force_20_x_N\n0,1\n1,2\n"),
              HasSubstr("(one of tracks_left_bushing_force_20_x, tracks_right_bushing_force_20_x)"));
  EXPECT_THAT(refused("time_s,speed_m_per_s\n0,1\n1,2\n1,3\n"),
              HasSubstr("expected a time that rises from sample to sample, found 1 s after 1 s, at sample 3"));
  EXPECT_THAT(refused("time_s,speed_m_per_s\n0,1\n1,fast\n"), HasSubstr("row 3, column speed_m_per_s"));
  ReportOptions options;
  options.channels = {{"sped", "speed"}, {"speed", "spede"}};
  EXPECT_THAT(refused("time_s,speed_m_per_s\n0,1\n1,2\n", options),
              testing::AllOf(HasSubstr("the column sped of --channel"), HasSubstr("did you mean speed?"),
                             HasSubstr("--channel speed: expected the name of a channel")));
}

TEST_F(Measurements, TheRunsOwnChannelIsLikeItself) {
  const json page = report(table([](double torque) { return torque; }));
  const json& row = page["against"][0]["ratings"]["rows"][0];
  EXPECT_EQ(row["name"], "probes_sprocket_torque_left");
  EXPECT_GT(cell(row, "iso")["value"], 0.99);  // six digits of the file
  EXPECT_EQ(page["against"][0]["verdict"]["text"], "The channel meets every limit");
  ASSERT_THAT(verdicts_, SizeIs(1));
  EXPECT_TRUE(verdicts_[0].pass);
}

// The run shows 1/1.5 of what was measured: M = -1/3, and the peaks in that ratio.
TEST_F(Measurements, AScaleShowsInMagnitudeAndFailsTheLimits) {
  const json page = report(table([](double torque) { return 1.5 * torque; }));
  const json& row = page["against"][0]["ratings"]["rows"][0];
  EXPECT_NEAR(cell(row, "magnitude")["value"].get<double>(), -1.0 / 3.0, 1e-3);
  EXPECT_NEAR(cell(row, "peak")["value"].get<double>(), 1.0 / 1.5, 1e-3);
  EXPECT_EQ(row["pass"], false);
  EXPECT_THAT(row["verdict"].get<std::string>(), HasSubstr("missed: "));
  EXPECT_EQ(cell(row, "correlation")["pass"], true);
  EXPECT_FALSE(verdicts_[0].pass);
}

// The measurement is 10 ms late, so the run is early.
TEST_F(Measurements, ALateMeasurementShowsInTheLagAndAShiftMendsIt) {
  const std::string late = table([](double torque) { return torque; }, 0.010);
  EXPECT_NEAR(cell(report(late)["against"][0]["ratings"]["rows"][0], "lag")["value"].get<double>(), -0.010, 1e-9);
  ReportOptions options;
  options.shift = -0.010;
  options.limits = {"lag_ms=1"};
  const json mended = report(late, options);
  EXPECT_NEAR(cell(mended["against"][0]["ratings"]["rows"][0], "lag")["value"].get<double>(), 0.0, 1e-9);
  EXPECT_THAT(mended["against"][0]["provenance"]["commands"].back().get<std::string>(),
              HasSubstr("--shift -0.01 --limit lag_ms=1"));
}

TEST_F(Measurements, AWindowIsKeptTo) {
  ReportOptions options;
  options.from = 0.8;
  options.to = 1.2;
  const json row = report(table([](double torque) { return torque; }), options)["against"][0]["ratings"]["rows"][0];
  EXPECT_NEAR(row["from"]["value"].get<double>(), 0.8, 1e-9);
  EXPECT_NEAR(row["to"]["value"].get<double>(), 1.2, 1e-9);
}

TEST_F(Measurements, WhatCannotBeRatedIsNotCalledAPass) {
  const json page = report("time_s,speed_m_per_s\n0,5\n1,5\n2,5\n");
  EXPECT_EQ(page["against"][0]["verdict"]["pass"], false);
  EXPECT_THAT(verdicts_[0].text, HasSubstr("not rated: they share only 3 samples"));
}

TEST_F(Measurements, NamesOfColumnsAreTextOnThePage) {
  ReportOptions options;
  options.channels = {{"<script>alert(1)</script>", "speed"}};
  report("time_s,<script>alert(1)</script>_m_per_s\n0,1\n1,2\n", options);
  const std::string html = read_whole(folder_ / "report.html");
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert(1)"));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert(1)")));
}

TEST_F(Measurements, OnlyRunsAreHeldAgainstThem) {
  mock::write_fit_folder(folder_ / "fit");
  write_whole(folder_ / "drive.csv", "time_s,speed_m_per_s\n0,1\n1,2\n");
  ReportOptions options;
  options.against = folder_ / "drive.csv";
  EXPECT_THROW(write_report({folder_ / "run", folder_ / "fit"}, folder_ / "report.html", options), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
}

TEST_F(Measurements, EveryChannelThatIsListedCanBeRead) {
  const RunFolder run = open_run(folder_ / "run");
  int derived = 0;
  for (const RunChannel& channel : channels_of(run)) {
    if (!channel.column.dataset.empty() && channel.column.index.size() > 1) continue;  // the links, one by one
    const TimeSeries series = read_channel(run, channel);
    EXPECT_EQ(series.time.size(), series.value.size()) << channel.name;
    EXPECT_FALSE(channel.meaning.empty()) << channel.name;
    derived += channel.column.dataset.empty() ? 1 : 0;
  }
  EXPECT_EQ(derived, 10);
}

// The mock stands level: an accelerometer shows gravity, upwards.
TEST_F(Measurements, AnAccelerometerAtRestShowsGravity) {
  const RunFolder run = open_run(folder_ / "run");
  const std::vector<RunChannel> channels = channels_of(run);
  const TimeSeries up = read_channel(run, *channels_called(channels, "accelerometer_z").front());
  EXPECT_NEAR(up.value.front(), run.scenario.gravity, 1e-12);
}

TEST_F(Measurements, RunsAreRatedAgainstTheFirstOne) {
  mock::write_run(folder_ / "twin", {.name = "Twin"});
  mock::write_run(folder_ / "slow", {.name = "Slow", .top_speed = 30.0});
  write_report({folder_ / "run", folder_ / "twin", folder_ / "slow"}, folder_ / "report.html");
  const json page = json::parse(read_whole(folder_ / "report.json"));
  const json& ratings = page["comparison"]["ratings"];
  ASSERT_EQ(ratings.size(), 2u);
  const json& twin = ratings[0]["rows"][0];
  const json& slow = ratings[1]["rows"][0];
  EXPECT_EQ(twin["name"], "speed");
  EXPECT_EQ(cell(twin, "iso")["value"], 1.0);
  EXPECT_NEAR(cell(slow, "magnitude")["value"].get<double>(), 30.0 / 45.0 - 1.0, 1e-9);
  for (const json& block : ratings)
    for (const json& row : block["rows"]) EXPECT_EQ(row["mark"], "");  // another run is not a wrong one
}

}  // namespace
}  // namespace grouser
