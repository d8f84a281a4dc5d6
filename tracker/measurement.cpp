#include "tracker/measurement.hpp"

#include <cmath>

#include <Eigen/LU>

namespace dwell {
namespace {

bool converts(const Sensor& sensor, UpdateForm form) {
  return form == UpdateForm::kConverted && sensor.position_of(Vector2::Zero()).has_value();
}

/// Fills z, H and R (which holds the sensor's) from the moments of h over the mode. With o_k+ and o_k- those of h at
/// the two points of an arm k, d_k their difference and e_k their mean, the covariance splits exactly into sum d d' /
/// 4n, which is H P H', and the covariance of the e_k: nothing is subtracted from anything near it.
Numerics cubature(const Sensor& sensor, const Gaussian& mode, PredictedMeasurement& out) {
  const Eigen::LLT<StateMatrix> root(mode.covariance);
  if (root.info() != Eigen::Success) return Numerics::kNotPositiveDefinite;
  const double sqrt_n = std::sqrt(static_cast<double>(kStateSize));
  const StateMatrix arms = sqrt_n * StateMatrix(root.matrixL());
  const Vector2 centre = sensor.measure(mode.mean);
  MeasurementJacobian d;
  MeasurementJacobian e;
  for (int k = 0; k < kStateSize; ++k) {
    const Vector2 plus = sensor.residual(sensor.measure(mode.mean + arms.col(k)), centre);
    const Vector2 minus = sensor.residual(sensor.measure(mode.mean - arms.col(k)), centre);
    d.col(k) = plus - minus;
    e.col(k) = 0.5 * (plus + minus);
  }
  const Vector2 mean = e.rowwise().mean();
  e.colwise() -= mean;
  out.z = centre + mean;
  out.h = root.matrixU().solve(d.transpose()).transpose() / (2.0 * sqrt_n);
  out.r += e * e.transpose() / kStateSize;
  return Numerics::kOk;
}

}  // namespace

Matrix2 position_noise(const Sensor& sensor, const State& x) {
  const Matrix2 g = (sensor.jacobian(x) * position_selector().transpose()).inverse();
  const Matrix2 r = g * sensor.noise(x) * g.transpose();
  return 0.5 * (r + r.transpose());
}

Numerics predict_measurements(const Sensor& sensor, UpdateForm form, const ImmEstimate& predicted,
                              std::vector<PredictedMeasurement>& out) {
  out.resize(predicted.modes.size());
  const State centre = combined_mean(predicted);
  const bool converted = converts(sensor, form);
  const Matrix2 r = converted ? position_noise(sensor, centre) : sensor.noise(centre);
  for (std::size_t j = 0; j < out.size(); ++j) {
    const Gaussian& mode = predicted.modes[j];
    out[j].z = converted ? position(mode.mean) : sensor.measure(mode.mean);
    out[j].h = converted ? position_selector() : sensor.jacobian(mode.mean);
    out[j].r = r;
    if (form == UpdateForm::kCubature) {
      if (const Numerics moments = cubature(sensor, mode, out[j]); moments != Numerics::kOk) return moments;
    }
    if (const Numerics factor = factorise(mode.covariance, out[j]); factor != Numerics::kOk) return factor;
  }
  return Numerics::kOk;
}

Vector2 measurement_of(const Sensor& sensor, UpdateForm form, const Vector2& z) {
  return converts(sensor, form) ? *sensor.position_of(z) : z;
}

Vector2 innovation(const Sensor& sensor, UpdateForm form, const Vector2& z, const Vector2& predicted) {
  return converts(sensor, form) ? Vector2(z - predicted) : sensor.residual(z, predicted);
}

double clutter_density(const Sensor& sensor, UpdateForm form, const State& x) {
  const double density = sensor.clutter_density();
  if (!converts(sensor, form)) return density;
  return density * std::abs((sensor.jacobian(x) * position_selector().transpose()).determinant());
}

double mixture_squared_distance(std::span<const PredictedMeasurement> predicted, const Eigen::VectorXd& probability,
                                std::span<const Vector2> innovation) {
  Vector2 mean = Vector2::Zero();
  for (std::size_t j = 0; j < predicted.size(); ++j) mean += probability[j] * innovation[j];
  Matrix2 s = Matrix2::Zero();
  for (std::size_t j = 0; j < predicted.size(); ++j) {
    const Vector2 spread = innovation[j] - mean;
    s += probability[j] * (predicted[j].s + spread * spread.transpose());
  }
  return mean.dot(s.ldlt().solve(mean));
}

}  // namespace dwell
