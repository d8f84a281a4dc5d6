#include "bandit/bhattacharyya.hpp"

#include <cmath>

#include <Eigen/LU>

namespace dwell {
namespace {

double no_look_bound(const Eigen::VectorXd& probability) {
  // sum_{i<j} sqrt(c_i c_j) = ((sum sqrt c)^2 - 1) / 2
  const double roots = probability.cwiseSqrt().sum();
  return 0.5 * (roots * roots - probability.sum());
}

double exponent(const PredictedMeasurement& a, const PredictedMeasurement& b, const Vector2& apart) {
  const Matrix2 mean = 0.5 * (a.s + b.s);
  const double log_mean = std::log(mean.determinant());
  return 0.125 * apart.dot(mean.inverse() * apart) +
         0.5 * (log_mean - 0.5 * (a.log_determinant() + b.log_determinant()));
}

}  // namespace

double bhattacharyya_bound(const Sensor& sensor, UpdateForm form, const Eigen::VectorXd& probability,
                           const std::vector<PredictedMeasurement>& measurements) {
  double bound = 0.0;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    for (std::size_t j = i + 1; j < measurements.size(); ++j) {
      const double weight =
          std::sqrt(probability[static_cast<Eigen::Index>(i)] * probability[static_cast<Eigen::Index>(j)]);
      const Vector2 apart = innovation(sensor, form, measurements[i].z, measurements[j].z);
      bound += weight * std::exp(-exponent(measurements[i], measurements[j], apart));
    }
  }
  return bound;
}

void Bhattacharyya::score(const Situation& situation, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const Track& track = situation.tracks[candidate.pair.track];
    const Sensor& sensor = *situation.sensors[candidate.pair.sensor];
    candidate.score = 0.0;  // stays where the numbers fail: a look of no use
    const Numerics numerics = predict_measurements(sensor, situation.update, track.estimate, measurements_);
    if (numerics != Numerics::kOk) continue;
    const auto& probability = track.estimate.probability;
    const double with = bhattacharyya_bound(sensor, situation.update, probability, measurements_);
    const double gain = sensor.detection_probability(track.combined.mean) * (no_look_bound(probability) - with);
    if (std::isfinite(gain)) candidate.score = track.weight * gain;
  }
}

}  // namespace dwell
