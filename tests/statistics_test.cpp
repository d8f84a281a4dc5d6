#include "tests/statistics.hpp"

#include <gtest/gtest.h>

namespace dwell::statistics {
namespace {

// Abramowitz, Stegun (1964), table 26.8, five digits: the chi-square values exceeded with the given
// probability.
TEST(Statistics, ChiSquareBandIsThatOfTheTables) {
  EXPECT_NEAR(chi_square_band(1, 0.05).high, 5.02389, 1e-5);
  EXPECT_NEAR(chi_square_band(10, 0.10).high, 18.3070, 1e-4);
  EXPECT_NEAR(chi_square_band(10, 0.10).low, 3.94030, 1e-5);
  EXPECT_NEAR(chi_square_band(100, 0.01).high, 140.169, 1e-3);
  EXPECT_NEAR(chi_square_band(100, 0.01).low, 67.3276, 1e-4);
}

TEST(Statistics, ChiSquareOfTwoDegreesIsExponential) {
  const Band band = chi_square_band(2.0);
  EXPECT_NEAR(band.high, -2.0 * std::log(0.5e-6), 1e-9);
  EXPECT_NEAR(band.low, -2.0 * std::log1p(-0.5e-6), 1e-14);
}

// With m degrees of freedom, cube root of chi-square / m is nearly N(1 - 2/(9 m), 2/(9 m)); the error of the
// quantile is under 1e-6 of it at 2e4 degrees. Wilson, Hilferty (1931).
TEST(Statistics, ChiSquareBandOfManyDegreesAgreesWithWilsonAndHilferty) {
  const double m = 2e4;
  const double spread = normal_sum_band(1.0).high * std::sqrt(2.0 / (9.0 * m));
  EXPECT_NEAR(chi_square_band(m).high / (m * std::pow(1.0 - 2.0 / (9.0 * m) + spread, 3)), 1.0, 1e-5);
  EXPECT_NEAR(chi_square_band(m).low / (m * std::pow(1.0 - 2.0 / (9.0 * m) - spread, 3)), 1.0, 1e-5);
}

TEST(Statistics, NormalBandIsTheKnownQuantile) {
  EXPECT_NEAR(normal_sum_band(1.0, 0.05).high, 1.959963985, 1e-9);
  EXPECT_NEAR(normal_sum_band(4.0, 0.05).low, -2.0 * 1.959963985, 2e-9);
}

// B(10, 1/2): P(X <= 1) = 11/1024 = 0.0107, P(X <= 2) = 56/1024 = 0.0547.
TEST(Statistics, BinomialBandSumsTheExactTail) {
  EXPECT_EQ(binomial_band(10, 0.5, 0.1).low, 2);
  EXPECT_EQ(binomial_band(10, 0.5, 0.1).high, 8);
  EXPECT_EQ(binomial_band(10, 0.5, 0.11).low, 3);
  EXPECT_EQ(binomial_band(10, 1.0).low, 10);
  EXPECT_EQ(binomial_band(10, 0.0).high, 0);
}

// Poisson(3): P(X = 0) = 0.0498, P(X <= 1) = 0.1991; P(X > 6) = 0.0335, P(X > 5) = 0.0839.
TEST(Statistics, PoissonBandSumsTheExactTail) {
  EXPECT_EQ(poisson_band(3.0, 0.1).low, 1);
  EXPECT_EQ(poisson_band(3.0, 0.09).low, 0);
  EXPECT_EQ(poisson_band(3.0, 0.1).high, 6);
}

// The quantiles {1/8, 3/8, 5/8, 7/8} of a uniform variable stay 1/8 away from its distribution.
TEST(Statistics, KolmogorovDistanceLooksAtBothSidesOfAStep) {
  const auto uniform = [](double x) { return x; };
  EXPECT_DOUBLE_EQ(kolmogorov_distance({0.875, 0.125, 0.375, 0.625}, uniform), 0.125);
  EXPECT_DOUBLE_EQ(kolmogorov_distance({0.5}, uniform), 0.5);
  EXPECT_DOUBLE_EQ(kolmogorov_distance({0.0, 0.0}, uniform), 1.0);
}

}  // namespace
}  // namespace dwell::statistics
