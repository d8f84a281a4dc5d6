#pragma once

#include <Eigen/Core>

namespace dwell {

/// What a radar does beyond its configured figures. A plot stamped t of a target at x is
///
///   z = h(position(x) + time_bias velocity(x)) + [range_bias; azimuth_bias] + v,
///   v ~ N(0, diag((e^log_range_scale sigma_range)^2, (e^log_azimuth_scale sigma_azimuth)^2)),
///
/// sigma_range and sigma_azimuth as configured: zero is a radar that is what its config says.
struct Correction {
  double log_range_scale = 0.0;
  double log_azimuth_scale = 0.0;
  double range_bias_m = 0.0;
  double azimuth_bias_rad = 0.0;
  double time_bias_s = 0.0;  ///< the plot stamped t shows the target where it is at t + time_bias
};

/// 1-sigma of each parameter before any plot is seen, around what is configured.
struct CorrectionPrior {
  double log_scale = 1.0;               ///< noise figures are right to a factor e
  double range_bias_m = 100.0;          ///< a cable's or a transponder's delay left out
  double azimuth_bias_rad = 0.0174533;  ///< 1 deg: north set by hand
  double time_bias_s = 0.1;             ///< clocks that are set, stamps taken late
};

/// The parameters of one radar in order, as the estimator stacks them.
enum class CorrectionKind { kLogRangeScale, kLogAzimuthScale, kRangeBias, kAzimuthBias, kTimeBias };
inline constexpr int kCorrectionSize = 5;
using CorrectionVector = Eigen::Matrix<double, kCorrectionSize, 1>;

inline CorrectionVector to_vector(const Correction& c) {
  CorrectionVector vector;
  vector << c.log_range_scale, c.log_azimuth_scale, c.range_bias_m, c.azimuth_bias_rad, c.time_bias_s;
  return vector;
}
inline Correction to_correction(const CorrectionVector& v) { return {v[0], v[1], v[2], v[3], v[4]}; }

/// A prior's sigmas in that order.
inline CorrectionVector sigmas_of(const CorrectionPrior& prior) {
  CorrectionVector vector;
  vector << prior.log_scale, prior.log_scale, prior.range_bias_m, prior.azimuth_bias_rad, prior.time_bias_s;
  return vector;
}

}  // namespace dwell
