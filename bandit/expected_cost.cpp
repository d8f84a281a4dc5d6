#include "bandit/expected_cost.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "bandit/information_reduction.hpp"
#include "tracker/footprint.hpp"

namespace dwell {

StateMatrix position_weight() {
  const auto h = position_selector();
  return h.transpose() * h;
}

ExpectedCost::ExpectedCost(const CostWeights& weights, int nodes) : weights_(weights), rule_(nodes) {
  const Eigen::SelfAdjointEigenSolver<StateMatrix> w(weights.w);
  const State root = w.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  root_ = w.eigenvectors() * root.asDiagonal() * w.eigenvectors().transpose();
}

double ExpectedCost::without_look(const ImmEstimate& predicted) const {
  const Gaussian combined = combine(predicted);
  return weights_.w.cwiseProduct(combined.covariance).sum() +
         weights_.beta * (1.0 - predicted.probability.squaredNorm());
}

Numerics ExpectedCost::with_look(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form, double& cost) {
  const Numerics numerics = predict_measurements(sensor, form, predicted, measurements_);
  if (numerics != Numerics::kOk) return numerics;
  const double detected = within_modes(predicted, sensor, form) + between_modes();
  const State pointing = combined_mean(predicted);
  double in_footprint = 0.0;
  for (int j = 0; j < predicted.size(); ++j) {
    in_footprint += predicted.probability[j] * footprint_probability(sensor, predicted.modes[j], pointing);
  }
  const double p_d = sensor.detection_probability(pointing) * in_footprint;
  const double kept = kept_information(predicted, sensor, form, pointing, p_d);
  const double expected = kept * detected + (1.0 - kept) * without_look(predicted);
  if (!std::isfinite(expected)) return Numerics::kNotFinite;
  cost = expected;
  return Numerics::kOk;
}

/// q2 of the modes' gates, weighted by the modes; P_d without clutter.
double ExpectedCost::kept_information(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form,
                                      const State& pointing, double p_d) const {
  if (sensor.clutter_density() <= 0.0) return p_d;
  constexpr double kGate = 16.0;
  const double density = clutter_density(sensor, form, pointing);
  double kept = 0.0;
  for (std::size_t j = 0; j < measurements_.size(); ++j) {
    const double area = kGate * std::numbers::pi * std::exp(0.5 * measurements_[j].log_determinant());
    kept += predicted.probability[static_cast<Eigen::Index>(j)] * information_reduction(p_d, density * area);
  }
  return kept;
}

/// sum_j c_j tr(W P_j), and each mode's posterior on the way.
double ExpectedCost::within_modes(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form) {
  posteriors_.clear();
  double sum = 0.0;
  for (std::size_t j = 0; j < measurements_.size(); ++j) {
    const double c = predicted.probability[static_cast<Eigen::Index>(j)];
    if (c == 0.0) continue;
    const Gaussian& prior = predicted.modes[j];
    const PredictedMeasurement& seen = measurements_[j];
    const Gain gain = kalman_gain(prior.covariance, seen);
    sum += c * weights_.w.cwiseProduct(updated_covariance(prior.covariance, seen, gain)).sum();
    const double log_determinant = seen.log_determinant();
    ModePosterior& mode = posteriors_.emplace_back();
    mode.log_determinant = log_determinant;
    mode.plot.z = innovation(sensor, form, seen.z, measurements_[0].z);
    mode.plot.information = seen.s_root.solve(Matrix2::Identity());
    mode.plot.log_peak = std::log(c / (2.0 * std::numbers::pi)) - 0.5 * log_determinant;
    mode.slope = root_ * gain;
    mode.constant = root_ * (prior.mean - predicted.modes[0].mean) - mode.slope * mode.plot.z;
  }
  std::sort(posteriors_.begin(), posteriors_.end(),
            [](const ModePosterior& i, const ModePosterior& j) { return i.log_determinant < j.log_determinant; });
  return sum;
}

double ExpectedCost::between_modes() {
  double sum = 0.0;
  for (std::size_t a = 0; a < posteriors_.size(); ++a) {
    for (std::size_t b = a + 1; b < posteriors_.size(); ++b) {
      for (const OverlapRule::Node& node : rule_.place(posteriors_[a].plot, posteriors_[b].plot)) {
        sum += node.area * integrand(a, b, node.y);
      }
    }
  }
  return sum;
}

/// c_a N_a w_b (|x_a - x_>a|_W^2 + beta (1 + sum_{j>a} pi_j^2)) at y.
double ExpectedCost::integrand(std::size_t a, std::size_t b, const Vector2& y) const {
  constexpr double kNothing = 1e-140;  // a density whose square is still a normal double
  double f_b = 0.0;
  double rest = 0.0;
  double squares = 0.0;
  State mean = State::Zero();
  for (std::size_t j = a + 1; j < posteriors_.size(); ++j) {
    const double f = std::exp(posteriors_[j].plot.log_density(y));
    if (j == b) f_b = f;
    rest += f;
    squares += f * f;
    mean += f * (posteriors_[j].constant + posteriors_[j].slope * y);
  }
  if (rest < kNothing) return 0.0;
  const double f_a = std::exp(posteriors_[a].plot.log_density(y));
  const State apart = posteriors_[a].constant + posteriors_[a].slope * y - mean / rest;
  const double difference = apart.squaredNorm() + weights_.beta * (1.0 + squares / (rest * rest));
  return f_a * f_b / (f_a + rest) * difference;
}

}  // namespace dwell
