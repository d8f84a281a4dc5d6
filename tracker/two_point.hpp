#pragma once

#include "tracker/gaussian.hpp"

namespace dwell {

/// The belief that two positions give, p1 an interval T before p2: x = p2, v = (p2 - p1) / T.
///
///   covariance  [R2  R2 / T; .  (R1 + R2) / T^2]
///
/// Source  Bar-Shalom, Li, Kirubarajan (2001), 5.5.3 (two-point differencing).
inline Gaussian two_point(const Vector2& p1, const Matrix2& r1, const Vector2& p2, const Matrix2& r2, double t_s) {
  Gaussian belief;
  belief.mean = make_state(p2, (p2 - p1) / t_s);
  belief.covariance({kX, kY}, {kX, kY}) = r2;
  belief.covariance({kX, kY}, {kVx, kVy}) = r2 / t_s;
  belief.covariance({kVx, kVy}, {kX, kY}) = r2 / t_s;
  belief.covariance({kVx, kVy}, {kVx, kVy}) = (r1 + r2) / (t_s * t_s);
  return belief;
}

}  // namespace dwell
