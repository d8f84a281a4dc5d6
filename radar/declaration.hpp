#pragma once

#include <Eigen/Core>

namespace dwell {

/// What a sensor's plots say of the class of their target: one of n, right or wrong.
///
///   P(d | class k) = emission(k, d)        P(d | false plot) = 1 / n
///
/// A false plot is of no class, and nothing is known of what it is taken for: the distribution of greatest entropy.
struct Declaration {
  Eigen::MatrixXd emission;  ///< n x n, rows sum to one

  int classes() const { return static_cast<int>(emission.rows()); }
};

}  // namespace dwell
