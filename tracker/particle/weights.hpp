#pragma once

#include <span>
#include <vector>

#include "tracker/imm.hpp"

namespace dwell {

/// A part of a mixture.
struct WeightedGaussian {
  int mode = 0;
  double weight = 0.0;
  Gaussian belief;
};

/// exp(log_weight) over their sum, by log-sum-exp. `weight` is unchanged on an error.
/// Errors   kNotFinite where one is NaN or infinite upwards, or all are zero.
Numerics normalise(std::span<const double> log_weight, std::vector<double>& weight);

/// The moment-matched Gaussian and the summed weight of each mode. A mode of no weight has the moments of all.
/// Requires weights that sum to one.
ImmEstimate moments_by_mode(std::span<const WeightedGaussian> parts, int modes);

}  // namespace dwell
