#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"
#include "tracker/metrics/nees.hpp"
#include "tracker/metrics/nis.hpp"
#include "tracker/tracker.hpp"

/// Does the filter know how wrong it is? Truth is drawn from the model that the filter believes, so that at
/// any one time its NEES is chi-square with 4 degrees of freedom, and its innovations are white with
/// chi-square NIS, 2 degrees. Within a run the NEES is correlated from scan to scan: one scan of each run
/// counts, the last. Sums lie in the chi-square band of the false-alarm rate in tests/statistics.hpp; a
/// filter that believes a tenth of Q does not.
namespace dwell {
namespace {

constexpr double kScanPeriod_s = 1.0;
constexpr double kDensity = 10.0;  // m^2/s^3: with the sensors below a tracking index at which Q counts as much as R

struct Setting {
  const Sensor* sensor;
  Gaussian start;
  double believed_density;
  UpdateForm form = UpdateForm::kEkf;
  int scans = 30;
};

struct Sums {
  double nees = 0.0;  ///< of the whole state at the last scan of each run
  double position_nees = 0.0;
  double nis = 0.0;  ///< of every plot
  int nis_in_band = 0;
  int runs = 0;
  int plots = 0;
};

void run_once(const Setting& setting, RandomStream& stream, Sums& sums) {
  const StateMatrix f = transition(ConstantVelocity{}, kScanPeriod_s);
  const StateMatrix q = white_noise(ConstantVelocity{}, setting.believed_density, kScanPeriod_s);
  const StateMatrix q_root = white_noise(ConstantVelocity{}, kDensity, kScanPeriod_s).llt().matrixL();
  TrackerSettings settings;
  settings.update = setting.form;
  settings.gate = std::numeric_limits<double>::infinity();  // a gate would cut the tail off the NIS
  Tracker tracker({{f}, {q}, Eigen::MatrixXd::Ones(1, 1)}, Eigen::VectorXd::Ones(1), settings);
  Track track = tracker.start(TrackId{1}, "one", setting.start);
  const StateMatrix start_root = setting.start.covariance.llt().matrixL();
  State truth = setting.start.mean + start_root * matrices::normal_state(stream);
  for (int k = 1; k <= setting.scans; ++k) {
    truth = f * truth + q_root * matrices::normal_state(stream);
    tracker.predict(track);
    const Matrix2 r_root = setting.sensor->noise(truth).llt().matrixL();
    Vector2 z = setting.sensor->measure(truth) + r_root * Vector2(stream.normal(), stream.normal());
    const TimePoint time = kStreamStart + from_seconds(k * kScanPeriod_s);
    const Plot plot{time, RadarId{1}, z, std::nullopt};
    (void)tracker.look(track, *setting.sensor, {RadarId{1}, TrackId{1}, time, track.combined.mean}, {&plot, 1});
    ASSERT_TRUE(track.nis);
    sums.nis += *track.nis;
    sums.nis_in_band += kNisBand.contains(*track.nis) ? 1 : 0;
    ++sums.plots;
  }
  sums.nees += nees(truth, track.combined);
  sums.position_nees += position_nees(truth, track.combined);
  ++sums.runs;
}

Sums run(const Setting& setting, int runs) {
  RandomStream stream(1);
  Sums sums;
  for (int i = 0; i < runs; ++i) run_once(setting, stream, sums);
  return sums;
}

bool nees_fits(const Sums& sums) {
  return statistics::chi_square_band(4.0 * sums.runs).contains(sums.nees) &&
         statistics::chi_square_band(2.0 * sums.runs).contains(sums.position_nees);
}

bool nis_fits(const Sums& sums) { return statistics::chi_square_band(2.0 * sums.plots).contains(sums.nis); }

void record_means(const Sums& sums) {
  testing::Test::RecordProperty("mean_nees", testing::PrintToString(sums.nees / sums.runs));
  testing::Test::RecordProperty("mean_position_nees", testing::PrintToString(sums.position_nees / sums.runs));
  testing::Test::RecordProperty("mean_nis", testing::PrintToString(sums.nis / sums.plots));
}

/// Correlated errors of 5 and 8 m on the axes, after a start within 100 m and 20 m/s.
Setting linear_setting(double believed_density) {
  static const LinearSensor sensor(position_selector(), (Matrix2() << 25.0, 16.0, 16.0, 64.0).finished(), 1.0);
  return {&sensor, {{1e3, 50.0, -2e3, 80.0}, State(1e4, 400.0, 1e4, 400.0).asDiagonal()}, believed_density};
}

// q and q / 10 over 2000 last scans and 60 000 plots.
TEST(Consistency, LinearFilterHasChiSquareNees) {
  const Sums matched = run(linear_setting(kDensity), scaled(2000));
  record_means(matched);
  EXPECT_TRUE(nees_fits(matched)) << matched.nees / matched.runs << " and " << matched.position_nees / matched.runs;
}

TEST(Consistency, NeesSeesATenthOfTheNoise) {
  const Sums overconfident = run(linear_setting(kDensity / 10.0), scaled(2000));
  record_means(overconfident);
  EXPECT_FALSE(nees_fits(overconfident)) << overconfident.nees / overconfident.runs;
}

// Innovations of a matched linear filter are independent: a single long run is as good as many.
TEST(Consistency, LinearFilterHasChiSquareNisOverOneRun) {
  Setting setting = linear_setting(kDensity);
  setting.scans = scaled(20000);
  const Sums matched = run(setting, 1);
  record_means(matched);
  EXPECT_TRUE(nis_fits(matched)) << matched.nis / matched.plots;
}

// Each of these 20 000 independent NIS lies in its own 95 % band except once in twenty times.
TEST(Consistency, NisIsInItsBandNineteenTimesOfTwenty) {
  Setting setting = linear_setting(kDensity);
  setting.scans = scaled(20000);
  const Sums matched = run(setting, 1);
  RecordProperty("share_in_band", testing::PrintToString(static_cast<double>(matched.nis_in_band) / matched.plots));
  const statistics::Band share = statistics::binomial_band(matched.plots, 0.95);
  EXPECT_TRUE(share.contains(matched.nis_in_band)) << matched.nis_in_band << " of " << matched.plots;
  setting.believed_density = kDensity / 10.0;
  EXPECT_FALSE(share.contains(run(setting, 1).nis_in_band));
}

TEST(Consistency, NisSeesATenthOfTheNoise) {
  Setting setting = linear_setting(kDensity / 10.0);
  setting.scans = scaled(20000);
  const Sums overconfident = run(setting, 1);
  record_means(overconfident);
  EXPECT_FALSE(nis_fits(overconfident)) << overconfident.nis / overconfident.plots;
}

/// 5 m and 0.5 mrad, 60 km away, 30 m across: the curvature of the range, (30 m)^2 / (2 x 60 km) = 8 mm, is
/// 2e-3 of a sigma, and its square in NEES and NIS is far below the band, which is some per cent wide.
Setting radar_setting(double believed_density, UpdateForm form) {
  RadarFigures figures;
  figures.snr_reference = 1e30;  // the floors alone make the noise
  figures.range_noise_floor_m = 5.0;
  figures.azimuth_noise_floor_rad = 0.5e-3;
  static const RangeBearingRadar radar(figures);
  return {&radar, {{-3e4, 100.0, -52e3, 170.0}, State(1e4, 400.0, 1e4, 400.0).asDiagonal()}, believed_density, form};
}

class RadarConsistency : public testing::TestWithParam<UpdateForm> {};

INSTANTIATE_TEST_SUITE_P(Forms, RadarConsistency, testing::ValuesIn(catalogue::every_update()),
                         [](const auto& row) { return catalogue::name_of(row.param); });

TEST_P(RadarConsistency, HasChiSquareNeesAndNis) {
  const Sums matched = run(radar_setting(kDensity, GetParam()), scaled(2000));
  record_means(matched);
  EXPECT_TRUE(nees_fits(matched)) << matched.nees / matched.runs << " and " << matched.position_nees / matched.runs;
  EXPECT_TRUE(nis_fits(matched)) << matched.nis / matched.plots;
}

TEST_P(RadarConsistency, SeesATenthOfTheNoise) {
  const Sums overconfident = run(radar_setting(kDensity / 10.0, GetParam()), scaled(2000));
  record_means(overconfident);
  EXPECT_FALSE(nees_fits(overconfident)) << overconfident.nees / overconfident.runs;
  EXPECT_FALSE(nis_fits(overconfident)) << overconfident.nis / overconfident.plots;
}

// Errors of one sigma on each of four uncorrelated components: 1 each. Position alone: 2.
TEST(Nees, CountsSigmas) {
  const Gaussian estimate{{10.0, 1.0, 20.0, 2.0}, State(4.0, 9.0, 100.0, 16.0).asDiagonal()};
  EXPECT_EQ(nees(State(12.0, 4.0, 10.0, 6.0), estimate), 4.0);
  EXPECT_EQ(position_nees(State(12.0, 40.0, 10.0, 60.0), estimate), 2.0);
}

}  // namespace
}  // namespace dwell
