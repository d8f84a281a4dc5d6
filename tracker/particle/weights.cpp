#include "tracker/particle/weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dwell {

Numerics normalise(std::span<const double> log_weight, std::vector<double>& weight) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const double value : log_weight) {
    if (std::isnan(value)) return Numerics::kNotFinite;
    largest = std::max(largest, value);
  }
  if (!std::isfinite(largest)) return Numerics::kNotFinite;
  weight.resize(log_weight.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < log_weight.size(); ++i) sum += weight[i] = std::exp(log_weight[i] - largest);
  for (double& value : weight) value /= sum;
  return Numerics::kOk;
}

ImmEstimate moments_by_mode(std::span<const WeightedGaussian> parts, int modes) {
  ImmEstimate estimate = make_estimate({}, Eigen::VectorXd::Zero(modes));
  for (const WeightedGaussian& part : parts) {
    estimate.probability[part.mode] += part.weight;
    estimate.modes[static_cast<std::size_t>(part.mode)].mean += part.weight * part.belief.mean;
  }
  for (int j = 0; j < modes; ++j) {
    if (estimate.probability[j] > 0.0) estimate.modes[static_cast<std::size_t>(j)].mean /= estimate.probability[j];
  }
  for (const WeightedGaussian& part : parts) {
    if (part.weight <= 0.0) continue;
    Gaussian& mode = estimate.modes[static_cast<std::size_t>(part.mode)];
    const State spread = part.belief.mean - mode.mean;
    mode.covariance +=
        part.weight / estimate.probability[part.mode] * (part.belief.covariance + spread * spread.transpose());
  }
  const Gaussian all = combine(estimate);
  for (int j = 0; j < modes; ++j) {
    if (estimate.probability[j] == 0.0) estimate.modes[static_cast<std::size_t>(j)] = all;
  }
  return estimate;
}

}  // namespace dwell
