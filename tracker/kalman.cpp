#include "tracker/kalman.hpp"

#include <cmath>
#include <numbers>

namespace dwell {

double PredictedMeasurement::log_likelihood(const Vector2& nu) const {
  static const double kLogTwoPi = std::log(2.0 * std::numbers::pi);
  return -0.5 * (squared_distance(nu) + log_determinant()) - kLogTwoPi;
}

Numerics factorise(const StateMatrix& covariance, PredictedMeasurement& predicted) {
  predicted.s = predicted.h * covariance * predicted.h.transpose() + predicted.r;
  predicted.s_root.compute(predicted.s);
  const bool positive = predicted.s_root.info() == Eigen::Success && predicted.s.allFinite();
  return positive ? Numerics::kOk : Numerics::kNotPositiveDefinite;
}

Gain kalman_gain(const StateMatrix& covariance, const PredictedMeasurement& predicted) {
  return predicted.s_root.solve(predicted.h * covariance).transpose();
}

StateMatrix updated_covariance(const StateMatrix& covariance, const PredictedMeasurement& predicted, const Gain& k) {
  const StateMatrix rest = StateMatrix::Identity() - k * predicted.h;
  return symmetric_part(rest * covariance * rest.transpose() + k * predicted.r * k.transpose());
}

Gaussian kalman_update(const Gaussian& prior, const PredictedMeasurement& predicted, const Vector2& nu) {
  const Gain k = kalman_gain(prior.covariance, predicted);
  return {prior.mean + k * nu, updated_covariance(prior.covariance, predicted, k)};
}

}  // namespace dwell
