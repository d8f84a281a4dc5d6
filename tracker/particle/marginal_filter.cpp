#include "tracker/particle/marginal_filter.hpp"

#include <cmath>
#include <utility>

#include "radar/assert.hpp"
#include "tracker/kalman.hpp"

namespace dwell {

MarginalFilter::MarginalFilter(DiscreteBank bank, const Gaussian& start, const Eigen::VectorXd& probability,
                               int particles, RandomStream stream)
    : bank_(std::move(bank)), particles_(static_cast<std::size_t>(particles)), stream_(stream) {
  DWELL_ASSERT(particles >= 1 && bank_.guards.empty() && bank_.trailing.empty());
  for (int j = 0; j < bank_.size(); ++j) {
    if (probability[j] > 0.0) histories_.push_back({j, probability[j], start});
  }
}

void MarginalFilter::predict() {
  resample();
  next_.clear();
  for (const WeightedGaussian& history : histories_) {
    for (int j = 0; j < bank_.size(); ++j) {
      const double weight = history.weight * bank_.transition(history.mode, j);
      if (weight <= 0.0) continue;
      const StateMatrix& f = bank_.f[static_cast<std::size_t>(j)];
      const StateMatrix covariance =
          f * history.belief.covariance * f.transpose() + bank_.q[static_cast<std::size_t>(j)];
      next_.push_back({j, weight, {f * history.belief.mean, symmetric_part(covariance)}});
    }
  }
  std::swap(histories_, next_);
}

Numerics MarginalFilter::update(const Sensor& sensor, const Vector2& z) {
  log_weight_.clear();
  next_ = histories_;
  for (WeightedGaussian& history : next_) {
    PredictedMeasurement predicted;
    predicted.h = sensor.jacobian(history.belief.mean);
    predicted.r = sensor.noise(history.belief.mean);
    if (const Numerics factor = factorise(history.belief.covariance, predicted); factor != Numerics::kOk) {
      return factor;
    }
    const Vector2 nu = sensor.residual(z, sensor.measure(history.belief.mean));
    log_weight_.push_back(std::log(history.weight) + predicted.log_likelihood(nu));
    history.belief = kalman_update(history.belief, predicted, nu);
  }
  if (const Numerics weights = normalise(log_weight_, weight_); weights != Numerics::kOk) return weights;
  for (std::size_t i = 0; i < next_.size(); ++i) next_[i].weight = weight_[i];
  std::swap(histories_, next_);
  return Numerics::kOk;
}

Numerics MarginalFilter::weigh(std::span<const double> of_mode) {
  log_weight_.clear();
  for (const WeightedGaussian& history : histories_) {
    log_weight_.push_back(std::log(history.weight * of_mode[static_cast<std::size_t>(history.mode)]));
  }
  if (const Numerics weights = normalise(log_weight_, weight_); weights != Numerics::kOk) return weights;
  for (std::size_t i = 0; i < histories_.size(); ++i) histories_[i].weight = weight_[i];
  return Numerics::kOk;
}

void MarginalFilter::resample() {
  weight_.clear();
  for (const WeightedGaussian& history : histories_) weight_.push_back(history.weight);
  resample_optimally(weight_, particles_, stream_, survivors_);
  double sum = 0.0;
  for (const double weight : survivors_.weight) sum += weight;
  next_.clear();
  for (std::size_t k = 0; k < survivors_.index.size(); ++k) {
    next_.push_back(histories_[survivors_.index[k]]);
    next_.back().weight = survivors_.weight[k] / sum;
  }
  std::swap(histories_, next_);
}

}  // namespace dwell
