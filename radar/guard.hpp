#pragma once

#include <Eigen/Core>

#include "radar/state.hpp"

namespace dwell {

/// A stochastic linear guard: in mode `from` the target changes to mode `to` at the step at whose start
///
///   L x + b + e <= 0 in every element,   e ~ N(0, E E') drawn anew at every step
///
/// Shapes   L v x 4, b v, E v x v; v >= 1. The random thresholds theta of the source are in b and e: with
///          L = [L_x L_theta], b = b_source + L_theta mean(theta) and E E' = L_theta cov(theta) L_theta'.
/// Source   Liu, Hwang (2011), II.A, (4).
struct Guard {
  int from = 0;
  int to = 0;
  Eigen::Matrix<double, Eigen::Dynamic, kStateSize> l;
  Eigen::VectorXd b;
  Eigen::MatrixXd noise_root;  ///< E
};

}  // namespace dwell
