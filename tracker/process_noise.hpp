#pragma once

#include <variant>

#include "tracker/motion.hpp"

namespace dwell {

struct NoProcessNoise {};

/// Continuous white-noise acceleration, density q on each axis, m^2/s^3.
struct WhiteNoiseAcceleration {
  double q;
};

/// An acceleration on each axis that is constant over each step and independent between steps, 1-sigma m/s^2:
/// Q1 = sigma^2 g g' on each axis, g = [T^2/2 T]. Source: Bar-Shalom, Li, Kirubarajan (2001), 6.3.2.
struct PiecewiseAcceleration {
  double sigma_mps2;
  double step_s = 1.0;
};

/// Q1 = B B' once a step, B diagonal: m, m/s, m, m/s. Source: Evans et al. (2005), (30).
struct DiagonalNoise {
  State b;
  double step_s = 1.0;
};

using ProcessNoise = std::variant<NoProcessNoise, WhiteNoiseAcceleration, PiecewiseAcceleration, DiagonalNoise>;

/// Covariance that the noise adds over dt seconds of the motion, 4 x 4.
///
/// Noise that enters once a step adds up: Q(n step) = sum_{i<n} F(step)^i Q1 F(step)'^i.
/// Requires dt to be a whole number of steps where the noise has steps (see `divides`).
StateMatrix process_noise(const Motion& motion, const ProcessNoise& noise, double dt_s);

/// L with L L' = Q, of a positive semidefinite Q: what a draw of the noise is made with.
StateMatrix noise_root(const StateMatrix& q);

/// Whether dt is a whole number of the noise's steps, to 1e-9 of a step; true for noise without steps.
bool divides(const ProcessNoise& noise, double dt_s);

}  // namespace dwell
