#include "radar/calibration/corrected_radar.hpp"

#include <gtest/gtest.h>

namespace dwell::testing {
namespace {

RadarFigures figures() {
  RadarFigures radar;
  radar.position_m = {1000.0, -2000.0};
  radar.range_noise_floor_m = 20.0;
  radar.detection = FixedDetection{0.4};
  return radar;
}

const State kTarget = make_state({-20e3, 35e3}, {150.0, -90.0});

TEST(CorrectedRadar, WithoutCorrectionIsTheRadarBitForBit) {
  const RangeBearingRadar plain(figures());
  const CorrectedRadar corrected(figures());
  EXPECT_EQ(corrected.measure(kTarget), plain.measure(kTarget));
  EXPECT_EQ(corrected.jacobian(kTarget), plain.jacobian(kTarget));
  EXPECT_EQ(corrected.noise(kTarget), plain.noise(kTarget));
  EXPECT_EQ(corrected.detection_probability(kTarget), plain.detection_probability(kTarget));
  EXPECT_EQ(*corrected.position_of({3e4, 1.0}), *plain.position_of({3e4, 1.0}));
  EXPECT_EQ(corrected.coverage().has_value(), plain.coverage().has_value());
}

TEST(CorrectedRadar, AddsBiasesAndMovesTheTargetByTheTimeBias) {
  CorrectedRadar radar(figures());
  radar.set_correction({std::log(3.0), std::log(0.5), 30.0, 0.01, 0.2});
  const RangeBearingRadar plain(figures());
  const Vector2 later = plain.measure(make_state({-20e3 + 30.0, 35e3 - 18.0}, {150.0, -90.0}));
  EXPECT_NEAR(radar.measure(kTarget)[0], later[0] + 30.0, 1e-9);
  EXPECT_NEAR(radar.measure(kTarget)[1], later[1] + 0.01, 1e-14);
  const Matrix2 ratio = radar.noise(kTarget).cwiseQuotient(plain.noise(kTarget));
  EXPECT_NEAR(ratio(0, 0), 9.0, 1e-12);
  EXPECT_NEAR(ratio(1, 1), 0.25, 1e-12);
}

TEST(CorrectedRadar, JacobianIsTheDerivative) {
  CorrectedRadar radar(figures());
  radar.set_correction({0.0, 0.0, 30.0, 0.01, 0.2});
  const MeasurementJacobian h = radar.jacobian(kTarget);
  for (int k = 0; k < kStateSize; ++k) {
    const double step = 1.0;  // third derivatives are under 1e-12 per m^3
    const State d = step * State::Unit(k);
    const Vector2 slope = radar.residual(radar.measure(kTarget + d), radar.measure(kTarget - d)) / (2.0 * step);
    EXPECT_NEAR(h(0, k), slope[0], 1e-8);
    EXPECT_NEAR(h(1, k), slope[1], 1e-12);
  }
}

TEST(CorrectedRadar, PositionIsTheOneMeasured) {
  CorrectedRadar radar(figures());
  radar.set_correction({0.0, 0.0, 30.0, 0.01, 0.0});
  EXPECT_LE((*radar.position_of(radar.measure(kTarget)) - position(kTarget)).norm(), 1e-8);
}

TEST(CorrectedRadar, DetectionIsScaledAndCutAtOne) {
  CorrectedRadar radar(figures());
  radar.set_detection_scale(2.0);
  EXPECT_DOUBLE_EQ(radar.detection_probability(kTarget), 0.8);
  radar.set_detection_scale(3.0);
  EXPECT_DOUBLE_EQ(radar.detection_probability(kTarget), 1.0);
}

}  // namespace
}  // namespace dwell::testing
