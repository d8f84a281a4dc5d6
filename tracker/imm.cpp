#include "tracker/imm.hpp"

#include <algorithm>
#include <cmath>

#include "radar/assert.hpp"
#include "tracker/unlike_modes.hpp"

namespace dwell {
namespace {

/// The moment-matched Gaussian of the modes with weights w(i) summing to one.
template <class Weight>
Gaussian moment_match(const std::vector<Gaussian>& modes, const Weight& weight) {
  Gaussian matched;
  for (std::size_t i = 0; i < modes.size(); ++i) matched.mean += weight(i) * modes[i].mean;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const State spread = modes[i].mean - matched.mean;
    matched.covariance += weight(i) * (modes[i].covariance + spread * spread.transpose());
  }
  return matched;
}

}  // namespace

ImmEstimate make_estimate(const Gaussian& belief, const Eigen::VectorXd& probability) {
  return {std::vector<Gaussian>(static_cast<std::size_t>(probability.size()), belief), probability};
}

Numerics predict(const DiscreteBank& bank, const ImmEstimate& estimate, ImmEstimate& predicted) {
  const int count = estimate.size();
  DWELL_ASSERT(bank.size() == count && &estimate != &predicted);
  predicted.modes.resize(estimate.modes.size());
  predicted.probability.resize(count);
  Eigen::MatrixXd guarded;
  if (!bank.guards.empty()) {
    if (!std::all_of(estimate.modes.begin(), estimate.modes.end(), is_finite)) return Numerics::kNotFinite;
    guarded = transition_at(bank, estimate.modes);
  }
  const Eigen::MatrixXd& transition = bank.guards.empty() ? bank.transition : guarded;
  if (!bank.trailing.empty()) return predict_unlike(bank, transition, estimate, predicted);
  for (int j = 0; j < count; ++j) {
    const double c = estimate.probability.dot(transition.col(j));
    const auto weight = [&](std::size_t i) {
      const auto index = static_cast<Eigen::Index>(i);
      return estimate.probability[index] * transition(index, j) / c;
    };
    const Gaussian mixed = c > 0.0 ? moment_match(estimate.modes, weight) : estimate.modes[j];
    const StateMatrix& f = bank.f[j];
    Gaussian& mode = predicted.modes[j];
    mode.mean = f * mixed.mean;
    mode.covariance = symmetric_part(f * mixed.covariance * f.transpose() + bank.q[j]);
    predicted.probability[j] = c;
    if (!is_finite(mode) || !std::isfinite(c)) return Numerics::kNotFinite;
  }
  return Numerics::kOk;
}

Numerics update(std::span<const PredictedMeasurement> predicted, std::span<const Vector2> innovation,
                ImmEstimate& estimate) {
  constexpr int kMostOnStack = 16;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostOnStack, 1>;
  const int count = estimate.size();
  DWELL_ASSERT(std::ssize(predicted) == count && std::ssize(innovation) == count && count <= kMostOnStack);
  Weights log_weight(count);
  for (int j = 0; j < count; ++j) {
    if (!innovation[j].allFinite()) return Numerics::kNotFinite;
    log_weight[j] = std::log(estimate.probability[j]) + predicted[j].log_likelihood(innovation[j]);
  }
  const double largest = log_weight.maxCoeff<Eigen::PropagateNaN>();
  if (!std::isfinite(largest)) return Numerics::kNotFinite;
  // Element by element: the vectorised exponential of Eigen gives an impossible mode the least number, not zero.
  const Weights weight = log_weight.unaryExpr([&](double value) { return std::exp(value - largest); });
  const double sum = weight.sum();
  for (int j = 0; j < count; ++j) {
    estimate.modes[j] = kalman_update(estimate.modes[j], predicted[j], innovation[j]);
    estimate.probability[j] = weight[j] / sum;
  }
  return Numerics::kOk;
}

Gaussian combine(const ImmEstimate& estimate) {
  return moment_match(estimate.modes,
                      [&](std::size_t i) { return estimate.probability[static_cast<Eigen::Index>(i)]; });
}

State combined_mean(const ImmEstimate& estimate) {
  State mean = State::Zero();
  for (int j = 0; j < estimate.size(); ++j) mean += estimate.probability[j] * estimate.modes[j].mean;
  return mean;
}

}  // namespace dwell
