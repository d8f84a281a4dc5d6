#include "radar/linear_sensor.hpp"

#include <gtest/gtest.h>

namespace dwell {
namespace {

LinearSensor make_sensor() {
  MeasurementJacobian c;
  c << 1.0, 0.0, 0.5, 0.0, 0.0, 2.0, 0.0, -1.0;
  Matrix2 r;
  r << 4.0, 1.0, 1.0, 9.0;
  return {c, r, 0.9};
}

TEST(LinearSensor, MeasuresCx) {
  // C x by hand: [1 0 .5 0; 0 2 0 -1] [10 20 30 40]' = [10 + 15, 40 - 40]'.
  const State x(10.0, 20.0, 30.0, 40.0);
  EXPECT_EQ(make_sensor().measure(x), Vector2(25.0, 0.0));
  EXPECT_EQ(make_sensor().jacobian(x) * x, make_sensor().measure(x));
}

TEST(LinearSensor, NoiseAndDetectionAreTheSameEverywhere) {
  const LinearSensor sensor = make_sensor();
  for (const double far : {0.0, 1e3, 1e9}) {
    const State x = State::Constant(far);
    EXPECT_EQ(sensor.noise(x), (Matrix2() << 4.0, 1.0, 1.0, 9.0).finished());
    EXPECT_EQ(sensor.detection_probability(x), 0.9);
    EXPECT_TRUE(sensor.covers(x));
  }
}

TEST(LinearSensor, ResidualIsAPlainDifferenceWithoutWrapping) {
  EXPECT_EQ(make_sensor().residual({10.0, 10.0}, {-10.0, -10.0}), Vector2(20.0, 20.0));
}

TEST(LinearSensor, HasNoBeamNoClutterAndNoPosition) {
  EXPECT_TRUE((make_sensor().footprint_half_extent().array() == std::numeric_limits<double>::infinity()).all());
  EXPECT_EQ(make_sensor().clutter_density(), 0.0);
  EXPECT_FALSE(make_sensor().position_of({1.0, 2.0}).has_value());
}

}  // namespace
}  // namespace dwell
