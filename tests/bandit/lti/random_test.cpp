#include "bandit/lti/random.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "bandit/lti/averaged_riccati.hpp"
#include "bandit/lti/simplex_descent.hpp"
#include "tests/bandit/lti/problems.hpp"
#include "tests/scale.hpp"

namespace dwell::lti {
namespace {

Problem scalar_problem(double a, double w, std::vector<double> noises) {
  Problem problem;
  problem.horizon = 10;
  problem.a = Eigen::MatrixXd::Constant(1, 1, a);
  problem.w = Eigen::MatrixXd::Constant(1, 1, w);
  problem.initial = Eigen::MatrixXd::Constant(1, 1, 1.0);
  for (const double r : noises) {
    problem.sensors.push_back({Eigen::MatrixXd::Constant(1, 1, 1.0), Eigen::MatrixXd::Constant(1, 1, r)});
  }
  return problem;
}

// x = a^2 x r / (x + r) + w: x^2 + (r - a^2 r - w) x - w r = 0.
TEST(AveragedRiccati, OneSensorIsTheSteadyFilter) {
  for (const double a : {0.5, 1.0, 1.5}) {
    const double r = 2.0;
    const double w = 0.7;
    AveragedRiccati averaged(scalar_problem(a, w, {r}), 1.0);
    const auto at = averaged.fixed_point(Eigen::VectorXd::Ones(1));
    ASSERT_TRUE(at.has_value());
    const double half = 0.5 * (r - a * a * r - w);
    const double x = -half + std::sqrt(half * half + w * r);
    EXPECT_NEAR(at->trace, x, 1e-13 * x);
  }
}

// With a useless second sensor, a look comes with probability q: a fixed point exists exactly where a^2 (1 - q) < 1.
TEST(AveragedRiccati, ExistsWhereTheUnstableModeIsSeenOftenEnough) {
  Problem problem = scalar_problem(2.0, 1.0, {1.0, 1.0});
  problem.sensors[1].c.setZero();
  AveragedRiccati averaged(problem, 1.0);
  EXPECT_FALSE(averaged.fixed_point(Eigen::Vector2d(0.74, 0.26)).has_value());
  EXPECT_TRUE(averaged.fixed_point(Eigen::Vector2d(0.76, 0.24)).has_value());
  EXPECT_FALSE(averaged.fixed_point(Eigen::Vector2d(0.5, 0.5)).has_value());
}

TEST(AveragedRiccati, TheGradientIsTheDerivative) {
  RandomStream stream(40);
  for (int run = 0; run < scaled(50); ++run) {
    Problem problem = random_problem({3, 3, 1}, stream);
    problem.a *= 0.6;
    problem.w += 0.1 * Eigen::Matrix3d::Identity();
    if (run % 2 == 0) problem.covariance = CovarianceKind::kFiltered;
    if (run % 3 == 0) problem.communication_noise = 0.5;
    const Eigen::Vector3d q(0.5, 0.2, 0.3);
    const Eigen::Vector3d along(1.0, -0.4, -0.6);
    AveragedRiccati averaged(problem, 1.0);
    const auto at = averaged.fixed_point(q);
    ASSERT_TRUE(at.has_value());
    constexpr double h = 1e-5;
    const double difference =
        (averaged.fixed_point(q + h * along)->trace - averaged.fixed_point(q - h * along)->trace) / (2.0 * h);
    // h^2 = 1e-10 times third derivatives, and rounding of 1e-14 / h.
    EXPECT_NEAR(at->gradient.dot(along), difference, 1e-6 * at->trace) << run;
  }
}

// The mean over time of a long random schedule is the expectation it tends to. From P[0] = 0 it comes from below.
TEST(AveragedRiccati, BoundsTheMeanOfRandomSchedules) {
  RandomStream stream(41);
  for (int run = 0; run < scaled(20); ++run) {
    Problem problem = random_problem({3, 3, 4000}, stream);
    problem.a *= 0.7;
    problem.initial.setZero();
    const Solution solution = random_choice(problem, {RandomSettings::Probabilities::kUniform}, stream);
    ASSERT_TRUE(solution.bound.has_value());
    // A mean over 4000 steps, most of them independent, of what varies by about itself: within 5 / sqrt(4000 / 10).
    EXPECT_LE(solution.cost / 4000.0, *solution.bound * 1.25 + 1e-12) << run;
  }
}

TEST(OptimalProbabilities, AreNotWorseThanAGridOnTheSimplex) {
  RandomStream stream(42);
  for (int run = 0; run < scaled(30); ++run) {
    Problem problem = random_problem({3, 3, 1}, stream);
    problem.a *= 0.7;
    const Probabilities best = optimal_probabilities(problem);
    ASSERT_TRUE(best.bound.has_value());
    EXPECT_NEAR(best.q.sum(), 1.0, 1e-12);
    EXPECT_GE(best.q.minCoeff(), 0.0);
    AveragedRiccati averaged(problem, 1.0);
    constexpr int kGrid = 20;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; i + j <= kGrid; ++j) {
        const auto at = averaged.fixed_point(Eigen::Vector3d(i, j, kGrid - i - j) / kGrid);
        // Where W is zero so is X, to what Newton's last step leaves of a start around one.
        if (at) {
          EXPECT_GE(at->trace, *best.bound * (1.0 - 1e-9) - 1e-20) << run;
        }
      }
    }
  }
}

// Uniform probabilities do not hold this system, 2.9^2 (1 - 2/3) > 1, some others do.
TEST(OptimalProbabilities, FindWhatStabilises) {
  Problem problem = scalar_problem(2.9, 1.0, {1.0, 2.0, 1.0});
  problem.sensors[2].c.setZero();
  EXPECT_FALSE(uniform_probabilities(problem).bound.has_value());
  const Probabilities best = optimal_probabilities(problem);
  ASSERT_TRUE(best.bound.has_value());
  EXPECT_NEAR(best.q[0], 1.0, 1e-9);  // the better sensor always
}

TEST(OptimalProbabilities, WithoutABoundAreUniform) {
  Problem problem = scalar_problem(1.5, 1.0, {1.0, 1.0});
  for (Sensor& sensor : problem.sensors) sensor.c.setZero();
  const Probabilities best = optimal_probabilities(problem);
  EXPECT_FALSE(best.bound.has_value());
  EXPECT_EQ(best.q, Eigen::Vector2d(0.5, 0.5));
}

TEST(OptimalProbabilities, LiveWithSingularNoiseAndStart) {
  Problem problem = gupta();
  problem.w.setZero();
  problem.initial.setZero();
  EXPECT_EQ(optimal_probabilities(problem).q.size(), 3);
  Problem stable = scalar_problem(0.5, 0.0, {1.0, 1.0});
  const Probabilities still = optimal_probabilities(stable);
  ASSERT_TRUE(still.bound.has_value());
  EXPECT_NEAR(*still.bound, 0.0, 1e-12);
}

TEST(RandomChoice, DrawsWithItsProbabilities) {
  Problem problem = gupta(kMaximumHorizon);
  const Solution solution = random_choice(problem, {}, RandomStream(43));
  for (int j = 1; j <= 3; ++j) {
    const double q = solution.probabilities[static_cast<std::size_t>(j - 1)];
    const double share =
        static_cast<double>(std::count(solution.schedule.begin(), solution.schedule.end(), j)) / kMaximumHorizon;
    // Hoeffding at 1e-6: sqrt(log(2e6) / (2 n)).
    EXPECT_NEAR(share, q, std::sqrt(std::log(2e6) / (2.0 * kMaximumHorizon)));
  }
}

TEST(SimplexDescent, ProjectsOntoTheSimplex) {
  EXPECT_EQ(nearest_on_simplex(Eigen::Vector3d(0.2, 0.3, 0.5)), Eigen::Vector3d(0.2, 0.3, 0.5));
  EXPECT_EQ(nearest_on_simplex(Eigen::Vector3d(5.0, 1.0, 1.0)), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_LT((nearest_on_simplex(Eigen::Vector3d(1.0, 1.0, -7.0)) - Eigen::Vector3d(0.5, 0.5, 0.0)).norm(), 1e-15);
}

// sum (q_i - p_i)^2 over two simplices: the projections of p.
TEST(SimplexDescent, FindsTheNearestPoint) {
  Eigen::MatrixXd p(3, 2);
  p << 0.9, 0.1, 0.4, 0.2, -0.3, 0.3;
  const SimplexFunction distance = [&](const Eigen::MatrixXd& q, Eigen::MatrixXd& gradient) {
    gradient = 2.0 * (q - p);
    return (q - p).squaredNorm();
  };
  const Eigen::MatrixXd q = descend(distance, Eigen::MatrixXd::Constant(3, 2, 1.0 / 3.0), {});
  for (int column : {0, 1}) EXPECT_LT((q.col(column) - nearest_on_simplex(p.col(column))).norm(), 1e-9);
}

}  // namespace
}  // namespace dwell::lti
