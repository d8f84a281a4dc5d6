// Phi_v against closed forms, and against an independent method: conditioning on one element and integrating over it.

#include "tracker/normal_orthant.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include "radar/random.hpp"
#include "tests/scale.hpp"

namespace dwell {
namespace {

using std::numbers::pi;
using Quadrature = boost::math::quadrature::gauss_kronrod<double, 21>;

Eigen::VectorXd vector(std::initializer_list<double> values) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), result.begin());
  return result;
}

Eigen::MatrixXd correlations(double r12, double r13, double r23) {
  Eigen::MatrixXd r(3, 3);
  r << 1.0, r12, r13, r12, 1.0, r23, r13, r23, 1.0;
  return r;
}

Eigen::MatrixXd random_covariance(RandomStream& random, int size, int rank) {
  Eigen::MatrixXd root(size, rank);
  for (double& element : root.reshaped()) element = random.normal();
  return root * root.transpose();
}

Eigen::VectorXd random_mean(RandomStream& random, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd mean(covariance.rows());
  for (Eigen::Index i = 0; i < mean.size(); ++i) mean[i] = 1.5 * std::sqrt(covariance(i, i)) * random.normal();
  return mean;
}

/// P(y <= 0) = integral over y_0 <= 0 of its density times P(the others <= 0 | y_0): Gauss-Kronrod over pieces of one
/// sigma.
double by_conditioning(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  if (mean.size() == 1) return normal_cdf(-mean[0] / std::sqrt(covariance(0, 0)));
  const Eigen::Index rest = mean.size() - 1;
  const double sigma = std::sqrt(covariance(0, 0));
  const Eigen::VectorXd slope = covariance.col(0).tail(rest) / covariance(0, 0);
  const Eigen::MatrixXd remaining =
      covariance.bottomRightCorner(rest, rest) - slope * covariance.col(0).tail(rest).transpose();
  double sum = 0.0;
  for (double low = -9.0; low < 9.0; low += 1.0) {
    const double high = std::min(low + 1.0, -mean[0] / sigma);
    if (high <= low) break;
    const auto integrand = [&](double u) {
      const Eigen::VectorXd conditional = mean.tail(rest) + slope * (u * sigma);
      return std::exp(-0.5 * u * u) / std::sqrt(2.0 * pi) * by_conditioning(conditional, remaining);
    };
    sum += Quadrature::integrate(integrand, low, high, 4, 1e-13);
  }
  return sum;
}

TEST(NormalOrthant, OneDimensionIsTheDistributionFunction) {
  EXPECT_DOUBLE_EQ(normal_orthant(vector({0.0}), Eigen::MatrixXd::Identity(1, 1)), 0.5);
  // Abramowitz, Stegun (1964), table 26.1: P(1.96), P(-3).
  EXPECT_NEAR(normal_orthant(vector({-3.92}), 4.0 * Eigen::MatrixXd::Identity(1, 1)), 0.975002104851780, 1e-15);
  EXPECT_NEAR(normal_orthant(vector({3.0}), Eigen::MatrixXd::Identity(1, 1)), 0.001349898031630, 1e-15);
}

// Sheppard: P = 1/4 + asin(rho) / 2 pi, and for three (asin r12 + asin r13 + asin r23) / 4 pi + 1/8.
TEST(NormalOrthant, AtTheMeanIsSheppards) {
  for (const double rho : {-0.999999, -0.7, 0.0, 1e-9, 0.3, 0.99, 0.9999999999}) {
    Eigen::MatrixXd two(2, 2);
    two << 1.0, rho, rho, 1.0;
    EXPECT_NEAR(normal_orthant(vector({0.0, 0.0}), two), 0.25 + std::asin(rho) / (2.0 * pi), 1e-15) << rho;
  }
  for (const auto& [r12, r13, r23] :
       {std::array{0.0, 0.0, 0.0}, std::array{0.5, 0.5, 0.5}, std::array{-0.4, 0.3, 0.6}, std::array{0.95, 0.9, 0.86},
        std::array{-0.49, -0.5, -0.5}, std::array{0.2, 0.1, 0.9999999}}) {
    const double exact = 0.125 + (std::asin(r12) + std::asin(r13) + std::asin(r23)) / (4.0 * pi);
    EXPECT_NEAR(normal_orthant(Eigen::VectorXd::Zero(3), correlations(r12, r13, r23)), exact, 1e-12) << r12;
  }
}

TEST(NormalOrthant, TwoAndThreeDimensionsAgreeWithConditioning) {
  RandomStream random(11);
  double worst_two = 0.0, worst_three = 0.0;
  for (int i = 0; i < scaled(100); ++i) {
    const Eigen::MatrixXd two = random_covariance(random, 2, 2 + i % 3);
    const Eigen::VectorXd mean = random_mean(random, two);
    worst_two = std::max(worst_two, std::abs(normal_orthant(mean, two) - by_conditioning(mean, two)));
  }
  for (int i = 0; i < scaled(20); ++i) {
    const Eigen::MatrixXd three = random_covariance(random, 3, 3 + i % 3);
    const Eigen::VectorXd mean = random_mean(random, three);
    worst_three = std::max(worst_three, std::abs(normal_orthant(mean, three) - by_conditioning(mean, three)));
  }
  EXPECT_LT(worst_two, 1e-13);  // of the integral: eighteen pieces to 1e-14 of each
  EXPECT_LT(worst_three, 1e-12);
}

// A factor of independent blocks and one common factor: both have one-dimensional forms.
TEST(NormalOrthant, MoreDimensionsAreWithinTheirStatedError) {
  double worst = 0.0;
  for (int size = 4; size <= 8; ++size) {
    for (const double rho : {0.0, 0.2, 0.5, 0.8}) {
      for (const double mean : {-1.0, 0.0, 0.7}) {
        const Eigen::MatrixXd r =
            (1.0 - rho) * Eigen::MatrixXd::Identity(size, size) + rho * Eigen::MatrixXd::Ones(size, size);
        const auto integrand = [&](double u) {  // y_i = mean + sqrt(rho) u + sqrt(1 - rho) e_i
          return std::exp(-0.5 * u * u) / std::sqrt(2.0 * pi) *
                 std::pow(normal_cdf((-mean - std::sqrt(rho) * u) / std::sqrt(1.0 - rho)), size);
        };
        const double exact = Quadrature::integrate(integrand, -9.0, 9.0, 8, 1e-13);
        worst = std::max(worst, std::abs(normal_orthant(Eigen::VectorXd::Constant(size, mean), r) - exact));
      }
    }
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 2e-4);
}

TEST(NormalOrthant, SingularCovariancesReduceToFewerDimensions) {
  Eigen::MatrixXd same = Eigen::MatrixXd::Ones(2, 2);
  EXPECT_DOUBLE_EQ(normal_orthant(vector({-1.0, 0.5}), same), normal_cdf(-0.5));
  Eigen::MatrixXd opposite(2, 2);
  opposite << 1.0, -1.0, -1.0, 1.0;
  EXPECT_NEAR(normal_orthant(vector({-1.0, -0.5}), opposite), normal_cdf(1.0) - normal_cdf(-0.5), 1e-15);
  EXPECT_EQ(normal_orthant(vector({1.0, 0.5}), opposite), 0.0);

  Eigen::MatrixXd without_variance = Eigen::MatrixXd::Zero(2, 2);
  without_variance(0, 0) = 4.0;
  EXPECT_DOUBLE_EQ(normal_orthant(vector({1.0, -1e-9}), without_variance), normal_cdf(-0.5));
  EXPECT_DOUBLE_EQ(normal_orthant(vector({1.0, 0.0}), without_variance), normal_cdf(-0.5));
  EXPECT_EQ(normal_orthant(vector({1.0, 1e-9}), without_variance), 0.0);
  EXPECT_EQ(normal_orthant(vector({-1.0, 0.0}), Eigen::MatrixXd::Zero(2, 2)), 1.0);

  // y_3 = y_1 + y_2 is not positive where both are not.
  Eigen::MatrixXd root(3, 2);
  root << 1.0, 0.0, 0.0, 1.0, 1.0, 1.0;
  EXPECT_NEAR(normal_orthant(vector({-0.3, 0.2, -0.1}), root * root.transpose()), normal_cdf(0.3) * normal_cdf(-0.2),
              1e-12);
  // y_3 = -y_1 - y_2 is not positive where both are zero.
  root.row(2) *= -1.0;
  EXPECT_NEAR(normal_orthant(vector({0.0, 0.0, 0.0}), root * root.transpose()), 0.0, 1e-12);
  // Four elements of rank one: all are y_1, within the error of v > 3.
  EXPECT_NEAR(normal_orthant(vector({0.1, -0.2, 0.3, -0.4}), Eigen::MatrixXd::Ones(4, 4)), normal_cdf(-0.3), 2e-4);
}

TEST(NormalOrthant, OrderAndScaleDoNotMatter) {
  RandomStream random(12);
  for (int i = 0; i < scaled(200); ++i) {
    const Eigen::MatrixXd covariance = random_covariance(random, 3, 2 + i % 3);
    const Eigen::VectorXd mean = random_mean(random, covariance);
    const double value = normal_orthant(mean, covariance);
    Eigen::MatrixXd turn(3, 3);  // a permutation with scales
    turn << 0.0, 1e4, 0.0, 0.0, 0.0, 1e-3, 7.0, 0.0, 0.0;
    EXPECT_NEAR(normal_orthant(turn * mean, turn * covariance * turn.transpose()), value, i % 3 == 0 ? 1e-7 : 1e-12);
  }
}

// Of both signs of one element: P(y1 <= 0, ..) + P(-y1 <= 0, ..) is the probability of the others.
TEST(NormalOrthant, ComplementsAddUp) {
  RandomStream random(13);
  for (int i = 0; i < scaled(200); ++i) {
    const Eigen::MatrixXd covariance = random_covariance(random, 3, 3 + i % 2);
    const Eigen::VectorXd mean = random_mean(random, covariance);
    const Eigen::DiagonalMatrix<double, 3> flip(-1.0, 1.0, 1.0);
    const double both = normal_orthant(mean, covariance) + normal_orthant(flip * mean, flip * covariance * flip);
    EXPECT_NEAR(both, normal_orthant(mean.tail(2), covariance.bottomRightCorner(2, 2)), 2e-12);
  }
}

}  // namespace
}  // namespace dwell
