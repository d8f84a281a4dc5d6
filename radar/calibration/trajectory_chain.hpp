#pragma once

#include <vector>

#include "radar/state.hpp"

namespace dwell::calibration {

using BiasMatrix = Eigen::Matrix<double, kStateSize, Eigen::Dynamic>;

/// The normal equations of trajectories and biases: states x_1 .. x_N, each linked to the next of its trajectory at
/// most, and all of them to a few biases b.
///
///   [A B; B' D] [x; b] = [.; .],    A block tridiagonal, 4 x 4 blocks
///
/// `factor` gives the covariance of b with the trajectories taken out, C = (D - B' A^-1 B)^-1, and of each state and
/// each pair of neighbours with the biases in it: A^-1 + G C G', G = A^-1 B.
///
/// Shapes   N states, `next` N - 1 (zero between trajectories), `coupling` N of 4 x b, `bias` b x b.
/// Errors   `factor` is false where a block or the biases' complement is not positive definite.
/// Cost     O(N (n^3 + n b^2)).
/// Source   Triggs, McLauchlan, Hartley, Fitzgibbon (2000), Bundle Adjustment, 6.1, for the complement; the blocks of
///          A^-1: Takahashi, Fagan, Chen (1973), of a chain.
class TrajectoryChain {
 public:
  TrajectoryChain(std::size_t states, Eigen::Index biases);

  std::vector<StateMatrix> own;   ///< A_ii
  std::vector<StateMatrix> next;  ///< A_i,i+1
  std::vector<BiasMatrix> coupling;
  Eigen::MatrixXd bias;

  [[nodiscard]] bool factor();

  const Eigen::MatrixXd& bias_covariance() const { return bias_covariance_; }
  /// Of x_i; of x_i with x_i+1; of x_i with b.
  StateMatrix state_covariance(std::size_t i) const;
  StateMatrix next_covariance(std::size_t i) const;
  BiasMatrix state_bias_covariance(std::size_t i) const { return -gain_[i] * bias_covariance_; }

 private:
  std::vector<BiasMatrix> gain_;  // G
  std::vector<StateMatrix> inverse_;
  std::vector<StateMatrix> inverse_next_;
  Eigen::MatrixXd bias_covariance_;
};

}  // namespace dwell::calibration
