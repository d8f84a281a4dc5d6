#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bandit/lti/problem.hpp"

namespace dwell::lti {

/// A matrix of at most kMaximumStates rows and columns, without heap.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaximumStates, kMaximumStates>;

/// What a look tells of the state: H with H'H = C' R^-1 C, at most n rows. The look is then y = H x + v, v ~ N(0, I):
/// every covariance is the same as with C and R, whatever the number of rows of C was.
Matrix information_root(const Eigen::MatrixXd& c, const Eigen::MatrixXd& r);

/// H with H'H = sum_i weight_i H_i' H_i: all looks at once, each with its noise divided by its weight >= 0.
Matrix joint_root(std::span<const Matrix> roots, std::span<const double> weights);

/// How the covariance after a step moves with the one before it and with what the look tells:
/// dP+ = F dP F' - B d(H'H) B'. The gain does not count, since it is the best one.
struct Sensitivity {
  Matrix f;
  Matrix b;
};

/// Covariance of one step: prediction, look (`root` with no rows: none) in the order of the convention.
///
///   predicted   P+ = (A - K H) P (A - K H)' + K K' + W,   K = A P H' S^-1,  S = H P H' + I
///   filtered    M = A P A' + W,  P+ = (I - K H) M (I - K H)' + K K',  K = M H' S^-1,  S = H M H' + I
///   and F = A - K H, B = F P;  F = (I - K H) A, B = P+.
///
/// Joseph's form: symmetric and positive semidefinite whatever the rounding of K. S has no eigenvalue under one.
/// Cost     O(n^3), no allocation.
/// Source   Chung et al. (2004), (6); Evans et al. (2005), (16), (17).
Matrix riccati_step(const Matrix& a, const Matrix& w, const Matrix& root, CovarianceKind kind, const Matrix& p,
                    Sensitivity* sensitivity = nullptr);

/// The Riccati steps of a problem. A node of a search has one covariance, or m with communication noise: its *blocks*,
/// stored one after the other, n x n each, column-major.
class Riccati {
 public:
  /// W and every noise covariance multiplied by `scale` > 0.
  explicit Riccati(const Problem& problem, double scale = 1.0);

  int states() const { return static_cast<int>(a_.rows()); }
  int blocks() const { return blocks_; }
  /// Doubles in all blocks of one node.
  std::size_t size() const { return static_cast<std::size_t>(blocks_) * block_size(); }
  std::size_t block_size() const { return static_cast<std::size_t>(states()) * static_cast<std::size_t>(states()); }

  std::vector<double> initial() const;
  /// One step of all blocks with sensor `choice`, 1 .. m, or 0 for none. `from` and `to` may be the same.
  void step(const double* from, int choice, double* to);
  /// One step of all blocks with the looks of all sensors at once.
  void step_with_all(const double* from, double* to);
  /// One step of one block with a look of any kind.
  Matrix step(const Matrix& p, const Matrix& root, Sensitivity* sensitivity = nullptr);
  /// What sensor `choice` tells in a block; no rows where it is 0.
  const Matrix& root(int block, int choice) const;
  /// tr P, summed over blocks.
  double trace(const double* covariance) const;
  /// Single n x n steps taken so far.
  std::uint64_t steps() const { return steps_; }

 private:
  void step_block(const double* from, const Matrix& root, double* to);

  CovarianceKind kind_;
  int sensors_;
  int blocks_;
  Matrix a_;
  Matrix w_;
  Matrix initial_;
  Matrix none_;                // no rows
  std::vector<Matrix> roots_;  // of block i and sensor j: i * m + j
  std::vector<Matrix> all_;    // of block i, all sensors
  std::uint64_t steps_ = 0;
};

}  // namespace dwell::lti
