#include "radar/calibration/trajectory_chain.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "radar/random.hpp"

namespace dwell::testing {
namespace {

using calibration::TrajectoryChain;

/// Two trajectories of three and of two states, four biases; the dense matrix is the judge.
TEST(TrajectoryChain, BlocksAreThoseOfTheDenseInverse) {
  RandomStream stream(1);
  const auto random = [&](Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd m(rows, columns);
    for (double& value : m.reshaped()) value = stream.normal();
    return m;
  };
  constexpr int kStates = 5;
  constexpr int kBiases = 4;
  TrajectoryChain chain(kStates, kBiases);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(24, 24);
  for (int i = 0; i < kStates; ++i) {
    // Sums of squares of [x_i, b] and of [x_i, x_i+1]: positive definite together.
    const Eigen::MatrixXd look = random(6, 8);
    const Eigen::MatrixXd square = look.transpose() * look;
    chain.own[i] += square.topLeftCorner(4, 4);
    chain.coupling[i] += square.topRightCorner(4, 4);
    chain.bias += square.bottomRightCorner(4, 4);
    if (i == 2 || i + 1 == kStates) continue;
    const Eigen::MatrixXd step = random(8, 8);
    const Eigen::MatrixXd link = step.transpose() * step;
    chain.own[i] += link.topLeftCorner(4, 4);
    chain.next[i] += link.topRightCorner(4, 4);
    chain.own[i + 1] += link.bottomRightCorner(4, 4);
  }
  for (int i = 0; i < kStates; ++i) {
    dense.block<4, 4>(4 * i, 4 * i) = chain.own[i];
    dense.block<4, 4>(4 * i, 20) = chain.coupling[i];
    dense.block<4, 4>(20, 4 * i) = chain.coupling[i].transpose();
    if (i + 1 == kStates) continue;
    dense.block<4, 4>(4 * i, 4 * (i + 1)) = chain.next[i];
    dense.block<4, 4>(4 * (i + 1), 4 * i) = chain.next[i].transpose();
  }
  dense.block<4, 4>(20, 20) = chain.bias;
  const Eigen::MatrixXd inverse = dense.ldlt().solve(Eigen::MatrixXd::Identity(24, 24));
  ASSERT_TRUE(chain.factor());
  // Condition numbers of such squares are under 1e6: ten digits are left.
  const double tolerance = 1e-10 * inverse.cwiseAbs().maxCoeff();
  EXPECT_LE((chain.bias_covariance() - inverse.block<4, 4>(20, 20)).cwiseAbs().maxCoeff(), tolerance);
  for (int i = 0; i < kStates; ++i) {
    EXPECT_LE((chain.state_covariance(i) - inverse.block<4, 4>(4 * i, 4 * i)).cwiseAbs().maxCoeff(), tolerance) << i;
    EXPECT_LE((chain.state_bias_covariance(i) - inverse.block<4, 4>(4 * i, 20)).cwiseAbs().maxCoeff(), tolerance) << i;
    if (i + 1 == kStates) continue;
    const auto next = inverse.block<4, 4>(4 * i, 4 * (i + 1));
    EXPECT_LE((chain.next_covariance(i) - next).cwiseAbs().maxCoeff(), tolerance) << i;
  }
}

TEST(TrajectoryChain, AnIndefiniteBlockIsRefused) {
  TrajectoryChain chain(1, 1);
  chain.own[0] = -StateMatrix::Identity();
  chain.bias(0, 0) = 1.0;
  EXPECT_FALSE(chain.factor());
}

}  // namespace
}  // namespace dwell::testing
