#pragma once

#include "tracker/trailing_states.hpp"

namespace dwell {

/// Where a motion takes a state over an interval: its mean there, F = d mean / dx and the Q that is added.
struct Moved {
  FullState mean = FullState::Zero();
  FullMatrix f = FullMatrix::Identity();
  FullMatrix q = FullMatrix::Zero();
};

/// The same of linear motion with an acceleration on each axis that decays as a' = -decay a + w, w white of density q:
///
///   F on each axis  [1 T A(T); 0 1 B(T); 0 0 e^-dT]     B = integral of e^-dt, A = integral of B
///   Q on each axis  q times the integral over 0 .. T of g g', g = [A(t) B(t) e^-dt]
///
/// decay >= 0, 1/s; q in m^2/s^5. A by its series for d T < 0.5, where the closed form cancels; the integral by
/// Gauss-Legendre with 20 nodes on pieces of at most 2 / d, exact to rounding.
Moved move_with_acceleration(double decay_per_s, double q, double dt_s, const FullState& x);

}  // namespace dwell
