#pragma once

#include "tracker/imm.hpp"

namespace dwell {

/// `predict` of tracker/imm.hpp for a bank whose modes have unlike states, with the transition matrix Pi.
///
/// Into mode j, mode i is mixed with all it has of j's states. What i lacks it takes from j, mean and covariance,
/// uncorrelated with what i has: mixing it as zero would pull j's estimate towards zero, and as uncertain as zero is.
/// States are alike that are of one kind (tracker/trailing_states.hpp): the accelerations of nearly constant
/// acceleration and of Singer's target mix.
/// Without trailing states in `estimate` those of every mode are as at the start: mean 0 and `start_sigma`.
///
/// Roots are mixed and moved, not covariances, so that what is known of the trailing states stays definite however
/// sharp it is.
/// Errors   kNotFinite; kNotPositiveDefinite of a predicted kinematic covariance.
/// Source   Yuan, Bar-Shalom, Willett, Mozeson, Pollak, Hardiman (2012), "A multiple IMM estimation approach with
///          unbiased mixing for thrusting projectiles", IEEE T-AES 48(4).
Numerics predict_unlike(const DiscreteBank& bank, const Eigen::MatrixXd& transition, const ImmEstimate& estimate,
                        ImmEstimate& predicted);

}  // namespace dwell
