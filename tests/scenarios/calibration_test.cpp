// Calibration of radars whose config is wrong, against the truth and against the Cramer-Rao bound: the inverse of the
// information at the true parameters of the plots that the tracker kept under the schedule that was executed, with the
// tracker's bank of modes as motion prior, and a prior of the parameters whose sigma is the change that is tried.

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "daemon/study/calibration_figures.hpp"
#include "tests/scenarios/calibrated_run.hpp"
#include "tests/statistics.hpp"

namespace dwell::testing {
namespace {

using Kind = CorrectionKind;

struct Change {
  const char* name;
  Kind kind;
  std::vector<int> radars;  ///< that are wrong
  double value;
};

const std::vector<Change> kChanges{{"range noise x 3", Kind::kLogRangeScale, {0, 1, 2}, std::log(3.0)},
                                   {"range noise x 0.5", Kind::kLogRangeScale, {0, 1, 2}, std::log(0.5)},
                                   {"azimuth noise x 3", Kind::kLogAzimuthScale, {0, 1, 2}, std::log(3.0)},
                                   {"azimuth noise x 0.5", Kind::kLogAzimuthScale, {0, 1, 2}, std::log(0.5)},
                                   {"range bias 30 m", Kind::kRangeBias, {0}, 30.0},
                                   {"azimuth bias 0.2 deg", Kind::kAzimuthBias, {0}, 0.2 * kDegree}};

/// The scenario with the change, and a prior that expects changes of that size.
EngineConfig changed(const std::string& name, const Change& change) {
  EngineConfig config = scenario(name, RoundRobinSettings{RoundRobinSettings::Order::kTrackFastest});
  for (const int radar : change.radars) {
    CorrectionVector truth = CorrectionVector::Zero();
    truth[static_cast<int>(change.kind)] = change.value;
    config.sensors[radar].truth.correction = to_correction(truth);
  }
  CorrectionPrior& prior = config.calibration.prior;
  switch (change.kind) {
    case Kind::kRangeBias:
      prior.range_bias_m = std::abs(change.value);
      break;
    case Kind::kAzimuthBias:
      prior.azimuth_bias_rad = std::abs(change.value);
      break;
    default:
      prior.log_scale = std::abs(change.value);
  }
  return config;
}

CalibrationFigures study(const EngineConfig& config, int runs, bool joint, std::uint64_t scans = 600) {
  CalibrationStudyOptions options;
  options.runs = runs;
  options.scans = scans;
  options.joint = joint;
  const std::atomic<bool> never{false};
  return study_calibration(config, options, never, [](int, int) {});
}

void print(const CalibrationFigures& figures, Kind kind) {
  const double unit = kind == Kind::kAzimuthBias ? kDegree : 1.0;
  for (const CalibratedRadar& radar : figures.radars) {
    const CalibratedParameter& p = radar.parameters[static_cast<int>(kind)];
    std::printf(
        "  %-10s truth %8.4f mean %8.4f rms error %7.4f reported %7.4f bound %7.4f within 2 %.3f 3 %.3f observable "
        "%.2f  NIS %.2f -> %.2f, in its band %.2f -> %.2f, %.0f plots\n",
        radar.name.c_str(), p.truth / unit, p.mean / unit, std::sqrt(p.squared_error) / unit, p.standard_error / unit,
        p.bound / unit, 1.0 * p.within_two / figures.solved, 1.0 * p.within_three / figures.solved,
        1.0 * p.observable / figures.solved, radar.nis_before, radar.nis_after,
        1.0 * radar.in_band_before / figures.solved, 1.0 * radar.in_band_after / figures.solved, radar.plots);
  }
}

/// Of `runs` trials the share `low` is asked for, and of a share that is to lie below it, `high`; what chance leaves.
void expect_share(int count, int runs, double low, double high) {
  EXPECT_GE(count, statistics::binomial_band(runs, low).low);
  EXPECT_LE(count, statistics::binomial_band(runs, high).high);
}

/// What a reported standard error may be off its bound.
constexpr double kReported = 0.15;

/// The mean information of a few runs, of a mixture at the truth, is no bound yet: it need not even be positive.
bool has_bound(const CalibrationFigures& figures) { return figures.solved >= 50; }

/// A parameter is tried where its bound is at most a fifth of the change. Elsewhere it is not observable, which the
/// reported standard errors decide: as far off the bound as they may be.
void expect_known(const CalibrationFigures& figures, const Change& change, double within_three) {
  ASSERT_EQ(figures.solved, figures.runs) << figures.failure;
  for (const int i : change.radars) {
    const CalibratedParameter& p = figures.radars[i].parameters[static_cast<int>(change.kind)];
    SCOPED_TRACE(figures.radars[i].name);
    if (has_bound(figures) && p.bound > 0.2 * std::abs(change.value)) {
      if (p.bound * (1.0 - kReported) > 0.2 * std::abs(change.value)) {
        EXPECT_EQ(p.observable, 0);
      }
      continue;
    }
    expect_share(p.within_three, figures.solved, within_three, 1.0);
    expect_share(p.within_two, figures.solved, 0.88, 0.98);
    if (has_bound(figures)) {
      EXPECT_NEAR(p.standard_error / p.bound, 1.0, kReported);
    }
  }
}

struct Case {
  const char* scenario;
  Change change;
};

std::vector<Case> cases(const char* name) {
  std::vector<Case> all;
  for (const Change& change : kChanges) all.push_back({name, change});
  return all;
}

class Calibration : public ::testing::TestWithParam<Case> {};

TEST_P(Calibration, FindsWhatIsWrongWithinWhatItReports) {
  const auto& [name, change] = GetParam();
  const bool simulated = std::string(name) == "calibration_traffic";
  const CalibrationFigures figures = study(changed(name, change), soak() ? 200 : 1, false);
  std::printf("%s, %s, %d runs\n", name, change.name, figures.runs);
  print(figures, change.kind);
  expect_known(figures, change, simulated ? 0.98 : 0.95);
  const bool noisier = change.value == std::log(3.0);
  for (const CalibratedRadar& radar : figures.radars) {
    // The band holds 95 % of matched radars; estimated noise draws the mean to its middle.
    if (simulated) {
      expect_share(radar.in_band_after, figures.solved, 0.95, 1.0);
    }
    if (noisier) {  // what is less noisy than believed hides behind the tracks' own uncertainty
      EXPECT_LE(radar.in_band_before, statistics::binomial_band(figures.solved, 0.05).high);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Traffic, Calibration, ::testing::ValuesIn(cases("calibration_traffic")));
INSTANTIATE_TEST_SUITE_P(Recorded, Calibration, ::testing::ValuesIn(cases("recorded_flights")));

class JointCalibration : public ::testing::TestWithParam<bool> {};

/// Recorded flights as targets; with their positions known, as of calibration flights, and without.
TEST_P(JointCalibration, FindsBiasesOfRecordedFlights) {
  for (const Change& change : {kChanges[4], kChanges[5]}) {
    EngineConfig config = changed("recorded_flights", change);
    for (TargetConfig& target : config.targets) target.calibration_flight = GetParam();
    const CalibrationFigures figures = study(config, soak() ? 200 : 1, true);
    std::printf("recorded_flights, %s, jointly, %s, %d runs\n", change.name, GetParam() ? "known truth" : "unknown",
                figures.runs);
    print(figures, change.kind);
    expect_known(figures, change, 0.95);
    // All radars' biases, the right ones too: the error is that of the bound. Its mean square over n runs is
    // chi-square with n degrees of freedom.
    const auto band = statistics::chi_square_band(figures.solved);
    for (const CalibratedRadar& radar : figures.radars) {
      const CalibratedParameter& p = radar.parameters[static_cast<int>(change.kind)];
      if (!has_bound(figures)) continue;
      EXPECT_NEAR(p.standard_error / p.bound, 1.0, kReported) << radar.name;
      const double largest = (1.0 + kReported) * p.bound;
      EXPECT_LE(figures.solved * p.squared_error, band.high * largest * largest) << radar.name;
      // What is common to all clocks is not to be had from flights that are not known.
      const int seen = radar.parameters[static_cast<int>(Kind::kTimeBias)].observable;
      if (!GetParam()) {
        EXPECT_EQ(seen, 0) << radar.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Recorded, JointCalibration, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "KnownTruth" : "Unknown"; });

/// 0.2 degrees at the best radar: after 25 scans the bound is to allow three sigma, and so the reports.
TEST(CalibrationInTime, SeesAnAzimuthBiasWithin25Scans) {
  const EngineConfig config = changed("calibration_traffic", kChanges[5]);
  const int runs = soak() ? 200 : 5;
  const CalibrationFigures early = study(config, runs, false, 25);
  std::printf("azimuth bias 0.2 deg after 25 scans\n");
  print(early, Kind::kAzimuthBias);
  const CalibratedParameter& p = early.radars[0].parameters[static_cast<int>(Kind::kAzimuthBias)];
  EXPECT_LE(3.0 * p.bound, 0.2 * kDegree);
  EXPECT_GE(p.mean, 3.0 * p.standard_error);
}

/// Three tenths of the azimuth's sigma after 100 scans, or what the bound allows: of the best radar, which the others
/// are too coarse to check, no more than half a sigma as long as the flights are unknown.
TEST(CalibrationInTime, KnowsAzimuthBiasesToPartOfSigmaFrom100Scans) {
  for (const bool known : {false, true}) {
    EngineConfig config = changed("calibration_traffic", kChanges[5]);
    for (TargetConfig& target : config.targets) target.calibration_flight = known;
    const CalibrationFigures figures = study(config, soak() ? 200 : 3, false, 100);
    std::printf("azimuth bias 0.2 deg after 100 scans, flights %s\n", known ? "known" : "unknown");
    print(figures, Kind::kAzimuthBias);
    for (std::size_t i = 0; i < 3; ++i) {
      const double asked = 0.3 * std::get<RadarFigures>(config.sensors[i].figures).azimuth_noise_floor_rad;
      const CalibratedParameter& p = figures.radars[i].parameters[static_cast<int>(Kind::kAzimuthBias)];
      EXPECT_NEAR(p.standard_error / p.bound, 1.0, kReported) << i;
      if (known || i > 0) {
        EXPECT_LE(p.standard_error, asked) << i;
      } else {
        EXPECT_GT(p.bound, asked);
      }
    }
  }
}

}  // namespace
}  // namespace dwell::testing
