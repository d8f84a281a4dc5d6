#pragma once

#include <span>
#include <vector>

#include "bandit/predicted_paths.hpp"

namespace dwell {

/// What choosing pairs at random cannot exceed in the mean, on the tracks' predicted paths.
///
/// With pair i chosen with probability q_i in every scan, independently of what was chosen before, and L_i the map of
/// its look on the covariances of its track,
///
///   X <- (1 - sum_i q_i) X + sum_i q_i L_i(X) for the pairs i of a track,  then the prediction,
///
/// stays above the mean of the covariances, since L_i is concave (Jensen). Bound: the sum over the scans of the paths
/// and over tracks of weight sum_j c_j tr(W X_j) after each scan. Gradient in q by the adjoint of the same steps: a
/// look moves with its covariance as dL = p (I - K H) dX (I - K H)' + (1 - p) dX, since the gain is the best one.
///
/// Tracks without a feasible pair are left out: no q changes what they cost.
///
/// Cost    O(scans pairs modes n^3), no allocation once the stores have grown.
///
/// Source  Gupta et al. (2004), (3), of a finite horizon; lti/averaged_riccati is that of the steady state.
class AveragedPaths {
 public:
  /// `pairs` in the order of their tracks, q beside them; the paths are laid.
  double bound(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q,
               std::span<double> gradient);

 private:
  double forward(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q);
  void backward(const PredictedPaths& paths, std::span<const Pair> pairs, std::span<const double> q,
                std::span<double> gradient);

  std::vector<StateMatrix> before_;   // [scan][mode]: X before the look
  std::vector<StateMatrix> after_;    // [mode]
  std::vector<StateMatrix> seen_;     // [scan][pair of the track][mode]: L_i(X)
  std::vector<StateMatrix> rest_;     // likewise: I - K H
  std::vector<StateMatrix> adjoint_;  // [mode]: of X after the look
  std::vector<StateMatrix> carried_;  // [mode]
};

}  // namespace dwell
