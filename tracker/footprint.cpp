#include "tracker/footprint.hpp"

#include <cmath>

namespace dwell {
namespace {

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

}  // namespace

double footprint_probability(const Sensor& sensor, const Gaussian& belief, const State& pointing) {
  const Vector2 half = sensor.footprint_half_extent();
  if (!half.allFinite()) return 1.0;
  const Vector2 offset = sensor.residual(sensor.measure(belief.mean), sensor.measure(pointing));
  const MeasurementJacobian h = sensor.jacobian(belief.mean);
  const Matrix2 spread = h * belief.covariance * h.transpose();
  double probability = 1.0;
  for (int i = 0; i < 2; ++i) {
    const double sigma = std::sqrt(std::max(spread(i, i), 1e-300));
    probability *= normal_cdf((half[i] - offset[i]) / sigma) - normal_cdf((-half[i] - offset[i]) / sigma);
  }
  return probability;
}

}  // namespace dwell
