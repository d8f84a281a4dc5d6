#pragma once

#include <span>
#include <vector>

#include "radar/sensor.hpp"
#include "tracker/particle/resampling.hpp"
#include "tracker/particle/weights.hpp"

namespace dwell {

/// Jump-Markov particle filter whose particles are mode histories: given its modes the state is a Gaussian, and a
/// Kalman filter has it exactly (the Kalman part is marginalised, "Rao-Blackwellised").
///
///   predict   every particle goes on in every mode j: weight w Pi_rj, Gaussian through F_j, Q_j
///   update    weight times N(nu; 0, S), Gaussian by Joseph's form; h linearised at the particle's mean (EKF)
///
/// No mode is drawn: of the histories, `particles` times the number of modes after a prediction, the next prediction
/// keeps `particles` by optimal resampling. While there are no more than that it is the exact Bayes filter of a linear
/// sensor. A plot is taken for the target's: association comes before.
/// Deterministic: the same stream and the same calls give the same particles.
/// Requires a bank without guards and trailing states.
/// Cost     O(particles modes n^3) an update.
/// Source   Doucet, Gordon, Krishnamurthy (2001), IEEE T-SP 49(3); Fearnhead, Clifford (2003), J. R. Statist. Soc.
/// B 65.
class MarginalFilter {
 public:
  MarginalFilter(DiscreteBank bank, const Gaussian& start, const Eigen::VectorXd& probability, int particles,
                 RandomStream stream);

  void predict();
  /// Errors   kNotPositiveDefinite of an S, kNotFinite where no history has a likelihood; nothing changes then.
  Numerics update(const Sensor& sensor, const Vector2& z);
  /// Multiplies the weight of each history by the factor of its mode: what no plot says of the modes.
  /// Errors   kNotFinite where no history keeps a weight; nothing changes then.
  Numerics weigh(std::span<const double> of_mode);

  /// The histories of each mode, moment-matched, and the modes' weights: what policies and displays read of an IMM.
  ImmEstimate estimate() const { return moments_by_mode(histories_, bank_.size()); }
  /// The belief itself: at most particles x modes histories, weights that sum to one.
  std::span<const WeightedGaussian> histories() const { return histories_; }

 private:
  void resample();

  DiscreteBank bank_;
  std::size_t particles_;
  RandomStream stream_;
  std::vector<WeightedGaussian> histories_;  // weights sum to one
  std::vector<WeightedGaussian> next_;
  std::vector<double> weight_;
  std::vector<double> log_weight_;
  Survivors survivors_;
};

}  // namespace dwell
