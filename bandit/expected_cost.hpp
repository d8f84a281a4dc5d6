#pragma once

#include <vector>

#include "bandit/gauss_hermite.hpp"
#include "tracker/measurement.hpp"

namespace dwell {

/// cost = tr(W P) + beta (1 - mu'mu) of an IMM estimate, P and mu of the combined estimate.
struct CostWeights {
  StateMatrix w = StateMatrix::Zero();  ///< W, symmetric and positive semidefinite
  double beta = 0.0;                    ///< weight of not knowing the mode, >= 0
};

/// Selects x and y: tr(W P) in m^2.
StateMatrix position_weight();

/// The cost that a look is expected to leave, over everything that the look may measure.
///
/// With c_j the predicted mode probabilities, and w_j(y), x_j(y), P_j the probabilities, means and covariances after
/// a plot y:
///
///   E cost = sum_j c_j tr(W P_j)
///          + sum_{i<j} c_a E_{y ~ N_a}[ w_b(y) (|x_i(y) - x_j(y)|_W^2 + 2 beta) ]
///
/// where (a, b) is the pair (i, j) with the smaller |S| first: under the narrower density the integrand is smooth. The
/// first sum is exact. E_{N_a} is by Gauss-Hermite quadrature with `nodes` on each axis: with 5 the error is at most
/// 2 % of the cost without a look, with 10 at most 0.5 %, over the states of tests/bandit/expected_cost_test.cpp.
/// With P_d < 1 the look leaves the cost without a look with probability 1 - P_d. A gate is not accounted for.
///
/// Cost     O(nodes^2 M^2), no allocation after the first call for M modes.
/// Source   Evans et al. (2005), (18)-(20); the pairwise form: w_i w_j p(y) = c_a N_a(y) w_b(y), and
///          1 - mu'mu = 2 sum_{i<j} mu_i mu_j.
class ExpectedCost {
 public:
  ExpectedCost(const CostWeights& weights, int nodes);

  /// Of the predicted estimate as it stands.
  double without_look(const ImmEstimate& predicted) const;

  /// After a look. Errors: kNotPositiveDefinite, kNotFinite; `cost` is then unchanged.
  Numerics with_look(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form, double& cost);

 private:
  struct ModePosterior {
    Gain gain;             // K_j
    Matrix2 information;   // S_j^-1
    double log_weight;     // log c_j - log |S_j| / 2
    double log_determinant;
  };
  /// |x_a(y) - x_b(y)|_W^2 as a quadratic in nu = y - z_a.
  struct Spread {
    double constant;
    Vector2 linear;
    Matrix2 quadratic;
  };
  double within_modes(const ImmEstimate& predicted);
  double between_modes(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form);
  double pairs_of(std::size_t first);
  Spread spread(const ImmEstimate& predicted, std::size_t a, std::size_t b) const;

  CostWeights weights_;
  std::vector<QuadratureNode> nodes_;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<ModePosterior> posteriors_;
  std::vector<std::size_t> by_determinant_;  // modes, smallest |S| first
  std::vector<Vector2> offsets_;             // z_a - z_k
  std::vector<Spread> spreads_;
  std::vector<double> log_density_;
};

}  // namespace dwell
