#include "bandit/restless/value_set.hpp"

#include <limits>

#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

/// Plans whose values are kept on the stack at a time.
constexpr Eigen::Index kBlock = 64;

}  // namespace

ValueSet::ValueSet(Eigen::MatrixXd weights, Eigen::VectorXd constants)
    : weights_(std::move(weights)), by_plan_(weights_.transpose()), constants_(std::move(constants)) {
  DWELL_ASSERT(weights_.cols() == constants_.size() && constants_.size() > 0);
}

double ValueSet::value(const Packed& p) const {
  double least = std::numeric_limits<double>::infinity();
  Eigen::Array<double, Eigen::Dynamic, 1, 0, kBlock, 1> sum;
  for (Eigen::Index first = 0; first < plans(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, plans() - first);
    sum = constants_.segment(first, count).array();
    for (Eigen::Index i = 0; i < p.size(); ++i) sum += p[i] * by_plan_.col(i).segment(first, count).array();
    least = std::min(least, sum.minCoeff());
  }
  return least;
}

Eigen::Index ValueSet::best_plan(const Packed& p) const {
  Eigen::Index best = 0;
  (by_plan_ * p + constants_).minCoeff(&best);
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
