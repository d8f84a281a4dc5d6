#include "daemon/calibration_loop.hpp"

#include <array>
#include <atomic>
#include <regex>

#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

/// Three radars, the first wrong in everything, on two targets that turn.
const std::string kWrong = R"(
radar { name: "north" y_m: 50e3 range_noise_floor_m: 15 azimuth_noise_floor_deg: .05 detection_probability: .9
        truth { range_noise_scale: 2 azimuth_bias_deg: .2 } }
radar { name: "east" x_m: 50e3 y_m: -30e3 range_noise_floor_m: 30 azimuth_noise_floor_deg: .1 detection_probability: .9 }
radar { name: "west" x_m: -60e3 y_m: -35e3 range_noise_floor_m: 50 azimuth_noise_floor_deg: .15 detection_probability: .9 }
target { name: "one" x_m: 10e3 y_m: 20e3 vx_mps: 150 vy_mps: 20 jump_markov { area { radius_m: 40e3 } } }
target { name: "two" x_m: -20e3 y_m: 10e3 vx_mps: 30 vy_mps: -180 jump_markov { area { radius_m: 40e3 } } }
policy { round_robin {} }
)";

std::vector<v1::RadarCalibration> calibrations(const Recorder& stream) {
  std::vector<v1::RadarCalibration> all;
  for (const v1::Envelope& envelope : stream.envelopes) {
    if (envelope.has_radar_calibration()) all.push_back(envelope.radar_calibration());
  }
  return all;
}

TEST(Calibration, IsPublishedForEachRadarAtItsScan) {
  RecordedRun recorded(config_of(kWrong));
  for (const std::uint64_t asked : {25, 50, 100, 200}) {
    recorded.stream.envelopes.clear();
    recorded.scan(static_cast<int>(asked + 9 - recorded.run.scans()));
    EXPECT_TRUE(calibrations(recorded.stream).empty());
    recorded.scan(1);
    const auto published = calibrations(recorded.stream);
    ASSERT_EQ(published.size(), 3);
    for (std::uint32_t i = 0; i < 3; ++i) {
      EXPECT_EQ(published[i].radar(), i + 1);
      EXPECT_EQ(published[i].asked_scan(), asked);
      EXPECT_EQ(published[i].effective_scan(), asked + 10);
      EXPECT_EQ(published[i].failure(), "");
      EXPECT_FALSE(published[i].joint());
      EXPECT_FALSE(published[i].applied());
      EXPECT_EQ(published[i].parameter_size(), 5);
      EXPECT_TRUE(published[i].applied_value().empty());
    }
  }
}

TEST(Calibration, ObservingChangesNothingElse) {
  const auto without_calibration = [](const Recorder& stream) {
    std::vector<std::string> bodies;
    for (v1::Envelope envelope : stream.envelopes) {
      if (envelope.has_radar_calibration()) continue;
      envelope.clear_sequence();
      bodies.push_back(envelope.SerializeAsString());
    }
    return bodies;
  };
  RecordedRun off(config_of(kWrong + "calibration { mode: OFF }"));
  RecordedRun observes(config_of(kWrong));
  off.scan(230);
  observes.scan(230);
  EXPECT_TRUE(calibrations(off.stream).empty());
  EXPECT_EQ(without_calibration(off.stream), without_calibration(observes.stream));
}

TEST(Calibration, AppliedTheSameSeedGivesTheSameBytes) {
  // A bias of two sigma: four lose the simulation its tracks before it can be known.
  const std::string wrong = std::regex_replace(kWrong, std::regex("azimuth_bias_deg: .2"), "azimuth_bias_deg: .1");
  const DaemonConfig config = config_of(wrong + "calibration { mode: APPLY }");
  RecordedRun one(config);
  RecordedRun two(config);
  one.scan(350);
  two.scan(350);
  EXPECT_EQ(one.stream.bytes, two.stream.bytes);
  const auto published = calibrations(one.stream);
  ASSERT_GE(published.size(), 15);
  const v1::RadarCalibration& north = published[12];
  EXPECT_TRUE(north.applied());
  ASSERT_EQ(north.applied_value_size(), 5);
  // Found within 5 standard errors.
  const v1::CalibrationParameter& bias = north.parameter(3);
  EXPECT_TRUE(bias.observable());
  EXPECT_NEAR(bias.value(), 0.1, 5.0 * bias.standard_error());
  EXPECT_LE(bias.standard_error(), 0.05);
}

/// Looks of each radar in 400 scans under a policy that knows the first alone, and how many were owed.
std::array<std::uint64_t, 4> looks_with_exploration(const std::string& changes, bool west_up) {
  std::string fixed = std::regex_replace(kWrong, std::regex("round_robin \\{\\}"), "fixed { sensor: 1 }");
  fixed = std::regex_replace(fixed, std::regex("truth \\{.*\\} \\}"), "}");  // a wrong radar alone loses its tracks
  Engine engine(config_of(fixed + "calibration { mode: APPLY period_scans: 1000000 " + changes + " }").engine);
  engine.set_sensor(2, west_up);
  std::array<std::uint64_t, 4> looks{};
  while (engine.last().scan < 400) {
    engine.scan();
    looks[3] += engine.last().decision.owed;
  }
  for (std::size_t i = 0; i < 3; ++i) looks[i] = engine.counts().looks[i];
  return looks;
}

TEST(Calibration, RadarsThatNobodyUsesAreOwedTheirShareOfLooks) {
  using Looks = std::array<std::uint64_t, 4>;
  EXPECT_EQ(looks_with_exploration("", true), (Looks{380, 10, 10, 20}));
  EXPECT_EQ(looks_with_exploration("", false), (Looks{380, 20, 0, 20}));  // west is down
  EXPECT_EQ(looks_with_exploration("exploration: 0.02", true), (Looks{392, 4, 4, 8}));
  EXPECT_EQ(looks_with_exploration("exploration: 0", true), (Looks{400, 0, 0, 0}));
}

TEST(Calibration, ARequestBeginsASolveOnceAtATime) {
  RecordedRun recorded(config_of(kWrong));
  recorded.scan(36);
  v1::Request request;
  request.set_id("1");
  request.mutable_calibrate();
  const v1::Reply first = recorded.run.handle(request);
  ASSERT_TRUE(first.has_accepted());
  EXPECT_EQ(first.accepted().effective_scan(), 46);
  request.set_id("2");
  const v1::Reply second = recorded.run.handle(request);
  ASSERT_TRUE(second.has_refused());
  EXPECT_EQ(second.refused().reason(), v1::Refused::NOT_NOW);
  recorded.stream.envelopes.clear();
  recorded.scan(10);
  const auto published = calibrations(recorded.stream);
  ASSERT_EQ(published.size(), 3);
  EXPECT_TRUE(published[0].joint());
  EXPECT_EQ(published[0].failure(), "");
  EXPECT_EQ(published[0].parameter_size(), 5);
}

TEST(Calibration, OffOrWithoutARadarARequestIsRefused) {
  RecordedRun recorded(config_of(kWrong + "calibration { mode: OFF }"));
  v1::Request request;
  request.set_id("1");
  request.mutable_calibrate();
  EXPECT_EQ(recorded.run.handle(request).refused().reason(), v1::Refused::NOT_NOW);
}

TEST(Calibration, TooFewPlotsKeepTheOldValuesAndSayWhy) {
  RecordedRun recorded(config_of(kWrong + "calibration { mode: APPLY period_scans: 3 delay_scans: 1 }"));
  recorded.scan(4);
  const auto published = calibrations(recorded.stream);
  ASSERT_EQ(published.size(), 6);  // after scan 1, half of the first period, and after scan 3
  EXPECT_EQ(published[0].failure(), "too few plots");
  EXPECT_FALSE(published[0].applied());
  EXPECT_DOUBLE_EQ(published[0].applied_value(0), 1.0);
}

TEST(Calibration, AnOutcomeThatIsLateIsGivenUpAndJournalled) {
  const TemporaryDirectory directory;
  {
    JournalWriter journal(directory / "journal", {});
    RecordedRun recorded(config_of(kWrong + "calibration { period_scans: 50 delay_scans: 1 }"), &journal);
    recorded.run.set_real_time();
    recorded.scan(51);  // no time passes between the scans: a solve of some hundredths of a second is late
    const auto published = calibrations(recorded.stream);
    ASSERT_GE(published.size(), 3);
    EXPECT_EQ(published.back().failure(), "time limit");
  }
  EXPECT_TRUE(read_journal(directory / "journal").late.calibrations.contains(51));
}

/// A solver that never ends while there are scans: every scan is made, the old values stay, the reason is given.
TEST(Calibration, ASolverThatHangsDelaysNoScanAndChangesNothing) {
  const DaemonConfig config = config_of(kWrong + "calibration { mode: APPLY period_scans: 40 delay_scans: 5 }");
  std::atomic<bool> scanned = false;
  const auto decisions = [&](const CalibrationLoop::Solve& solver, bool asks) {
    scanned = false;
    Engine engine(config.engine);
    CalibrationLoop loop(engine, solver);
    loop.set_waits(false);
    std::vector<std::pair<std::size_t, std::size_t>> chosen;
    int given_up = 0;
    while (engine.last().scan < 300) {
      given_up += loop.before_scan() == CalibrationLoop::Event::kGivenUp;
      engine.scan();
      if (asks) loop.after_scan();
      chosen.emplace_back(engine.last().decision.pair(0).sensor, engine.last().decision.pair(0).track);
    }
    EXPECT_EQ(given_up, asks ? 9 : 0);  // asked after scans 10, 20, 40, 80, .., 280
    if (asks) {
      EXPECT_EQ(engine.calibrator().last()->estimate.status, EstimatorStatus::kTimeLimit);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(to_vector(engine.calibrator().radar(i)->applied), CorrectionVector::Zero());
    }
    scanned = true;
    scanned.notify_all();
    return chosen;
  };
  // Asked to stop it does not: it ends after the last scan, before the loop is gone.
  const auto hangs = [&](const CalibrationTask& /*task*/, const EstimatorSettings& /*settings*/) {
    scanned.wait(false);
    return CalibrationOutcome();
  };
  EXPECT_EQ(decisions(hangs, true), decisions(solve, false));
}

}  // namespace
}  // namespace dwell::testing
