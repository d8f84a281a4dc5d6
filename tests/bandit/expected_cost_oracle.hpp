#pragma once

#include "bandit/expected_cost.hpp"
#include "radar/random.hpp"
#include "tests/bandit/predicted_states.hpp"

namespace dwell::testing {

/// The parts of which every cost is made: tr(W P) of the combined estimate for W = position and for W = I, and
/// 1 - mu'mu.
struct CostParts {
  double position = 0.0;
  double full = 0.0;
  double mode = 0.0;
};

/// A cost under test: which trace it has, and beta.
struct CostKind {
  const char* name;
  double CostParts::*trace;  ///< null: none
  double beta;

  CostWeights weights() const;
  double of(const CostParts& parts) const { return (trace ? parts.*trace : 0.0) + beta * parts.mode; }
};

inline constexpr CostKind kCostKinds[] = {{"position, beta 0", &CostParts::position, 0.0},
                                          {"position, beta 1", &CostParts::position, 1.0},
                                          {"full, beta 0", &CostParts::full, 0.0},
                                          {"full, beta 1", &CostParts::full, 1.0},
                                          {"beta 1 alone", nullptr, 1.0}};

/// Of the moment-matched estimate.
CostParts cost_parts(const ImmEstimate& estimate);

/// The expected parts after a look, by the pairwise identity on a grid; shares nothing with ExpectedCost but
/// the tracker's predicted measurements.
///
/// For each pair the plane is whitened by one S and turned so that the other is diagonal; there both
/// densities are products, and outside the intersection of their 9-sigma boxes the integrand is under
/// exp(-40). Inside it the midpoint rule of nodes x nodes: the integrand vanishes at the border with all its
/// derivatives, so that the error falls exponentially with the number of nodes. A third mode that is narrower
/// than the pair digs a hole into the integrand: up to ten times as many nodes on each axis then.
CostParts oracle_parts(const PredictedState& state, int nodes = 60);

struct MonteCarlo {
  CostParts mean;
  CostParts standard_error;
};

/// The same by drawing: whether the look gives a plot, the mode, the plot; then the tracker's `update`.
MonteCarlo monte_carlo_parts(const PredictedState& state, int draws, RandomStream stream);

}  // namespace dwell::testing
