#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "tests/bandit/expected_cost_oracle.hpp"

namespace dwell::testing {

/// A rule's largest error allowed, as a part of the cost without a look.
struct AccuracyLimit {
  int nodes;
  double error;
};
inline constexpr AccuracyLimit kAccuracyLimits[] = {{5, 0.02}, {10, 0.005}};

/// Holds ExpectedCost against the oracle, and prints the distribution of its error for every kind of cost.
inline void expect_accurate(const char* what, const std::vector<PredictedState>& states) {
  std::vector<CostParts> expected;
  std::vector<CostParts> without;
  for (const PredictedState& state : states) {
    expected.push_back(oracle_parts(state));
    without.push_back(cost_parts(state.estimate));
  }
  for (const AccuracyLimit& limit : kAccuracyLimits) {
    for (const CostKind& kind : kCostKinds) {
      ExpectedCost expected_cost(kind.weights(), limit.nodes);
      std::vector<double> errors;
      for (std::size_t i = 0; i < states.size(); ++i) {
        double cost = 0.0;
        ASSERT_EQ(expected_cost.with_look(states[i].estimate, *states[i].sensor, states[i].update, cost),
                  Numerics::kOk);
        errors.push_back(std::abs(cost - kind.of(expected[i])) / kind.of(without[i]));
        EXPECT_LE(errors.back(), limit.error) << what << ", state " << i << ", " << kind.name << ", " << limit.nodes;
      }
      std::sort(errors.begin(), errors.end());
      std::printf("%-12s %5zu states, %2d nodes, %-16s error: median %.1e  p95 %.1e  max %.1e\n", what, states.size(),
                  limit.nodes, kind.name, errors[errors.size() / 2], errors[errors.size() * 95 / 100], errors.back());
    }
  }
}

/// Holds the oracle against Monte Carlo, every part of the cost within 4.5 standard errors: 7e-6 false alarms
/// each.
inline void expect_confirmed(const std::vector<PredictedState>& states, int draws) {
  constexpr double kStandardErrors = 4.5;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const CostParts oracle = oracle_parts(states[i]);
    const MonteCarlo drawn = monte_carlo_parts(states[i], draws, RandomStream(5).fork(i));
    for (const double CostParts::*part : {&CostParts::position, &CostParts::full, &CostParts::mode}) {
      EXPECT_NEAR(oracle.*part, drawn.mean.*part, kStandardErrors * drawn.standard_error.*part)
          << "state " << i << ", " << states[i].origin;
    }
  }
}

/// `count` of the states, evenly spaced.
inline std::vector<PredictedState> sample(const std::vector<PredictedState>& states, std::size_t count) {
  std::vector<PredictedState> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(states[i * states.size() / count]);
  return some;
}

}  // namespace dwell::testing
