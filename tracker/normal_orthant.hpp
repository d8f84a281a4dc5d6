#pragma once

#include <Eigen/Core>

namespace dwell {

/// Phi_v: the probability that no element of y ~ N(mean, covariance) is positive, y of v elements.
///
///   v = 1   erfc
///   v = 2   Owen's T function: Phi_2(h, k; rho) = (Phi(h) + Phi(k)) / 2 - T(h, a_h) - T(k, a_k) - {0 or 1/2}
///   v = 3   Plackett's identity along R(t), whose correlations with the first element are scaled by t:
///             d Phi_3 / dt = sum_{j=2,3} rho_1j phi_2(b_1, b_j; t rho_1j) Phi(the third given these two),
///           from the product of the independent parts at t = 0, by adaptive Gauss-Kronrod
///   v > 3   one conditional normal after another over a rank-1 lattice (16 shifts of 1024 points, the same for every
///           call). Not exact: see the error.
///
/// Shapes   mean v, covariance v x v, v >= 1.
/// Requires finite elements; covariance symmetric and positive semidefinite. It may be singular: elements without
///          variance are compared with zero, correlations of one are exact.
/// Errors   absolute, measured in tests/tracker/normal_orthant_test.cpp: 1e-14 for v <= 2, 1e-12 for v = 3, 2e-4 for
///          v = 4 .. 8. A correlation that is rounded at one by eps moves the value by sqrt(eps): that is in the input.
/// Source   Owen (1956), Ann. Math. Stat. 27; Plackett (1954), Biometrika 41; Genz (1992), J. Comp. Graph. Stat. 1.
double normal_orthant(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

/// Standard normal distribution function.
double normal_cdf(double x);

}  // namespace dwell
