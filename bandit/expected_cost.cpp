#include "bandit/expected_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dwell {

StateMatrix position_weight() {
  const auto h = position_selector();
  return h.transpose() * h;
}

ExpectedCost::ExpectedCost(const CostWeights& weights, int nodes) : weights_(weights), nodes_(gauss_hermite(nodes)) {}

double ExpectedCost::without_look(const ImmEstimate& predicted) const {
  const Gaussian combined = combine(predicted);
  return weights_.w.cwiseProduct(combined.covariance).sum() +
         weights_.beta * (1.0 - predicted.probability.squaredNorm());
}

Numerics ExpectedCost::with_look(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form, double& cost) {
  const Numerics numerics = predict_measurements(sensor, form, predicted, measurements_);
  if (numerics != Numerics::kOk) return numerics;
  const double detected = within_modes(predicted) + between_modes(predicted, sensor, form);
  const double p_d = sensor.detection_probability(combined_mean(predicted));
  const double expected = p_d * detected + (1.0 - p_d) * without_look(predicted);
  if (!std::isfinite(expected)) return Numerics::kNotFinite;
  cost = expected;
  return Numerics::kOk;
}

/// sum_j c_j tr(W P_j), and each mode's posterior on the way.
double ExpectedCost::within_modes(const ImmEstimate& predicted) {
  posteriors_.resize(measurements_.size());
  double sum = 0.0;
  for (std::size_t j = 0; j < measurements_.size(); ++j) {
    const StateMatrix& prior = predicted.modes[j].covariance;
    ModePosterior& posterior = posteriors_[j];
    posterior.gain = kalman_gain(prior, measurements_[j]);
    posterior.information = measurements_[j].s_root.solve(Matrix2::Identity());
    posterior.log_determinant = measurements_[j].log_determinant();
    posterior.log_weight = std::log(predicted.probability[j]) - 0.5 * posterior.log_determinant;
    const StateMatrix after = updated_covariance(prior, measurements_[j], posterior.gain);
    sum += predicted.probability[j] * weights_.w.cwiseProduct(after).sum();
  }
  return sum;
}

/// sum over pairs of modes of c_a E_{N_a}[ w_b (|x_a - x_b|_W^2 + 2 beta) ].
double ExpectedCost::between_modes(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form) {
  by_determinant_.resize(posteriors_.size());
  std::iota(by_determinant_.begin(), by_determinant_.end(), std::size_t{0});
  std::sort(by_determinant_.begin(), by_determinant_.end(), [&](std::size_t i, std::size_t j) {
    return posteriors_[i].log_determinant < posteriors_[j].log_determinant;
  });
  offsets_.resize(posteriors_.size());
  spreads_.resize(posteriors_.size());
  log_density_.resize(posteriors_.size());
  double sum = 0.0;
  for (std::size_t first = 0; first + 1 < by_determinant_.size(); ++first) {
    const std::size_t a = by_determinant_[first];
    if (predicted.probability[a] == 0.0) continue;
    for (std::size_t k = 0; k < posteriors_.size(); ++k) {
      offsets_[k] = innovation(sensor, form, measurements_[a].z, measurements_[k].z);
      spreads_[k] = spread(predicted, a, k);
    }
    sum += predicted.probability[a] * pairs_of(first);
  }
  return sum;
}

/// E_{N_a} of the pairs of mode a = by_determinant_[first] with all wider modes.
double ExpectedCost::pairs_of(std::size_t first) {
  const std::size_t a = by_determinant_[first];
  const Matrix2 root = measurements_[a].s_root.matrixL();
  double sum = 0.0;
  for (const QuadratureNode& node_u : nodes_) {
    for (const QuadratureNode& node_v : nodes_) {
      const Vector2 nu = root * Vector2(node_u.u, node_v.u);  // y - z_a
      double largest = -std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < posteriors_.size(); ++k) {
        const Vector2 nu_k = nu + offsets_[k];
        log_density_[k] = posteriors_[k].log_weight - 0.5 * nu_k.dot(posteriors_[k].information * nu_k);
        largest = std::max(largest, log_density_[k]);
      }
      double total = 0.0;
      double wanted = 0.0;
      for (std::size_t place = 0; place < posteriors_.size(); ++place) {
        const std::size_t b = by_determinant_[place];
        const double density = std::exp(log_density_[b] - largest);
        total += density;
        if (place <= first) continue;
        const Spread& s = spreads_[b];
        const double distance = s.constant + nu.dot(2.0 * s.linear + s.quadratic * nu);
        wanted += density * (distance + 2.0 * weights_.beta);
      }
      sum += node_u.weight * node_v.weight * wanted / total;
    }
  }
  return sum;
}

/// x_a(y) - x_b(y) = e + G nu with e = x_a - x_b - K_b (z_a - z_b), G = K_a - K_b.
ExpectedCost::Spread ExpectedCost::spread(const ImmEstimate& predicted, std::size_t a, std::size_t b) const {
  const State e = predicted.modes[a].mean - predicted.modes[b].mean - posteriors_[b].gain * offsets_[b];
  const Gain g = posteriors_[a].gain - posteriors_[b].gain;
  const Gain wg = weights_.w * g;
  return {e.dot(weights_.w * e), wg.transpose() * e, g.transpose() * wg};
}

}  // namespace dwell
