#include "radar/frames.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "radar/random.hpp"

namespace dwell {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(WrapAngle, KeepsWhatIsInTheHalfOpenInterval) {
  for (const double angle : {0.0, 1.0, -1.0, kPi, std::nextafter(kPi, 0.0), std::nextafter(-kPi, 0.0)}) {
    EXPECT_EQ(wrap_angle(angle), angle);
  }
}

TEST(WrapAngle, SouthIsPlusPi) { EXPECT_EQ(wrap_angle(-kPi), kPi); }

// 2 pi k + angle carries the rounding of the sum, half a unit in the last place of 2 pi k, and nothing else.
TEST(WrapAngle, ForgetsWholeTurns) {
  for (const double angle : {-3.1, -kPi / 2, -1e-3, 0.0, 1e-3, kPi / 2, 3.1}) {
    for (int turns = -50; turns <= 50; ++turns) {
      const double wrapped = wrap_angle(angle + 2.0 * kPi * turns);
      EXPECT_GT(wrapped, -kPi);
      EXPECT_LE(wrapped, kPi);
      EXPECT_NEAR(wrapped, angle, 3e-16 * (1.0 + 2.0 * kPi * std::abs(turns)));
    }
  }
}

TEST(WrapAngle, NotANumberStaysSo) {
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::infinity())));
}

TEST(AzimuthDifference, GoesTheShortWayRound) {
  EXPECT_NEAR(azimuth_difference(179.0 * kDegree, -179.0 * kDegree), -2.0 * kDegree, 1e-15);
  EXPECT_NEAR(azimuth_difference(-179.0 * kDegree, 179.0 * kDegree), 2.0 * kDegree, 1e-15);
  EXPECT_NEAR(azimuth_difference(10.0 * kDegree, 350.0 * kDegree), 20.0 * kDegree, 1e-15);
  EXPECT_EQ(azimuth_difference(kPi, -kPi), 0.0);
  EXPECT_EQ(azimuth_difference(0.5 * kPi, -0.5 * kPi), kPi);  // opposite: the same value both ways round
  EXPECT_EQ(azimuth_difference(-0.5 * kPi, 0.5 * kPi), kPi);
}

TEST(AzimuthDifference, IsAntisymmetricAndAddsBack) {
  RandomStream stream(1);
  for (int i = 0; i < 1000; ++i) {
    const double a = stream.uniform(-kPi, kPi);
    const double b = stream.uniform(-kPi, kPi);
    const double difference = azimuth_difference(a, b);
    EXPECT_DOUBLE_EQ(azimuth_difference(b, a), -difference);
    EXPECT_NEAR(azimuth_difference(b + difference, a), 0.0, 1e-15);
  }
}

TEST(ToPolar, PutsTheCompassWhereItBelongs) {
  const Vector2 origin(1000.0, -2000.0);
  const auto azimuth = [&](double east_m, double north_m) {
    return to_polar(origin, origin + Vector2(east_m, north_m)).azimuth_rad;
  };
  EXPECT_EQ(azimuth(0.0, 5.0), 0.0);
  EXPECT_EQ(azimuth(5.0, 0.0), 0.5 * kPi);
  EXPECT_EQ(azimuth(0.0, -5.0), kPi);
  EXPECT_EQ(azimuth(-5.0, 0.0), -0.5 * kPi);
  EXPECT_DOUBLE_EQ(azimuth(5.0, 5.0), 0.25 * kPi);
  EXPECT_EQ(to_polar(origin, origin + Vector2(3.0, 4.0)).range_m, 5.0);
}

// atan2(-0, -1) is -pi: the branch cut lies due south, and a plot there must not come out on the wrong side.
TEST(ToPolar, SouthIsPlusPiFromBothSidesOfZero) {
  EXPECT_EQ(to_polar({0.0, 0.0}, {0.0, -1.0}).azimuth_rad, kPi);
  EXPECT_EQ(to_polar({0.0, 0.0}, {-0.0, -1.0}).azimuth_rad, kPi);
  EXPECT_NEAR(to_polar({0.0, 0.0}, {1e-3, -1e3}).azimuth_rad, kPi - 1e-6, 1e-15);
  EXPECT_NEAR(to_polar({0.0, 0.0}, {-1e-3, -1e3}).azimuth_rad, -kPi + 1e-6, 1e-15);
}

TEST(ToPolar, OverTheRadarIsRangeZeroAzimuthZero) {
  const Polar polar = to_polar({12.0, -7.0}, {12.0, -7.0});
  EXPECT_EQ(polar.range_m, 0.0);
  EXPECT_EQ(polar.azimuth_rad, 0.0);
}

// Each step (difference, hypot, atan2, sin, cos, product, sum) rounds to an ulp or two of the largest
// magnitude.
TEST(ToPolar, RoundTripReturnsThePoint) {
  RandomStream stream(2);
  for (int i = 0; i < 10000; ++i) {
    const Vector2 origin(stream.uniform(-3e5, 3e5), stream.uniform(-3e5, 3e5));
    const double scale = std::pow(10.0, stream.uniform(-2.0, 5.5));
    const Vector2 point = origin + scale * Vector2(stream.uniform(-1.0, 1.0), stream.uniform(-1.0, 1.0));
    const Vector2 back = to_cartesian(origin, to_polar(origin, point));
    EXPECT_LE((back - point).norm(), 8.0 * std::numeric_limits<double>::epsilon() * (origin.norm() + point.norm()));
  }
}

TEST(ToCartesian, RoundTripReturnsThePolarAlsoAcrossSouth) {
  const Vector2 origin = Vector2::Zero();
  for (int degree = -179; degree <= 180; ++degree) {
    const Polar polar{5e4, degree * kDegree};
    const Polar back = to_polar(origin, to_cartesian(origin, polar));
    EXPECT_NEAR(back.range_m, polar.range_m, 1e-10);  // a few ulp of 5e4 m, 7e-12 each
    EXPECT_NEAR(azimuth_difference(back.azimuth_rad, polar.azimuth_rad), 0.0, 2e-15);
  }
}

// Central differences with step h = 1e-4 R: the truncation is (h / R)^2 / 3 = 3e-9 of 1 / R at most, the
// rounding of azimuths up to pi is 4e-16 / 1e-4 = 4e-12 of 1 / R, that of ranges as little. Bound 1e-8.
TEST(PolarJacobian, EqualsCentralDifferences) {
  RandomStream stream(3);
  for (int i = 0; i < 2000; ++i) {
    const Vector2 origin(stream.uniform(-1e3, 1e3), stream.uniform(-1e3, 1e3));
    const double range_m = std::pow(10.0, stream.uniform(1.0, 5.5));
    // Every fourth point so near due south that the differences step across the cut.
    const double azimuth = i % 4 == 0 ? kPi + stream.uniform(-1e-5, 1e-5) : stream.uniform(-kPi, kPi);
    const Vector2 point = to_cartesian(origin, {range_m, azimuth});
    const Matrix2 jacobian = polar_jacobian(origin, point);
    const double h = 1e-4 * range_m;
    for (int axis = 0; axis < 2; ++axis) {
      const Polar ahead = to_polar(origin, point + h * Vector2::Unit(axis));
      const Polar behind = to_polar(origin, point - h * Vector2::Unit(axis));
      EXPECT_NEAR(jacobian(0, axis), (ahead.range_m - behind.range_m) / (2.0 * h), 1e-8);
      EXPECT_NEAR(jacobian(1, axis) * range_m,
                  azimuth_difference(ahead.azimuth_rad, behind.azimuth_rad) / (2.0 * h) * range_m, 1e-8);
    }
  }
}

// Range and azimuth are orthogonal coordinates: J J' = diag(1, 1 / R^2).
TEST(PolarJacobian, RowsAreOrthogonalWithNormsOneAndOneOverRange) {
  RandomStream stream(4);
  for (int i = 0; i < 1000; ++i) {
    const Vector2 point(stream.uniform(-1e5, 1e5), stream.uniform(-1e5, 1e5));
    const Matrix2 jacobian = polar_jacobian(Vector2::Zero(), point);
    const double range_m = point.norm();
    EXPECT_NEAR(jacobian.row(0).norm(), 1.0, 1e-15);
    EXPECT_NEAR(jacobian.row(1).norm() * range_m, 1.0, 1e-15);
    EXPECT_NEAR(jacobian.row(0).dot(jacobian.row(1)) * range_m, 0.0, 1e-15);
  }
}

TEST(PolarJacobian, IsBoundedOverTheRadar) {
  for (const double distance_m : {0.0, 1e-300, 1e-9, 0.5 * kLeastRange, kLeastRange}) {
    const Matrix2 jacobian = polar_jacobian({5.0, 5.0}, {5.0, 5.0 + distance_m});
    EXPECT_TRUE(jacobian.allFinite());
    EXPECT_LE(jacobian.cwiseAbs().maxCoeff(), 1.0 / kLeastRange);
  }
}

}  // namespace
}  // namespace dwell
