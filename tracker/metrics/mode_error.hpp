#pragma once

#include "tracker/imm.hpp"

namespace dwell {

/// The mode that an estimate takes to be the true one, the first among equals. Of a run the mode errors are the scans
/// at which it is another. Source: Liu, Hwang (2011), V.
inline int likeliest_mode(const ImmEstimate& estimate) {
  Eigen::Index likeliest = 0;
  estimate.probability.maxCoeff(&likeliest);
  return static_cast<int>(likeliest);
}

}  // namespace dwell
