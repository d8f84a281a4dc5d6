#include "tests/bandit/expected_cost_oracle.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "radar/assert.hpp"
#include "radar/jump_markov_trajectory.hpp"

namespace dwell::testing {
namespace {

std::vector<PredictedMeasurement> measurements(const PredictedState& state) {
  std::vector<PredictedMeasurement> out;
  DWELL_ASSERT(predict_measurements(*state.sensor, state.update, state.estimate, out) == Numerics::kOk);
  return out;
}

void add(CostParts& to, double weight, const CostParts& parts) {
  to.position += weight * parts.position;
  to.full += weight * parts.full;
  to.mode += weight * parts.mode;
}

/// One mode seen in the measurement's space, from a common origin.
struct Seen {
  Vector2 z;
  Matrix2 s;
  Matrix2 information;
  double scale;  // c / (2 pi sqrt |S|)
  State mean;
  Gain gain;

  double density(const Vector2& y) const { return scale * std::exp(-0.5 * (y - z).dot(information * (y - z))); }
  State posterior(const Vector2& y) const { return mean + gain * (y - z); }
};

/// f(y, dy) for every cell of the grid of modes a and b.
template <class Function>
void for_each_cell(const std::vector<Seen>& modes, const Seen& a, const Seen& b, int nodes, Function f) {
  constexpr double kSigmas = 9.0;
  constexpr double kMostRefined = 10.0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix2> joint(b.s,
                                                                a.s);  // V' S_a V = I, V' S_b V = diag(d)
  const Matrix2 to_joint = joint.eigenvectors().transpose();
  const Matrix2 from_joint = to_joint.inverse();
  const Vector2 z_a = to_joint * a.z;
  const Vector2 z_b = to_joint * b.z;
  const Vector2 sigma_b = joint.eigenvalues().cwiseSqrt();
  const Vector2 low = (z_a.array() - kSigmas).cwiseMax(z_b.array() - kSigmas * sigma_b.array());
  const Vector2 high = (z_a.array() + kSigmas).cwiseMin(z_b.array() + kSigmas * sigma_b.array());
  if ((high - low).minCoeff() <= 0.0) return;
  Eigen::Vector2i count;
  for (int axis = 0; axis < 2; ++axis) {
    double finest = 1.0;  // the most nodes on 18 sigma of any mode along this axis
    for (const Seen& mode : modes) {
      const Vector2 step = from_joint.col(axis);
      const double sigma = 1.0 / std::sqrt(step.dot(mode.information * step));
      finest = std::max(finest, (high - low)[axis] / (2.0 * kSigmas * sigma));
    }
    count[axis] = static_cast<int>(nodes * std::min(finest, kMostRefined));
  }
  const Vector2 step = (high - low).cwiseQuotient(count.cast<double>());
  const double area = step.prod() * std::abs(from_joint.determinant());
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) f(from_joint * (low + step.cwiseProduct(Vector2(i + 0.5, j + 0.5))), area);
  }
}

}  // namespace

CostWeights CostKind::weights() const {
  CostWeights weights;
  if (trace == &CostParts::position) weights.w = position_weight();
  if (trace == &CostParts::full) weights.w.setIdentity();
  weights.beta = beta;
  return weights;
}

CostParts cost_parts(const ImmEstimate& estimate) {
  State mean = State::Zero();
  for (int j = 0; j < estimate.size(); ++j) mean += estimate.probability[j] * estimate.modes[j].mean;
  CostParts parts;
  parts.mode = 1.0;
  for (int j = 0; j < estimate.size(); ++j) {
    const double mu = estimate.probability[j];
    const State e = estimate.modes[j].mean - mean;
    const StateMatrix& p = estimate.modes[j].covariance;
    add(parts, mu, {position_block(p).trace() + position(e).squaredNorm(), p.trace() + e.squaredNorm(), -mu});
  }
  return parts;
}

CostParts oracle_parts(const PredictedState& state, int nodes) {
  const ImmEstimate& estimate = state.estimate;
  const auto predicted = measurements(state);
  std::vector<Seen> modes;
  CostParts detected;
  for (std::size_t j = 0; j < predicted.size(); ++j) {
    const double c = estimate.probability[static_cast<Eigen::Index>(j)];
    const Matrix2& s = predicted[j].s;
    const StateMatrix& p = estimate.modes[j].covariance;
    const Gain gain = p * predicted[j].h.transpose() * s.inverse();
    modes.push_back({innovation(*state.sensor, state.update, predicted[j].z, predicted[0].z), s, s.inverse(),
                     c / (2.0 * std::numbers::pi * std::sqrt(s.determinant())), estimate.modes[j].mean, gain});
    const StateMatrix after = p - gain * s * gain.transpose();
    add(detected, c, {position_block(after).trace(), after.trace(), 0.0});
  }
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = i + 1; j < modes.size(); ++j) {
      for_each_cell(modes, modes[i], modes[j], nodes, [&](const Vector2& y, double area) {
        double all = 0.0;
        for (const Seen& mode : modes) all += mode.density(y);
        if (all == 0.0) return;
        const State e = modes[i].posterior(y) - modes[j].posterior(y);
        add(detected, modes[i].density(y) * modes[j].density(y) / all * area,
            {position(e).squaredNorm(), e.squaredNorm(), 2.0});
      });
    }
  }
  const double p_d = state.sensor->detection_probability(combined_mean(estimate));
  CostParts expected;
  add(expected, p_d, detected);
  add(expected, 1.0 - p_d, cost_parts(estimate));
  return expected;
}

MonteCarlo monte_carlo_parts(const PredictedState& state, int draws, RandomStream stream) {
  const auto predicted = measurements(state);
  const double p_d = state.sensor->detection_probability(combined_mean(state.estimate));
  std::vector<Vector2> innovations(predicted.size());
  CostParts sum;
  CostParts squares;
  ImmEstimate after;
  for (int i = 0; i < draws; ++i) {
    after = state.estimate;
    if (stream.uniform() < p_d) {
      const auto mode = static_cast<std::size_t>(draw_index(state.estimate.probability.transpose(), stream));
      const double first = stream.normal();
      const double second = stream.normal();
      const Vector2 nu = predicted[mode].s_root.matrixL() * Vector2(first, second);
      for (std::size_t j = 0; j < predicted.size(); ++j) {
        innovations[j] = nu + innovation(*state.sensor, state.update, predicted[mode].z, predicted[j].z);
      }
      DWELL_ASSERT(update(predicted, innovations, after) == Numerics::kOk);
    }
    const CostParts cost = cost_parts(after);
    add(sum, 1.0, cost);
    add(squares, 1.0, {cost.position * cost.position, cost.full * cost.full, cost.mode * cost.mode});
  }
  MonteCarlo result;
  for (double CostParts::*part : {&CostParts::position, &CostParts::full, &CostParts::mode}) {
    const double mean = sum.*part / draws;
    result.mean.*part = mean;
    result.standard_error.*part = std::sqrt(std::max(0.0, squares.*part / draws - mean * mean) / draws);
  }
  return result;
}

}  // namespace dwell::testing
