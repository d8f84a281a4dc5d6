#include "bandit/lti/riccati.hpp"

#include <limits>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "bandit/lti/search_tree.hpp"
#include "tests/bandit/lti/problems.hpp"
#include "tests/scale.hpp"

namespace dwell::lti {
namespace {

/// Two orders of the same sums, of matrices with entries around one and noise of 0.01 and more: about 1e-13 lost.
constexpr double kRounding = 1e-10;

TEST(LtiRiccati, EveryScheduleCostsWhatTheTextbookSays) {
  RandomStream stream(11);
  for (int run = 0; run < scaled(200); ++run) {
    const Problem problem = random_variant(stream);
    const std::vector<std::vector<int>> schedules = all_schedules(problem);
    const auto pick = static_cast<std::size_t>(stream.uniform() * static_cast<double>(schedules.size()));
    const Cost expected = textbook_cost(problem, schedules[pick]);
    const Solution solution = evaluate(problem, schedules[pick]);
    EXPECT_NEAR(solution.cost, expected.objective, kRounding * expected.objective);
    EXPECT_NEAR(solution.final_trace, expected.final_trace, kRounding * expected.objective);
  }
}

// With exact information the step is 1 / P+ = 1 / P + c^2 / r.
TEST(LtiRiccati, ScalarStepByHand) {
  Problem problem;
  problem.horizon = 1;
  problem.a = Eigen::MatrixXd::Constant(1, 1, 2.0);
  problem.w = Eigen::MatrixXd::Constant(1, 1, 3.0);
  problem.initial = Eigen::MatrixXd::Constant(1, 1, 4.0);
  problem.sensors = {{Eigen::MatrixXd::Constant(1, 1, 0.5), Eigen::MatrixXd::Constant(1, 1, 1.0)}};
  // Predicted: 1 / (1/4 + 1/4) = 2, then 4 x 2 + 3; the sum has P[0] as well.
  EXPECT_NEAR(evaluate(problem, {1}).final_trace, 11.0, 1e-14);
  EXPECT_NEAR(evaluate(problem, {1}).cost, 15.0, 1e-14);
  // Filtered: 4 x 4 + 3 = 19, then 1 / (1/19 + 1/4).
  problem.covariance = CovarianceKind::kFiltered;
  EXPECT_NEAR(evaluate(problem, {1}).final_trace, 76.0 / 23.0, 1e-14);
  EXPECT_NEAR(evaluate(problem, {1}).cost, 76.0 / 23.0, 1e-14);
}

TEST(LtiRiccati, CommunicationNoiseIsNothingToASensorAlone) {
  RandomStream stream(12);
  Problem problem = random_problem({3, 1, 6}, stream);
  const Solution without = evaluate(problem, std::vector<int>(6, 1));
  problem.communication_noise = 5.0;
  const Solution with = evaluate(problem, std::vector<int>(6, 1));
  EXPECT_EQ(with.cost, without.cost);
  EXPECT_EQ(with.final_trace, without.final_trace);
}

TEST(LtiRiccati, CommunicationNoiseAddsUpOverNodesFromNone) {
  Problem problem = chung();
  const Solution none = evaluate(problem, schedule_of("12122122122122122122"));
  problem.communication_noise = 1e-14;
  const Solution some = evaluate(problem, none.schedule);
  // Of noises of 3e-4 and more, 1e-14 is 3e-11; tr P is summed over the two nodes.
  EXPECT_NEAR(some.cost, none.cost, 1e-10 * none.cost);
  EXPECT_NEAR(some.final_trace, 2.0 * none.final_trace, 1e-10 * none.final_trace);
}

TEST(LtiRiccati, AllLooksAtOnceAreTheSumOfTheInformation) {
  RandomStream stream(13);
  const Problem problem = random_problem({4, 3, 1}, stream);
  std::vector<Matrix> roots;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(4, 4);
  const std::vector<double> weights{0.5, 0.0, 2.0};
  for (std::size_t j = 0; j < 3; ++j) {
    const Sensor& sensor = problem.sensors[j];
    roots.push_back(information_root(sensor.c, sensor.r));
    expected += weights[j] * sensor.c.transpose() * sensor.r.ldlt().solve(sensor.c);
  }
  const Matrix root = joint_root(roots, weights);
  EXPECT_LE(root.rows(), 4);
  EXPECT_LT((root.transpose() * root - expected).norm(), kRounding * expected.norm());
}

TEST(LtiRiccati, TheSensitivityIsTheDerivative) {
  RandomStream stream(14);
  for (const CovarianceKind kind : {CovarianceKind::kPredicted, CovarianceKind::kFiltered}) {
    Problem problem = random_problem({3, 2, 1}, stream);
    problem.initial += Eigen::Matrix3d::Identity();
    const Matrix root = information_root(problem.sensors[0].c, problem.sensors[0].r);
    const Matrix more = information_root(problem.sensors[1].c, problem.sensors[1].r);
    Sensitivity sensitivity;
    (void)riccati_step(problem.a, problem.w, root, kind, problem.initial, &sensitivity);
    // Central differences: an error of h^2 = 1e-8 times third derivatives, and 1e-16 / h of rounding.
    constexpr double h = 1e-4;
    const auto after = [&](double dp, double dm) {
      const std::vector<Matrix> roots{root, more};
      const Matrix p = problem.initial + dp * problem.w;
      return dm == 0.0 ? riccati_step(problem.a, problem.w, root, kind, p)
                       : riccati_step(problem.a, problem.w, joint_root(roots, std::vector<double>{1.0, dm}), kind, p);
    };
    const Matrix by_p = (after(h, 0.0) - after(-h, 0.0)) / (2.0 * h);
    EXPECT_LT((by_p - sensitivity.f * problem.w * sensitivity.f.transpose()).norm(), 1e-6 * (1.0 + by_p.norm()));
    // No weight is negative: a one-sided difference of second order.
    const Matrix by_m = (4.0 * after(0.0, h) - 3.0 * after(0.0, 0.0) - after(0.0, 2.0 * h)) / (2.0 * h);
    const Matrix mb = more * sensitivity.b.transpose();
    EXPECT_LT((by_m + mb.transpose() * mb).norm(), 1e-4 * (1.0 + by_m.norm()));
  }
}

// Noise of 1e-12 beside variances of 1e6: the gain is near the inverse of C, and P must not become indefinite by more
// than Joseph's products F P F' + K R K' round: a step by 2 n eps of the sums of absolute values, and what was lost
// before is led on by F.
TEST(LtiRiccati, CovariancesStaySemidefiniteWherePrecisionIsLost) {
  RandomStream stream(15);
  Problem problem = random_problem({4, 2, 1}, stream);
  problem.initial = 1e6 * Eigen::Matrix4d::Identity();
  for (Sensor& sensor : problem.sensors) {
    sensor.r = 1e-12 * Eigen::MatrixXd::Identity(sensor.r.rows(), sensor.r.cols());
  }
  Riccati riccati(problem);
  std::vector<double> covariance = riccati.initial();
  Eigen::Matrix4d lost = Eigen::Matrix4d::Zero();
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Map<const Eigen::Matrix4d> p(covariance.data());
    const Sensor& sensor = problem.sensors[static_cast<std::size_t>(k % 2)];
    Sensitivity by;
    (void)riccati_step(problem.a, problem.w, information_root(sensor.c, sensor.r), problem.covariance, p, &by);
    const Matrix absolute = by.f.cwiseAbs();
    const double sums = (absolute * p.cwiseAbs() * absolute.transpose()).trace();
    riccati.step(covariance.data(), 1 + k % 2, covariance.data());
    ASSERT_EQ(p, p.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(p, Eigen::EigenvaluesOnly);
    lost = (by.f * lost * by.f.transpose()).eval();
    lost.diagonal().array() += 8.0 * std::numeric_limits<double>::epsilon() * (sums + p.trace());
    ASSERT_GE(solver.eigenvalues()[0], -lost.trace()) << k;
    ASSERT_LT(lost.trace(), 1e-6 * std::max(1.0, p.trace())) << k;
  }
}

TEST(LtiRiccati, ACovarianceBeyondADoubleIsSaid) {
  Problem problem = alriksson(1.0, kMaximumHorizon);
  problem.a *= 2.0;
  problem.sensors[1].c.setZero();
  EXPECT_THROW(evaluate(problem, std::vector<int>(kMaximumHorizon, 2)), std::overflow_error);
}

}  // namespace
}  // namespace dwell::lti
