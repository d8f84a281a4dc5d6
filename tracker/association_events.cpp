#include "tracker/association_events.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "radar/assert.hpp"
#include "tracker/class_belief.hpp"
#include "tracker/footprint.hpp"

namespace dwell {
namespace {

/// The sensor's density of false plots in the space of the measurements, with its floor.
double false_plot_density(const Sensor& sensor, UpdateForm form, const State& x,
                          std::span<const PredictedMeasurement> predicted) {
  constexpr double kGate = 16.0;
  double least_log_determinant = predicted.front().log_determinant();
  for (const PredictedMeasurement& mode : predicted) {
    least_log_determinant = std::min(least_log_determinant, mode.log_determinant());
  }
  const double volume = std::numbers::pi * kGate * std::exp(0.5 * least_log_determinant);
  return std::max(clutter_density(sensor, form, x), AssociationEvents::kLeastClutter / volume);
}

}  // namespace

void AssociationEvents::reserve(std::size_t plots, std::size_t modes) {
  in_gate_.reserve(plots);
  sums_.reserve(plots);
  innovations_.reserve((plots + 1) * modes);
  weights_.reserve(plots * modes);
}

Numerics AssociationEvents::list(const Sensor& sensor, UpdateForm form, double gate, const ImmEstimate& predicted,
                                 const State& pointing, std::span<const Plot> plots,
                                 const Eigen::VectorXd& class_belief) {
  modes_ = predicted.modes.size();
  in_gate_.clear();
  innovations_.clear();
  weights_.clear();
  sums_.clear();
  none_of_mode_.assign(modes_, 0.0);
  detected_.assign(modes_, 0.0);
  none_ = 1.0;
  if (const Numerics seen = predict_measurements(sensor, form, predicted, measurements_); seen != Numerics::kOk) {
    return seen;
  }
  const State centre = combined_mean(predicted);
  const double log_lambda = std::log(false_plot_density(sensor, form, centre, measurements_));
  const double p_d = std::min(sensor.detection_probability(centre), kLargestBelievedDetection);
  const double p_gate = -std::expm1(-0.5 * gate);
  none_ = 0.0;
  for (std::size_t j = 0; j < modes_; ++j) {
    const double c = predicted.probability[static_cast<Eigen::Index>(j)];
    detected_[j] = c * p_d * footprint_probability(sensor, predicted.modes[j], pointing);
    none_of_mode_[j] = c - detected_[j] * p_gate;
    none_ += none_of_mode_[j];
  }
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (!plots[i].z.allFinite()) continue;
    const auto same = [&](std::size_t earlier) { return plots[earlier].z == plots[i].z; };
    if (std::any_of(in_gate_.begin(), in_gate_.end(), same)) continue;
    const Vector2 z = measurement_of(sensor, form, plots[i].z);
    bool inside = false;
    for (const PredictedMeasurement& mode : measurements_) {
      innovations_.push_back(innovation(sensor, form, z, mode.z));
      inside = inside || mode.squared_distance(innovations_.back()) < gate;
    }
    if (!inside) {
      innovations_.resize(in_gate_.size() * modes_);
      continue;
    }
    const std::size_t first = in_gate_.size() * modes_;
    in_gate_.push_back(i);
    const double declared = declaration_ratio(sensor, plots[i], class_belief);
    double sum = 0.0;
    for (std::size_t j = 0; j < modes_; ++j) {
      // At most 8 n / kLeastClutter by the floor of lambda; what underflows to nothing is outweighed by w_0.
      weights_.push_back(detected_[j] * declared *
                         std::exp(measurements_[j].log_likelihood(innovations_[first + j]) - log_lambda));
      sum += weights_.back();
    }
    sums_.push_back(sum);
  }
  const bool finite =
      std::isfinite(none_) && std::all_of(sums_.begin(), sums_.end(), [](double sum) { return std::isfinite(sum); });
  if (finite) return Numerics::kOk;
  in_gate_.clear();
  return Numerics::kNotFinite;
}

double AssociationEvents::likelihood_ratio(std::span<const double> factor) const {
  double ratio = none_;
  for (std::size_t i = 0; i < size(); ++i) ratio += factor[i] * sums_[i];
  return ratio;
}

void AssociationEvents::update(std::span<const double> factor, ImmEstimate& estimate) const {
  DWELL_ASSERT(factor.size() == size() && estimate.modes.size() == modes_);
  const double ratio = likelihood_ratio(factor);
  for (std::size_t j = 0; j < modes_; ++j) {
    double total = none_of_mode_[j];
    for (std::size_t i = 0; i < size(); ++i) total += factor[i] * weights_[i * modes_ + j];
    if (total > 0.0) update_mode(j, total, factor, estimate.modes[j]);
    estimate.probability[static_cast<Eigen::Index>(j)] = total / ratio;
  }
}

void AssociationEvents::condition(std::optional<std::size_t> i, ImmEstimate& estimate) const {
  DWELL_ASSERT(estimate.modes.size() == modes_);
  for (std::size_t j = 0; j < modes_; ++j) {
    const double weight = i ? weights_[*i * modes_ + j] / sums_[*i] : none_of_mode_[j] / none_;
    estimate.probability[static_cast<Eigen::Index>(j)] = weight;
    if (i) estimate.modes[j] = kalman_update(estimate.modes[j], measurements_[j], innovations_[*i * modes_ + j]);
  }
}

void AssociationEvents::update_mode(std::size_t mode, double total, std::span<const double> factor,
                                    Gaussian& belief) const {
  if (size() == 0) return;
  Vector2 mean = Vector2::Zero();
  Matrix2 square = Matrix2::Zero();
  for (std::size_t i = 0; i < size(); ++i) {
    const double beta = factor[i] * weights_[i * modes_ + mode] / total;
    const Vector2& nu = innovations_[i * modes_ + mode];
    mean += beta * nu;
    square += beta * nu * nu.transpose();
  }
  const double none = none_of_mode_[mode] / total;
  const PredictedMeasurement& seen = measurements_[mode];
  const Gain gain = kalman_gain(belief.covariance, seen);
  const Matrix2 spread = square - mean * mean.transpose();
  const StateMatrix certain = updated_covariance(belief.covariance, seen, gain);
  belief.mean += gain * mean;
  belief.covariance =
      symmetric_part(none * belief.covariance + (1.0 - none) * certain + gain * spread * gain.transpose());
}

}  // namespace dwell
