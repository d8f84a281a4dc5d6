#pragma once

#include "bandit/restless/problem.hpp"

namespace dwell::restless {

/// What a detected look does to a covariance, with the gain it fixes.
///
///   K = P H' S^-1,  S = H P H' + R          M = A P A' + K R K',  A = I - K H          (Joseph's form)
///
/// A and K R K' stay as they are when P changes: the look's plan then costs a linear function of P.
struct LookUpdate {
  Matrix a;           ///< A
  Matrix noise;       ///< K R K'
  Matrix covariance;  ///< M
};

/// Requires S positive definite, which R is.
LookUpdate look_update(const Sensor& sensor, const Matrix& predicted);

/// F M F' + Q, exactly symmetric.
Matrix predict(const Arm& arm, const Matrix& covariance);

/// weight <C, M>: what a scan that ends with M costs.
double scan_cost(const Arm& arm, const Matrix& covariance);

/// The expected cost of a scan with that look at predicted covariance P, and the state it is made in.
double expected_scan_cost(const Arm& arm, const Sensor& sensor, const Matrix& predicted);

/// Looks with every sensor in every scan, all detected.
struct AllLooks {
  Matrix covariance;  ///< that they settle at, predicted: what no policy gets below once it started above it
  double memory;      ///< what one scan leaves of a covariance's difference to it: spectral radius of F A, squared
};

/// A fixed point of the Riccati step from p0 + q, by iteration until it changes by 1e-14 of itself or for 100 000
/// steps.
AllLooks all_looks(const Arm& arm);

/// Spectral radius of a square matrix.
double spectral_radius(const Matrix& m);

}  // namespace dwell::restless
