#pragma once

#include <vector>

#include "bandit/policy.hpp"

namespace dwell {

/// One track as a restless arm: a single covariance that moves on the path that nothing measured changes.
///
///   mu[k] = mu Pi^k                 modes are a martingale under measurement, so the path stays deterministic
///   x[k]  = sum_j mu_j[k] F_j x[k-1],   k = 0 now, the moment-matched estimate
///   P     -> sum_j mu_j[k] F_j P F_j' + Q[k],   Q[k] = sum_j mu_j[k] (Q_j + d_j d_j'),  d_j = F_j x[k-1] - x[k]
///
/// A sensor sees it at x[k] with H, R and P_d there; a look leaves p M + (1 - p) P in the mean, p = P_d times the
/// probability of the footprint (tracker/footprint.hpp), now by the modes that may have left it, M by Joseph's form.
/// An approximation of the IMM: every mode at the same mean and covariance. With one mode and a linear sensor it is
/// exact.
/// In later scans a sensor with a budget looks only where all that are up have one: what other tracks take of it is not
/// known.
/// Units    SI, layout of radar/state.hpp.
/// Cost     `lay`: O(scans M n^2). A look's geometry is worked out once, when it is asked for first. No allocation once
///          the stores have grown.
class TrackPath {
 public:
  /// The path of a track over scans 0 (now) .. scans - 1. Requires scans >= 1; the situation outlives the path.
  void lay(const Situation& situation, std::size_t track, int scans);

  int scans() const { return static_cast<int>(steps_.size()); }
  const State& mean(int scan) const { return steps_[static_cast<std::size_t>(scan)].mean; }
  /// Process noise of the way to `scan` >= 1.
  const StateMatrix& noise(int scan) const { return steps_[static_cast<std::size_t>(scan)].noise; }
  /// From the covariance after scan `scan` to the predicted one of the next.
  StateMatrix predict(int scan, const StateMatrix& after) const;
  /// Whether the sensor could look; of now that is for the feasible pairs to say.
  bool possible(int scan, std::size_t sensor) { return view(scan, sensor).possible; }
  /// Information on the position of one look, Hp' R^-1 Hp with Hp the columns of x and y, 1/m^2; and P_d there.
  Matrix2 position_information(int scan, std::size_t sensor);
  double p_detect(int scan, std::size_t sensor) { return view(scan, sensor).p_detect; }
  /// p of a look, and M in `seen`; 0, with `seen` = `predicted`, where the numbers fail.
  double look(int scan, std::size_t sensor, const StateMatrix& predicted, StateMatrix& seen);

 private:
  struct Step {
    State mean;
    StateMatrix noise;
  };
  struct View {
    bool made = false;
    bool possible = false;
    double p_detect = 0.0;
    MeasurementJacobian h;
    Matrix2 r;
  };
  const View& view(int scan, std::size_t sensor);
  double in_footprint(int scan, std::size_t sensor, const StateMatrix& predicted) const;

  const Situation* situation_ = nullptr;
  std::size_t track_ = 0;
  bool one_motion_ = false;    // every mode moves alike
  bool budgets_bind_ = false;  // every sensor that is up has a budget
  std::vector<Step> steps_;
  std::vector<double> mode_;  // mu_j[k], [scan][mode]
  std::vector<View> views_;   // [scan][sensor]
};

}  // namespace dwell
