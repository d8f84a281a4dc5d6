#include "bandit/restless/joint_search.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "bandit/restless/bound.hpp"
#include "tests/bandit/restless/instances.hpp"

namespace dwell::restless::testing {
namespace {

/// The definition, one look a scan, by recursion over whole joint states: nothing shared, nothing kept.
struct Enumeration {
  const Problem& problem;
  const Priced& priced;
  bool closed;

  double value(const std::vector<Matrix>& p, int depth) const {
    if (depth == 0) {
      double sum = 0.0;
      for (std::size_t i = 0; closed && i < p.size(); ++i) sum += priced.values[i].value(p[i]);
      return sum;
    }
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < p.size(); ++i) {
      for (std::size_t s = 0; s < problem.arms[i].sensors.size(); ++s) {
        best = std::min(best, with(p, Look{i, s}, depth));
      }
    }
    return best;
  }

  double scan(const std::vector<Matrix>& p, const std::optional<std::size_t>& seen, const Sensor* sensor,
              int depth) const {
    std::vector<Matrix> next;
    double cost = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Matrix after = seen == i ? look_update(*sensor, p[i]).covariance : p[i];
      cost += scan_cost(problem.arms[i], after);
      next.push_back(predict(problem.arms[i], after));
    }
    return cost + problem.discount_or_one() * value(next, depth - 1);
  }

  double with(const std::vector<Matrix>& p, const Look& look, int depth) const {
    const Arm& arm = problem.arms[look.arm];
    const Sensor& sensor = arm.sensors[look.sensor];
    const double price = closed ? priced.price * arm.dwell : 0.0;
    return price + sensor.p_detect * scan(p, look.arm, &sensor, depth) +
           (1.0 - sensor.p_detect) * scan(p, std::nullopt, nullptr, depth);
  }
};

/// Three depths, with and without a closure, sensors that miss. Sums of the same terms in another order: rounding.
TEST(JointSearch, EqualsEnumeration) {
  Problem problem = scalars({0.3, 1}, {3, 0.05}, {0.5, 4});
  problem.discount = 0.9;
  problem.arms[0].sensors.push_back({Matrix::Ones(1, 1), Matrix::Constant(1, 1, 0.2), 0.6});
  problem.arms[1].sensors[0].p_detect = 0.8;
  problem.arms[1].dwell = 2.0;
  const Priced priced = analyse(problem).priced;
  const std::vector<Matrix> p = {Matrix::Constant(1, 1, 2.0), Matrix::Constant(1, 1, 1.5)};
  for (const bool closed : {false, true}) {
    std::vector<Closure> closures(2);
    for (std::size_t i = 0; closed && i < 2; ++i) closures[i].value = &priced.values[i];
    for (const int depth : {1, 2, 3}) {
      JointSearch search(problem, closures, closed ? priced.price : 0.0, depth);
      std::vector<std::vector<double>> gains;
      search.gains(p, {}, gains);
      const Enumeration all{problem, priced, closed};
      const double idle = all.scan(p, std::nullopt, nullptr, depth);
      for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t s = 0; s < problem.arms[i].sensors.size(); ++s) {
          EXPECT_NEAR(gains[i][s], idle - all.with(p, {i, s}, depth), 1e-12 * idle) << depth << " " << closed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace dwell::restless::testing
