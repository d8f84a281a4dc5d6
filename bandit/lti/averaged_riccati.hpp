#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "bandit/lti/riccati.hpp"

namespace dwell::lti {

/// The covariance that choosing sensors at random cannot exceed in the mean, in the steady state.
///
/// With sensor i chosen with probability q_i in every step, independently, and F_i its Riccati step,
///
///   E P[k+1] <= sum_i q_i F_i(E P[k])        since F_i is concave (Jensen) and the choice is independent of P[k]
///
/// and by monotony E P[k] stays below X[k+1] = sum_i q_i F_i(X[k]), X[0] >= P[0]. Its limit X(q) is the largest fixed
/// point; it exists if A is stable, or if q gives the unstable modes enough looks.
///
/// Found by Newton's method, whose steps are the Lyapunov equations of the current gains, once the gains are
/// stabilising in mean square: the map Y -> sum_i q_i f_i Y f_i' has a spectral radius under one exactly where
/// Y - sum_i q_i f_i Y f_i' = I has a positive definite solution. Plain steps from above until then.
/// Gradient: d tr X / d q_i = tr(L F_i(X)) with L = I + sum_i q_i f_i' L f_i.
///
/// Source  Gupta et al. (2004), (3); Sinopoli et al. (2004) for the fixed point.
class AveragedRiccati {
 public:
  /// With A multiplied by `a_scale` (see optimal_probabilities).
  AveragedRiccati(const Problem& problem, double a_scale);

  struct FixedPoint {
    double trace;              ///< tr X, summed over blocks
    Eigen::VectorXd gradient;  ///< d trace / d q
  };
  /// Empty where there is none, or none below kLargest times the start.
  std::optional<FixedPoint> fixed_point(const Eigen::VectorXd& q);
  std::uint64_t steps() const { return riccati_.steps(); }

 private:
  struct Average;  // of the steps of one block from X
  Average average(int block, const Matrix& x, const Eigen::VectorXd& q);
  std::optional<Matrix> solve_block(int block, const Eigen::VectorXd& q);

  Riccati riccati_;
  Matrix start_;
  std::vector<Matrix> last_;  // fixed points of the last q: where the next search starts
};

struct Probabilities {
  Eigen::VectorXd q;
  std::optional<double> bound;  ///< tr X(q)
  std::uint64_t steps = 0;      ///< Riccati steps taken
};

/// Of the uniform choice.
Probabilities uniform_probabilities(const Problem& problem);

/// The probabilities of the least bound, by descent from the middle of the simplex and from near each corner (whether
/// tr X(q) is convex we do not know). Where the middle has no fixed point, A is scaled down until it has one and back
/// up as the descent allows; where that does not reach A itself the probabilities are uniform and there is no bound.
Probabilities optimal_probabilities(const Problem& problem);

}  // namespace dwell::lti
