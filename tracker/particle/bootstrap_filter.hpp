#pragma once

#include <span>
#include <vector>

#include "radar/sensor.hpp"
#include "tracker/imm.hpp"
#include "tracker/particle/resampling.hpp"

namespace dwell {

/// Jump-Markov particle filter whose particles are states with a mode, moved by the model and weighted by the plot.
///
///   r_k ~ row r_k-1 of Pi,  x_k = F_r x_k-1 + L_r w        w_k proportional to w_k-1 N(z; h(x_k), R(x_k))
///
/// Resampled systematically, before a prediction, when the effective number 1 / sum w^2 is under half.
/// What is nonlinear in h is exact; where a plot is far sharper than the prediction few particles are near it, and the
/// many that it takes are the method's limit. A plot is taken for the target's: association comes before.
/// Deterministic: the same stream and the same calls give the same particles.
/// Requires a bank without guards and trailing states.
/// Cost     O(particles n^2) a prediction and an update.
/// Source   Gordon, Salmond, Smith (1993), IEE Proc. F 140(2); with modes: Evans et al. (2005), IV-C.
class BootstrapFilter {
 public:
  BootstrapFilter(DiscreteBank bank, const Gaussian& start, const Eigen::VectorXd& probability, int particles,
                  RandomStream stream);

  void predict();
  /// Errors   kNotFinite where no particle has a likelihood; nothing changes then.
  Numerics update(const Sensor& sensor, const Vector2& z);
  /// Multiplies the weight of each particle by the factor of its mode: what no plot says of the modes.
  /// Errors   as `update`.
  Numerics weigh(std::span<const double> of_mode);

  /// Mean and covariance of the particles of each mode, and the modes' weights: what policies and displays read of an
  /// IMM. A mode without particles has probability 0 and the moments of all.
  ImmEstimate estimate() const;

 private:
  struct Particle {
    State x;
    int mode;
  };
  void resample();

  DiscreteBank bank_;
  std::vector<StateMatrix> noise_root_;
  RandomStream stream_;
  std::vector<Particle> particles_;
  std::vector<double> weight_;  // sum one
  std::vector<Particle> kept_;
  std::vector<double> log_weight_;
  Survivors survivors_;
};

}  // namespace dwell
