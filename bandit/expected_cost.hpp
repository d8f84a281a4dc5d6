#pragma once

#include <vector>

#include "bandit/overlap_rule.hpp"
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
/// With c_j the predicted mode probabilities, N_j the predicted densities of a plot y, and w_j(y), x_j(y),
/// P_j the probabilities, means and covariances after it:
///
///   E cost = sum_j c_j tr(W P_j)
///          + sum_{i<j} c_a E_{y ~ N_a}[ w_b(y) (|x_i(y) - x_j(y)|_W^2 + 2 beta) ]
///
/// where (a, b) is the pair (i, j) in either order.
/// The first sum is exact. The second is taken apart once more, so that a narrow mode's structure stays out
/// of the integrals of two wide ones. With the modes sorted by |S|, the smallest first, and w_b among the
/// modes from a on, pi_j = w_j / sum_{k>a} w_k the probabilities and x_>a = sum_{j>a} pi_j x_j the mean among
/// those after a, it equals
///
///   sum_{a<b} c_a E_{y ~ N_a}[ w_b (|x_a - x_>a|_W^2 + beta (1 + sum_{j>a} pi_j^2)) ],
///
/// and c_a N_a w_b is shaped like the overlap of modes a and b: each term by OverlapRule with `nodes` on a
/// ray. Worst error as a part of the cost without a look, over 22 400 states of closed loops and of wide
/// ranges (the soak tests of tests/bandit; modes 0 .. 10 sigma apart, |S| ratios to 1e4, probabilities down
/// to 1e-4):
///
///   nodes    W alone    W and beta 1    beta alone    beta alone, closed loops
///     5       0.8 %        1.4 %          1.9 %             0.4 %
///    10       0.1 %        0.1 %          0.2 %             0.02 %
///
/// The look leaves the cost without a look with probability 1 - P_d F, F the probability that the target is in
/// the footprint (tracker/footprint.hpp); what it measures is taken to be independent of that. No gate is
/// accounted for. Where the sensor has clutter, q2(P_d F, false plots in the gate) takes the place of P_d F
/// (bandit/information_reduction.hpp): of one mode the modified Riccati step of SA-IPDA; of more, with q2 the mean over
/// the modes and for the spread between them too, an approximation.
///
/// Cost     O(nodes^2 M^3), no allocation after the first call for M modes.
/// Source   Evans et al. (2005), (18)-(20); the pairwise form: w_i w_j p(y) = c_a N_a(y) w_b(y), and
///          1 - mu'mu = 2 sum_{i<j} mu_i mu_j; the second form: the spread among modes a, a+1, .. is that
///          between a and the rest, w_a (1 - w_a) |x_a - x_>a|^2, plus 1 - w_a times that within the rest,
///          mode by mode.
class ExpectedCost {
 public:
  ExpectedCost(const CostWeights& weights, int nodes);

  /// Of the predicted estimate as it stands.
  double without_look(const ImmEstimate& predicted) const;

  /// After a look. Errors: kNotPositiveDefinite, kNotFinite; `cost` is then unchanged.
  Numerics with_look(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form, double& cost);

 private:
  struct ModePosterior {
    double log_determinant;  // log |S_j|
    WeightedNormal plot;     // c_j N_j(y)
    State constant;          // W^1/2 (x_j(y) - x_1) = constant + slope y, x_1 the first mode's predicted mean
    Gain slope;
  };
  double kept_information(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form, const State& pointing,
                          double p_d) const;
  double within_modes(const ImmEstimate& predicted, const Sensor& sensor, UpdateForm form);
  double between_modes();
  double integrand(std::size_t a, std::size_t b, const Vector2& y) const;

  CostWeights weights_;
  StateMatrix root_;  // W^1/2
  OverlapRule rule_;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<ModePosterior> posteriors_;  // of the modes with c_j > 0, the smallest |S| first
};

}  // namespace dwell
