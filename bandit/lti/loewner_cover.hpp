#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bandit/lti/riccati.hpp"

namespace dwell::lti {

/// A set of covariances (each one or more blocks) that may make another one superfluous.
///
/// U is covered where some mixture of the members is below it in every block (Loewner order):
///
///   lambda >= 0,  sum_k lambda_k = 1,  sum_k lambda_k X_k[b] <= U[b] + tolerance tr U[b] I
///
/// Riccati steps are monotone and concave: whatever schedule follows, some member of the mixture ends with no larger
/// a trace than U. Each member alone is tried first; then, with the first kMixed of them, cutting planes: minimise t
/// over lambda under v' (sum_k lambda_k X_k - U) v <= t tr U for a few vectors v. Where t is over the tolerance, U is
/// not covered; where the largest eigenvalue at lambda is not, it is; else its eigenvector is the next cut. Undecided
/// after kRounds counts as not covered. "Covered" is only said of a lambda that was checked: an error of the linear
/// program costs time, not correctness.
///
/// Source  Alriksson, Rantzer (2005), procedure 2; Kelley (1960), J. SIAM 8, 703-712, for the cuts.
class LoewnerCover {
 public:
  /// Members that are mixed: a linear program of so many columns takes about a millisecond.
  static constexpr Eigen::Index kMixed = 200;

  /// Sizes of the blocks, which lie one after the other, column-major.
  explicit LoewnerCover(std::vector<int> block_sizes);

  void add(std::span<const double> member);
  bool covers(std::span<const double> candidate, double tolerance) const;

 private:
  // A candidate that is decided takes about as many rounds as a block has entries.
  static constexpr int kRounds = 100;

  /// v' X[block] v / tr U[block], over all of X at once: weights . X.
  struct Cut {
    Eigen::Index offset;      // of the block
    Eigen::VectorXd weights;  // v v' / tr U[block]
  };
  Cut cut(std::span<const double> candidate, std::size_t block, const Eigen::VectorXd& v) const;
  std::vector<Cut> axes(std::span<const double> candidate) const;
  std::vector<Cut> violated(std::span<const double> candidate, const Eigen::VectorXd& lambda, double tolerance) const;
  bool below(Eigen::Index member, std::span<const double> candidate, double tolerance) const;
  bool mixture_covers(std::span<const double> candidate, double tolerance) const;
  Eigen::Map<const Eigen::MatrixXd> block(std::span<const double> covariance, std::size_t b) const;
  double scale(std::span<const double> candidate, std::size_t b) const;

  std::vector<int> sizes_;
  std::vector<Eigen::Index> offsets_;
  Eigen::Index size_ = 0;        // entries of a member
  std::vector<double> members_;  // one after the other
};

}  // namespace dwell::lti
