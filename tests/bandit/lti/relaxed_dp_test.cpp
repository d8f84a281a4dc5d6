#include "bandit/lti/relaxed_dp.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "bandit/lti/loewner_cover.hpp"
#include "bandit/lti/optimum.hpp"
#include "tests/bandit/lti/problems.hpp"
#include "tests/scale.hpp"

namespace dwell::lti {
namespace {

// A cover may be exceeded by 1e-9 of a trace in each of at most six steps, which the steps after it carry on, by less
// than a hundredfold in these systems.
constexpr double kCover = 1e-6;

TEST(RelaxedDp, IsWithinAlphaSquaredOfAnEnumeration) {
  RandomStream stream(30);
  for (int run = 0; run < scaled(300); ++run) {
    const Problem problem = random_variant(stream);
    const double alpha = 1.0 + stream.uniform();
    const double least = enumerated_minimum(problem).final_trace;
    EXPECT_LE(relaxed_dp(problem, {alpha}).final_trace, alpha * alpha * least * (1.0 + kCover)) << run;
  }
}

TEST(RelaxedDp, IsTheOptimumOfTheFinalTraceAtOne) {
  RandomStream stream(31);
  for (int run = 0; run < scaled(100); ++run) {
    const Problem problem = random_variant(stream);
    const double least = enumerated_minimum(problem).final_trace;
    EXPECT_NEAR(relaxed_dp(problem, {1.0}).final_trace, least, kCover * least) << run;
  }
}

TEST(RelaxedDp, KeepsLessTheLargerAlphaIs) {
  const std::vector<std::size_t> fine = relaxed_dp(alriksson(110.0, 50), {1.002}).set_sizes;
  const std::vector<std::size_t> coarse = relaxed_dp(alriksson(110.0, 50), {1.05}).set_sizes;
  EXPECT_GT(fine.back(), coarse.back());
}

/// A six-state system: two chains of three, each driven at its end, three sensors; as large as the helicopter
/// of the paper, whose matrices are not printed.
TEST(RelaxedDp, SixStatesAndThreeSensorsOverAHundredSteps) {
  Problem problem;
  problem.horizon = 100;
  problem.objective = Objective::kFinal;
  problem.a = 0.95 * Eigen::MatrixXd::Identity(6, 6);
  for (const int i : {0, 1, 3, 4}) problem.a(i, i + 1) = 0.2;
  problem.w = 0.1 * Eigen::MatrixXd::Identity(6, 6);
  problem.initial = Eigen::MatrixXd::Identity(6, 6);
  for (const int i : {0, 3, 1})
    problem.sensors.push_back({Eigen::RowVectorXd::Unit(6, i), Eigen::MatrixXd::Identity(1, 1)});
  constexpr double alpha = 1.5;
  const Solution solution = relaxed_dp(problem, {alpha});
  ASSERT_EQ(solution.set_sizes.size(), 100U);
  EXPECT_LE(*std::max_element(solution.set_sizes.begin(), solution.set_sizes.end()), 10U);
  problem.horizon = 12;  // of which the exact search takes a moment
  EXPECT_LE(relaxed_dp(problem, {alpha}).final_trace, alpha * alpha * optimum(problem).final_trace);
}

// Eight states, six sensors, alpha near one: the exact search for the final trace takes over.
TEST(RelaxedDp, ASetThatGrowsTooLargeIsLeftToTheExactSearch) {
  RandomStream stream(33);
  Problem problem = random_problem({8, 6, 7}, stream);
  problem.sensors[0].cost = 1.0;  // of the sum, which it does not minimise
  const Solution solution = relaxed_dp(problem, {1.001});
  EXPECT_LT(solution.set_sizes.size(), 7U);
  EXPECT_GT(solution.set_sizes.back(), kMaximumSet);
  problem.sensors[0].cost = 0.0;
  problem.objective = Objective::kFinal;
  EXPECT_EQ(solution.schedule, optimum(problem).schedule);
}

// The largest entry of a mixture of (1, 4) and (4, 1) is 2.5 at the least.
TEST(LoewnerCover, NeedsAMixture) {
  LoewnerCover cover({2});
  const auto diagonal = [](double a, double b) { return std::vector<double>{a, 0.0, 0.0, b}; };
  EXPECT_FALSE(cover.covers(diagonal(9.0, 9.0), 1e-9));
  cover.add(diagonal(1.0, 4.0));
  cover.add(diagonal(4.0, 1.0));
  EXPECT_TRUE(cover.covers(diagonal(1.0, 4.0), 1e-9));
  EXPECT_TRUE(cover.covers(diagonal(2.5, 2.5), 1e-9));
  EXPECT_TRUE(cover.covers(diagonal(2.0, 3.0), 1e-9));
  EXPECT_FALSE(cover.covers(diagonal(2.49, 2.49), 1e-9));
  EXPECT_FALSE(cover.covers(std::vector<double>{2.5, 0.1, 0.1, 2.5}, 1e-9));
}

TEST(LoewnerCover, TakesOneMixtureForAllBlocks) {
  LoewnerCover cover({1, 1});
  cover.add(std::vector<double>{1.0, 4.0});
  cover.add(std::vector<double>{4.0, 1.0});
  EXPECT_TRUE(cover.covers(std::vector<double>{2.5, 2.5}, 1e-9));
  EXPECT_FALSE(cover.covers(std::vector<double>{3.9, 1.05}, 1e-9));
}

TEST(LoewnerCover, IsThatOfAGridOfMixtures) {
  RandomStream stream(32);
  const auto covariance = [&] {
    Eigen::Matrix3d root;
    for (double& entry : root.reshaped()) entry = stream.normal();
    return Eigen::Matrix3d(root * root.transpose());
  };
  int covered = 0;
  for (int run = 0; run < scaled(200); ++run) {
    const Eigen::Matrix3d x[] = {covariance(), covariance(), covariance()};
    const Eigen::Matrix3d u = 0.4 * (x[0] + x[1] + x[2]) - 0.1 * covariance();
    LoewnerCover cover({3});
    for (const Eigen::Matrix3d& member : x) cover.add(std::span(member.data(), 9));
    constexpr int kGrid = 100;
    double least = 1e300;  // of the largest eigenvalue of the mixture - u, relative
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; i + j <= kGrid; ++j) {
        const Eigen::Matrix3d mixture = (i * x[0] + j * x[1] + (kGrid - i - j) * x[2]) / kGrid;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(mixture - u, Eigen::EigenvaluesOnly);
        least = std::min(least, solver.eigenvalues()[2] / u.trace());
      }
    }
    // The least between two points of the grid may be lower by a step of it times the largest member.
    const double step = (x[0].norm() + x[1].norm() + x[2].norm()) / u.trace() / kGrid;
    const bool covers = cover.covers(std::span(u.data(), 9), 1e-9);
    if (least <= 0.0) {
      EXPECT_TRUE(covers) << run;
    }
    if (least > step) {
      EXPECT_FALSE(covers) << run;
    }
    covered += covers ? 1 : 0;
  }
  EXPECT_GT(covered, scaled(200) / 10);
  EXPECT_LT(covered, scaled(200) * 9 / 10);
}

}  // namespace
}  // namespace dwell::lti
