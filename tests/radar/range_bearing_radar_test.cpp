#include "radar/range_bearing_radar.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "radar/random.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell {
namespace {

constexpr double kPi = std::numbers::pi;

State at(const Vector2& position_m) { return make_state(position_m, {0.0, 0.0}); }
State at(const RadarFigures& figures, double range_m, double azimuth_deg) {
  return at(to_cartesian(figures.position_m, {range_m, azimuth_deg * kDegree}));
}

RadarFigures off_the_origin() {
  RadarFigures figures;
  figures.position_m = {120e3, -40e3};
  return figures;
}

TEST(RangeBearingRadar, SnrFallsWithTheFourthPowerOfRange) {
  const RangeBearingRadar radar({});
  EXPECT_DOUBLE_EQ(radar.snr(100e3), 1e5);
  EXPECT_DOUBLE_EQ(radar.snr(50e3), 16e5);
  EXPECT_DOUBLE_EQ(radar.snr(1000e3), 10.0);
}

// Hand values of scenario 1 of Evans: c tau / 2 = 299792458 x 50e-9 / 2 = 7.49481145 m, SNR 1e5 at 100 km,
//   sigma_range = 7.49481145 / sqrt(2e5) = 0.0167589079 m,
//   sigma_azimuth = (pi / 180) / 1.6 / sqrt(2e5) = 2.43917178e-5 rad; both grow with the square of range.
TEST(RangeBearingRadar, NoiseAtTheReferenceIsTheHandValue) {
  const RangeBearingRadar radar({});
  EXPECT_NEAR(radar.range_sigma_m(100e3), 0.0167589079, 1e-10);
  EXPECT_NEAR(radar.azimuth_sigma_rad(100e3), 2.43917178e-5, 1e-13);
  EXPECT_NEAR(radar.range_sigma_m(200e3), 4.0 * 0.0167589079, 1e-9);
  EXPECT_NEAR(radar.azimuth_sigma_rad(50e3), 0.25 * 2.43917178e-5, 1e-13);
}

TEST(RangeBearingRadar, RangeNoiseGoesWithThePulseAndAzimuthNoiseWithTheBeam) {
  RadarFigures figures;
  figures.pulse_length_s *= 3.0;
  EXPECT_DOUBLE_EQ(RangeBearingRadar(figures).range_sigma_m(7e4), 3.0 * RangeBearingRadar({}).range_sigma_m(7e4));
  EXPECT_DOUBLE_EQ(RangeBearingRadar(figures).azimuth_sigma_rad(7e4), RangeBearingRadar({}).azimuth_sigma_rad(7e4));
  figures.beamwidth_rad *= 2.0;
  EXPECT_DOUBLE_EQ(RangeBearingRadar(figures).azimuth_sigma_rad(7e4),
                   2.0 * RangeBearingRadar({}).azimuth_sigma_rad(7e4));
}

TEST(RangeBearingRadar, FloorsAddInQuadratureAndRemainAtZeroRange) {
  RadarFigures figures;
  figures.range_noise_floor_m = 4.0;
  figures.azimuth_noise_floor_rad = 1e-3;
  const RangeBearingRadar floored(figures);
  const RangeBearingRadar bare({});
  for (const double range_m : {1.0, 1e3, 1e5, 1e6, 3e6}) {
    EXPECT_NEAR(floored.range_sigma_m(range_m), std::hypot(bare.range_sigma_m(range_m), 4.0), 1e-12 * range_m);
    EXPECT_NEAR(floored.azimuth_sigma_rad(range_m), std::hypot(bare.azimuth_sigma_rad(range_m), 1e-3), 1e-15 * range_m);
  }
  EXPECT_DOUBLE_EQ(floored.range_sigma_m(1.0), 4.0);
  EXPECT_DOUBLE_EQ(floored.azimuth_sigma_rad(1.0), 1e-3);
}

TEST(RangeBearingRadar, NoiseIsDiagonalPositiveAndOfTheTrueRange) {
  const RadarFigures figures = off_the_origin();
  const RangeBearingRadar radar(figures);
  for (const double range_m : {1.0, 30e3, 400e3}) {
    const Matrix2 noise = radar.noise(at(figures, range_m, 77.0));
    EXPECT_NEAR(noise(0, 0) / std::pow(radar.range_sigma_m(range_m), 2), 1.0, 1e-9);
    EXPECT_NEAR(noise(1, 1) / std::pow(radar.azimuth_sigma_rad(range_m), 2), 1.0, 1e-9);
    EXPECT_EQ(noise(0, 1), 0.0);
    EXPECT_EQ(noise(1, 0), 0.0);
    EXPECT_GT(noise.diagonal().minCoeff(), 0.0);
  }
}

TEST(RangeBearingRadar, OverTheRadarEverythingIsThatOfTheLeastRange) {
  const RadarFigures figures = off_the_origin();
  const RangeBearingRadar radar(figures);
  const State over = at(figures.position_m);
  EXPECT_EQ(radar.measure(over), Vector2(0.0, 0.0));
  EXPECT_TRUE(radar.jacobian(over).allFinite());
  EXPECT_DOUBLE_EQ(radar.noise(over)(0, 0), std::pow(radar.range_sigma_m(kLeastRange), 2));
  EXPECT_GT(radar.noise(over).diagonal().minCoeff(), 0.0);
  EXPECT_FALSE(radar.covers(over));
}

TEST(RangeBearingRadar, MeasuresRangeAndAzimuthFromWhereItStands) {
  const RadarFigures figures = off_the_origin();
  const RangeBearingRadar radar(figures);
  const Vector2 east = radar.measure(at(figures.position_m + Vector2(3e4, 0.0)));
  EXPECT_DOUBLE_EQ(east[0], 3e4);
  EXPECT_DOUBLE_EQ(east[1], 0.5 * kPi);
  EXPECT_EQ(radar.measure(at(figures.position_m - Vector2(0.0, 3e4)))[1], kPi);
}

TEST(RangeBearingRadar, DoesNotMeasureVelocity) {
  const RangeBearingRadar radar(off_the_origin());
  EXPECT_EQ(radar.measure(make_state({1e4, 2e4}, {300.0, -200.0})), radar.measure(at(Vector2(1e4, 2e4))));
  EXPECT_TRUE(radar.jacobian(at(Vector2(1e4, 2e4)))({0, 1}, {kVx, kVy}).isZero(0.0));
}

TEST(RangeBearingRadar, ResidualWrapsAcrossSouth) {
  const RangeBearingRadar radar({});
  const Vector2 residual = radar.residual({1005.0, 179.5 * kDegree}, {1000.0, -179.5 * kDegree});
  EXPECT_DOUBLE_EQ(residual[0], 5.0);
  EXPECT_NEAR(residual[1], -1.0 * kDegree, 1e-15);
}

// h(x + d) - h(x - d) through residual(), with the step and bound of PolarJacobian.EqualsCentralDifferences.
TEST(RangeBearingRadar, JacobianEqualsCentralDifferencesOfTheMeasurement) {
  const RadarFigures figures = off_the_origin();
  const RangeBearingRadar radar(figures);
  for (const double azimuth_deg : {0.0, 45.0, 133.0, 179.9999, 180.0, -179.9999, -90.0}) {
    for (const double range_m : {50.0, 4e3, 250e3}) {
      const State x = at(figures, range_m, azimuth_deg);
      const MeasurementJacobian jacobian = radar.jacobian(x);
      const double h = 1e-4 * range_m;
      const Vector2 unit(1.0, range_m);  // compares the bearing's row in metres of arc
      for (int i = 0; i < kStateSize; ++i) {
        const State step = h * State::Unit(i);
        const Vector2 slope = radar.residual(radar.measure(x + step), radar.measure(x - step)) / (2.0 * h);
        EXPECT_LE((jacobian.col(i) - slope).cwiseProduct(unit).cwiseAbs().maxCoeff(), 1e-8)
            << "azimuth " << azimuth_deg << " range " << range_m << " component " << i;
      }
    }
  }
}

TEST(RangeBearingRadar, PositionOfUndoesTheMeasurement) {
  const RadarFigures figures = off_the_origin();
  const RangeBearingRadar radar(figures);
  for (int degree = -180; degree <= 180; degree += 15) {
    const State x = at(figures, 123e3, degree);
    const auto back = radar.position_of(radar.measure(x));
    ASSERT_TRUE(back.has_value());
    EXPECT_LE((*back - position(x)).norm(), 1e-9);  // 30 ulp of 1.6e5 m
  }
}

TEST(RangeBearingRadar, FixedDetectionIsTheSameAtEveryRange) {
  RadarFigures figures;
  figures.detection = FixedDetection{0.85};
  for (const double range_m : {1.0, 1e4, 1e7}) {
    EXPECT_EQ(RangeBearingRadar(figures).detection_probability(at(figures, range_m, 10.0)), 0.85);
  }
}

// P_fa^(1 / (1 + SNR)): SNR 3 with P_fa 1e-4 gives exactly 1e-1, SNR 1 gives 1e-2, no signal P_fa, all of
// it 1.
TEST(RangeBearingRadar, SwerlingOneIsTheHandValue) {
  RadarFigures figures;
  figures.snr_reference = 3.0;
  figures.detection = SwerlingOneDetection{1e-4};
  const RangeBearingRadar radar(figures);
  const auto probability = [&](double range_m) { return radar.detection_probability(at(figures, range_m, -120.0)); };
  EXPECT_NEAR(probability(100e3), 1e-1, 1e-14);
  EXPECT_NEAR(probability(100e3 * std::pow(3.0, 0.25)), 1e-2, 1e-14);
  EXPECT_NEAR(probability(1e9), 1e-4, 1e-14);
  EXPECT_NEAR(probability(1.0), 1.0, 1e-14);
}

TEST(RangeBearingRadar, SwerlingOneFallsWithRange) {
  RadarFigures figures;
  figures.snr_reference = 20.0;
  figures.detection = SwerlingOneDetection{1e-6};
  const RangeBearingRadar radar(figures);
  double before = 1.0;
  for (int step = 1; step < 25; ++step) {
    const double now = radar.detection_probability(at(figures, 20e3 * step, 0.0));
    EXPECT_LT(now, before);
    before = now;
  }
}

// An independent method: in-phase and quadrature of noise (variance 1/2 each) plus a signal of exponential
// power SNR, that is a Rayleigh amplitude at a random phase, against the threshold that noise alone exceeds
// with P_fa.
TEST(RangeBearingRadar, SwerlingOneIsTheRateOfAnEnvelopeDetector) {
  const int count = scaled(200'000);
  RandomStream stream(31);
  for (const double snr : {0.0, 1.0, 13.0, 100.0}) {
    RadarFigures figures;
    figures.snr_reference = snr;
    figures.detection = SwerlingOneDetection{1e-3};
    int detected = 0;
    for (int i = 0; i < count; ++i) {
      const double amplitude = std::sqrt(-snr * std::log(1.0 - stream.uniform()));
      const double phase = stream.uniform(0.0, 2.0 * kPi);
      const double in_phase = amplitude * std::cos(phase) + std::sqrt(0.5) * stream.normal();
      const double quadrature = amplitude * std::sin(phase) + std::sqrt(0.5) * stream.normal();
      detected += in_phase * in_phase + quadrature * quadrature > -std::log(1e-3);
    }
    const double probability = RangeBearingRadar(figures).detection_probability(at(figures, 100e3, 0.0));
    EXPECT_TRUE(statistics::binomial_band(count, probability).contains(detected)) << snr;
    if (snr == 0.0) continue;  // the twin changes SNR by a factor
    figures.snr_reference = 1.5 * snr;
    const double wrong = RangeBearingRadar(figures).detection_probability(at(figures, 100e3, 0.0));
    EXPECT_FALSE(statistics::binomial_band(count, wrong).contains(detected)) << snr;
  }
}

TEST(RangeBearingRadar, CoversUpToItsGreatestRange) {
  RadarFigures figures;
  figures.max_range_m = 80e3;
  const RangeBearingRadar radar(figures);
  EXPECT_TRUE(radar.covers(at(Vector2(0.0, 80e3))));
  EXPECT_FALSE(radar.covers(at(Vector2(0.0, std::nextafter(80e3, 1e9)))));
  EXPECT_TRUE(radar.covers(at(Vector2(0.0, kLeastRange))));
  EXPECT_FALSE(radar.covers(at(Vector2(0.0, std::nextafter(kLeastRange, 0.0)))));
  EXPECT_EQ(radar.largest_range(), 80e3);
}

TEST(RangeBearingRadar, UnlimitedRadarCoversEveryDirection) {
  const RadarFigures figures;
  for (int degree = -180; degree <= 180; ++degree) {
    EXPECT_TRUE(RangeBearingRadar(figures).covers(at(figures, 1e6, degree))) << degree;
  }
}

TEST(RangeBearingRadar, SectorAcrossSouthCoversBothSidesOfIt) {
  RadarFigures figures = off_the_origin();
  figures.sector_centre_rad = 175.0 * kDegree;
  figures.sector_width_rad = 40.0 * kDegree;  // 155 .. 195 = -165
  const RangeBearingRadar radar(figures);
  for (const double inside : {155.01, 170.0, 180.0, -180.0, -170.0, -165.01}) {
    EXPECT_TRUE(radar.covers(at(figures, 5e4, inside))) << inside;
  }
  for (const double outside : {154.99, 0.0, -5.0, 90.0, -164.99, -90.0}) {
    EXPECT_FALSE(radar.covers(at(figures, 5e4, outside))) << outside;
  }
}

TEST(RangeBearingRadar, DoesNotCoverAStateThatIsNotANumber) {
  EXPECT_FALSE(RangeBearingRadar({}).covers(State::Constant(std::nan(""))));
}

TEST(RangeBearingRadar, FootprintIsRangeThenAzimuth) {
  RadarFigures figures;
  figures.dwell_range_m = 7e3;
  figures.dwell_azimuth_rad = 0.02;
  EXPECT_EQ(RangeBearingRadar(figures).footprint_half_extent(), Vector2(7e3, 0.02));
}

}  // namespace
}  // namespace dwell
