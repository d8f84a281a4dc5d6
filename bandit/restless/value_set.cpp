#include "bandit/restless/value_set.hpp"

#include <algorithm>
#include <limits>

#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

/// Values of plans that are evaluated side by side: two of these.
using Lanes = double __attribute__((vector_size(64), aligned(8), may_alias));
constexpr Eigen::Index kLanes = 16;

/// min over the plans of c + sum_i p_i l_i, in that order whatever the width of the registers: products and sums are
/// rounded one by one (this file is compiled without contraction), so every processor gives the same bits.
[[gnu::target_clones("avx512f", "avx2", "default")]] double least_plan(const double* block, Eigen::Index blocks,
                                                                       const double* p, Eigen::Index size) {
  const auto* lanes = reinterpret_cast<const Lanes*>(block);
  Lanes least_low = std::numeric_limits<double>::infinity() - Lanes{};
  Lanes least_high = least_low;
  for (; blocks > 0; --blocks) {
    Lanes low = *lanes++, high = *lanes++;
    for (Eigen::Index i = 0; i < size; ++i) {
      low += p[i] * *lanes++;
      high += p[i] * *lanes++;
    }
    least_low = low < least_low ? low : least_low;
    least_high = high < least_high ? high : least_high;
  }
  const Lanes least = least_low < least_high ? least_low : least_high;
  double smallest = least[0];
  for (int k = 1; k < 8; ++k) smallest = std::min(smallest, least[k]);
  return smallest;
}

}  // namespace

ValueSet::ValueSet(Eigen::MatrixXd weights, Eigen::VectorXd constants)
    : weights_(std::move(weights)), constants_(std::move(constants)) {
  DWELL_ASSERT(weights_.cols() == constants_.size() && constants_.size() > 0);
  const Eigen::Index rows = weights_.rows() + 1;
  const Eigen::Index blocks = (plans() + kLanes - 1) / kLanes;
  blocks_.assign(static_cast<std::size_t>(blocks * rows * kLanes), 0.0);
  for (Eigen::Index k = 0; k < blocks * kLanes; ++k) {
    double* lane = blocks_.data() + (k / kLanes) * rows * kLanes + k % kLanes;
    lane[0] = k < plans() ? constants_[k] : std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 1; k < plans() && i < rows; ++i) lane[i * kLanes] = weights_(i - 1, k);
  }
}

double ValueSet::value(const Packed& p) const {
  const auto blocks = static_cast<Eigen::Index>(blocks_.size()) / ((p.size() + 1) * kLanes);
  return least_plan(blocks_.data(), blocks, p.data(), p.size());
}

Eigen::Index ValueSet::best_plan(const Packed& p) const {
  Eigen::Index best = 0;
  (weights_.transpose() * p + constants_).minCoeff(&best);
  return best;
}

double idle_cost(const Arm& arm, const ValueSet& value, double discount, const Matrix& predicted) {
  return scan_cost(arm, predicted) + discount * value.value(predict(arm, predicted));
}

double look_cost(const Arm& arm, std::size_t sensor, const ValueSet& value, double discount, double price,
                 const Matrix& predicted, double idle) {
  const Sensor& with = arm.sensors[sensor];
  const Matrix after = look_update(with, predicted).covariance;
  const double seen = scan_cost(arm, after) + discount * value.value(predict(arm, after));
  return with.p_detect * seen + (1.0 - with.p_detect) * idle + price * arm.dwell;
}

}  // namespace dwell::restless
