#pragma once

#include <Eigen/Cholesky>

#include "radar/sensor.hpp"
#include "tracker/gaussian.hpp"

namespace dwell {

/// What a sensor is expected to measure of one Gaussian, as an affine model z = z_predicted + H (x - mean) + v,
/// v ~ N(0, R), with the innovation covariance S = H P H' + R and its Cholesky factor.
struct PredictedMeasurement {
  Vector2 z = Vector2::Zero();
  MeasurementJacobian h = MeasurementJacobian::Zero();
  Matrix2 r = Matrix2::Zero();
  Matrix2 s = Matrix2::Zero();
  Eigen::LLT<Matrix2> s_root;

  /// nu' S^-1 nu.
  double squared_distance(const Vector2& nu) const { return s_root.matrixL().solve(nu).squaredNorm(); }
  /// log |S|.
  double log_determinant() const { return 2.0 * s_root.matrixLLT().diagonal().array().log().sum(); }
  /// log N(nu; 0, S).
  double log_likelihood(const Vector2& nu) const;
};

/// Fills S and its factor from P, H and R.
Numerics factorise(const StateMatrix& covariance, PredictedMeasurement& predicted);

using Gain = Eigen::Matrix<double, kStateSize, 2>;

/// K = P H' S^-1, by the factor of S.
Gain kalman_gain(const StateMatrix& covariance, const PredictedMeasurement& predicted);

/// (I - K H) P (I - K H)' + K R K': symmetric and positive definite whatever the rounding of K. Joseph's form.
StateMatrix updated_covariance(const StateMatrix& covariance, const PredictedMeasurement& predicted, const Gain& k);

/// Kalman measurement update with innovation nu (2).
Gaussian kalman_update(const Gaussian& prior, const PredictedMeasurement& predicted, const Vector2& nu);

}  // namespace dwell
