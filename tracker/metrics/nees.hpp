#pragma once

#include <Eigen/Cholesky>

#include "tracker/gaussian.hpp"

namespace dwell {

/// Normalised estimation error squared of the whole state, (x - m)' P^-1 (x - m): chi-square with 4 degrees of
/// freedom for a consistent Gaussian estimate. Source: Bar-Shalom, Li, Kirubarajan (2001), 5.4.2.
inline double nees(const State& truth, const Gaussian& estimate) {
  const State error = truth - estimate.mean;
  return error.dot(estimate.covariance.ldlt().solve(error));
}

/// The same of the position alone: 2 degrees of freedom.
inline double position_nees(const State& truth, const Gaussian& estimate) {
  const Vector2 error = position(truth) - position(estimate.mean);
  return error.dot(position_block(estimate.covariance).ldlt().solve(error));
}

}  // namespace dwell
