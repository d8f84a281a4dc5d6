#pragma once

#include <span>
#include <vector>

#include "tracker/gaussian.hpp"
#include "tracker/kalman.hpp"
#include "tracker/mode_bank.hpp"

namespace dwell {

/// Belief of an interacting multiple model filter: a Gaussian for each mode and the modes' probabilities (sum one).
struct ImmEstimate {
  std::vector<Gaussian> modes;
  Eigen::VectorXd probability;
  /// Of each mode, where the bank has modes with trailing states; no elements before the first prediction. Updates do
  /// not touch them: tracker/trailing_states.hpp says why.
  std::vector<Trailing> trailing{};

  int size() const { return static_cast<int>(modes.size()); }
};

/// Every mode at the same Gaussian.
ImmEstimate make_estimate(const Gaussian& belief, const Eigen::VectorXd& probability);

/// Mixes the mode-conditioned estimates and moves each on by its mode (IMM, steps 1 and 2a).
///
///   c_j  = sum_i mu_i Pi_ij                        mu_i|j = mu_i Pi_ij / c_j
///   x0_j = sum_i mu_i|j x_i
///   P0_j = sum_i mu_i|j (P_i + (x_i - x0_j)(x_i - x0_j)')
///   x_j  = F_j x0_j                                P_j = F_j P0_j F_j' + Q_j
///
/// `predicted.probability` is c. A mode that cannot be reached (c_j = 0) keeps its own estimate through F_j and Q_j:
/// it weighs nothing. With guards Pi is `transition_at` the estimate. Modes of unlike
/// states: tracker/unlike_modes.hpp.
/// Shapes   M modes each side; `predicted` is given the shape of `estimate` (no allocation when it has it), and must
///          not be the same object.
/// Units    SI, layout of radar/state.hpp.
/// Requires probability >= 0 summing to one; rows of Pi summing to one.
/// Errors   kNotFinite.
/// Cost     O(M^2 n^2 + M n^3), and a Phi_v for each guard, which allocates.
/// Source   Bar-Shalom, Li, Kirubarajan (2001), 11.6.6.
Numerics predict(const DiscreteBank& bank, const ImmEstimate& estimate, ImmEstimate& predicted);

/// Updates each mode with its innovation and the probabilities with the likelihoods (IMM, steps 2b and 3).
///
///   mu_j proportional to c_j N(nu_j; 0, S_j), by log-sum-exp
///
/// `innovation[j]` = z - z_j, bearings the short way round. In place; on an error the estimate is unchanged.
/// Errors   kNotFinite where an innovation is not finite, a likelihood is NaN, or no mode has a finite one.
Numerics update(std::span<const PredictedMeasurement> predicted, std::span<const Vector2> innovation,
                ImmEstimate& estimate);

/// The mixture's mean and covariance, spread of means included (IMM, step 4).
Gaussian combine(const ImmEstimate& estimate);

/// sum_j mu_j x_j alone.
State combined_mean(const ImmEstimate& estimate);

}  // namespace dwell
