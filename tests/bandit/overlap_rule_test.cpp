#include "bandit/overlap_rule.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace dwell::testing {
namespace {

WeightedNormal normal(double c, const Vector2& z, const Matrix2& s) {
  return {z, s.inverse(), std::log(c) - 0.5 * std::log(s.determinant()) - std::log(2.0 * std::numbers::pi)};
}

double overlap(const WeightedNormal& a, const WeightedNormal& b, const Vector2& y) {
  return 1.0 / (std::exp(-a.log_density(y)) + std::exp(-b.log_density(y)));
}

template <class Function>
double integrate(int nodes, const WeightedNormal& a, const WeightedNormal& b, Function q) {
  OverlapRule rule(nodes);
  double sum = 0.0;
  for (const OverlapRule::Node& node : rule.place(a, b)) sum += node.area * overlap(a, b, node.y) * q(node.y);
  return sum;
}

double integrate(int nodes, const WeightedNormal& a, const WeightedNormal& b) {
  return integrate(nodes, a, b, [](const Vector2&) { return 1.0; });
}

/// a = b: h = f / 2, a Gaussian.
TEST(OverlapRule, OfOneDensityIsItsMoments) {
  const Vector2 z(3.0, -2.0);
  const Matrix2 s = (Matrix2() << 4.0, 1.5, 1.5, 1.0).finished();
  const WeightedNormal f = normal(0.8, z, s);
  // Beyond the rays' ends lie exp(-7) (1 + 7) = .7 % of the second moments at 5 nodes, 5e-4 at 10, 2e-6
  // at 20.
  for (const auto& [nodes, error] : {std::pair{5, 8e-3}, {10, 5e-4}, {20, 2e-6}}) {
    EXPECT_NEAR(integrate(nodes, f, f), 0.4, error);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        const auto product = [&](const Vector2& y) { return (y - z)[i] * (y - z)[j]; };
        EXPECT_NEAR(integrate(nodes, f, f, product), 0.4 * s(i, j), 0.4 * 4.0 * error) << i << j;
      }
    }
  }
}

// Errors below are held against c_a c_b, half the cost 1 - mu'mu without a look, and the limits of
// ExpectedCost.

/// Concentric isotropic normals of sigma 1 and R: with t = r^2 / 2 the overlap is the integral of
/// 1 / (exp(t) / c_a + R^2 exp(t / R^2) / c_b) over t > 0, by the midpoint rule. From a bump (c_b large) to a
/// plateau with an edge (c_b small).
TEST(OverlapRule, BumpsAndPlateaus) {
  for (const double ratio : {1.5, 3.0, 10.0, 100.0}) {
    for (const double c_b : {1e-4, 1e-2, 0.5, 0.99}) {
      const double c_a = 1.0 - c_b;
      const double r2 = ratio * ratio;
      double exact = 0.0;
      for (int i = 0; i < 400000; ++i) {
        const double t = 1e-3 * (i + 0.5);
        exact += 1e-3 / (std::exp(t) / c_a + r2 * std::exp(t / r2) / c_b);
      }
      const WeightedNormal a = normal(c_a, {1.0, 2.0}, Matrix2::Identity());
      const WeightedNormal b = normal(c_b, {1.0, 2.0}, r2 * Matrix2::Identity());
      EXPECT_NEAR(integrate(5, a, b), exact, 0.02 * c_a * c_b) << ratio << " " << c_b;
      EXPECT_NEAR(integrate(10, a, b), exact, 0.005 * c_a * c_b) << ratio << " " << c_b;
    }
  }
}

/// Equal S, d sigma apart: the overlap is that of the line through both, by the midpoint rule.
TEST(OverlapRule, Ridges) {
  for (const double d : {1.0, 3.0, 6.0, 10.0}) {
    for (const double c_b : {1e-4, 1e-2, 0.5}) {
      const double c_a = 1.0 - c_b;
      double exact = 0.0;
      for (int i = 0; i < 4000; ++i) {
        const double u = -10.0 + 0.01 * (i + 0.5);
        const double a = c_a * std::exp(-0.5 * u * u);
        const double b = c_b * std::exp(-0.5 * (u - d) * (u - d));
        exact += 0.01 / std::sqrt(2.0 * std::numbers::pi) * a * b / (a + b);
      }
      const Vector2 z = d * Vector2(0.6, 0.8);
      const WeightedNormal a = normal(c_a, Vector2::Zero(), Matrix2::Identity());
      const WeightedNormal b = normal(c_b, z, Matrix2::Identity());
      EXPECT_NEAR(integrate(5, a, b), exact, 0.02 * c_a * c_b) << d << " " << c_b;
      EXPECT_NEAR(integrate(10, a, b), exact, 0.005 * c_a * c_b) << d << " " << c_b;
    }
  }
}

TEST(OverlapRule, TheSameFromBothSides) {
  const WeightedNormal a = normal(0.9, {0.0, 0.0}, (Matrix2() << 1.0, 0.4, 0.4, 2.0).finished());
  const WeightedNormal b = normal(0.1, {2.0, 1.0}, (Matrix2() << 30.0, -3.0, -3.0, 0.5).finished());
  EXPECT_NEAR(integrate(5, a, b), integrate(5, b, a), 1e-14);
}

/// y -> M y + t with M any regular matrix: metres and radians, or a rotation.
TEST(OverlapRule, FollowsAnAffineMap) {
  const Matrix2 s_a = (Matrix2() << 1.0, 0.4, 0.4, 2.0).finished();
  const Matrix2 s_b = (Matrix2() << 30.0, -3.0, -3.0, 0.5).finished();
  const Vector2 z_b(2.0, 1.0);
  const double here = integrate(5, normal(0.9, Vector2::Zero(), s_a), normal(0.1, z_b, s_b));
  const Matrix2 turn = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  for (const Matrix2& map :
       {turn, Matrix2(Vector2(1e3, 1e-6).asDiagonal()), Matrix2(turn * Vector2(5.0, 0.1).asDiagonal())}) {
    const Vector2 shift(100.0, -3.0);
    const WeightedNormal a = normal(0.9, shift, map * s_a * map.transpose());
    const WeightedNormal b = normal(0.1, map * z_b + shift, map * s_b * map.transpose());
    EXPECT_NEAR(integrate(5, a, b), here, 1e-9 * here);  // the shift costs digits of y - z at a scale of 1e-6
  }
}

TEST(OverlapRule, FarApartIsNothingAndFinite) {
  const WeightedNormal a = normal(0.5, Vector2::Zero(), Matrix2::Identity());
  for (const double distance : {50.0, 1e4, 1e8}) {
    const double sum = integrate(5, a, normal(0.5, {distance, 0.0}, 2.0 * Matrix2::Identity()));
    EXPECT_GE(sum, 0.0);
    EXPECT_LE(sum, 1e-90);  // min(f_a, f_b) is exp(-214) at its peak
  }
}

}  // namespace
}  // namespace dwell::testing
