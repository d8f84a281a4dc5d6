// The expected cost against the oracle, and the oracle against Monte Carlo, at the counts of the published
// figures.

#include "tests/bandit/expected_cost_accuracy.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

TEST(SoakExpectedCost, AgreesWithTheOracleInClosedLoops) {
  expect_accurate("closed loops", closed_loop_states(scaled(20), 11));
}

TEST(SoakExpectedCost, AgreesWithTheOracleOverWideRanges) {
  expect_accurate("wide ranges", random_states(scaled(20000), 12));
}

TEST(SoakExpectedCost, OracleAgreesWithMonteCarlo) {
  expect_confirmed(sample(closed_loop_states(2, 13), 24), scaled(400000));
  expect_confirmed(random_states(24, 14), scaled(400000));
}

/// Twice the nodes change the oracle by less than a fiftieth of the tightest limit.
TEST(SoakExpectedCost, OracleHasConverged) {
  for (const PredictedState& state : random_states(scaled(1000), 12)) {
    const CostParts coarse = oracle_parts(state);
    const CostParts fine = oracle_parts(state, 120);
    const CostParts without = cost_parts(state.estimate);
    for (const double CostParts::*part : {&CostParts::position, &CostParts::full, &CostParts::mode}) {
      EXPECT_NEAR(coarse.*part, fine.*part, 1e-4 * without.*part) << state.origin;
    }
  }
}

}  // namespace
}  // namespace dwell::testing
