#include "tracker/measurement.hpp"

#include <Eigen/LU>

namespace dwell {
namespace {

bool converts(const Sensor& sensor, UpdateForm form) {
  return form == UpdateForm::kConverted && sensor.position_of(Vector2::Zero()).has_value();
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

double mixture_squared_distance(const std::vector<PredictedMeasurement>& predicted, const Eigen::VectorXd& probability,
                                const std::vector<Vector2>& innovation) {
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
