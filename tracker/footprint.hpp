#pragma once

#include "radar/sensor.hpp"
#include "tracker/gaussian.hpp"

namespace dwell {

/// Probability that a target of the given belief lies in the footprint of a look that points at `pointing`.
///
///   prod_i Phi((half_i - m_i) / s_i) - Phi((-half_i - m_i) / s_i),   m = h(mean) - h(pointing), s_i^2 = (H P H')_ii
///
/// An approximation: the axes of the measurement are taken as independent. 1 for a sensor without a beam. A target
/// that has left the beam is not seen however strong it is: what a miss says, and what a look is worth, turn on this.
double footprint_probability(const Sensor& sensor, const Gaussian& belief, const State& pointing);

}  // namespace dwell
