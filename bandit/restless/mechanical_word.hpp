#pragma once

#include "bandit/restless/scalar_arm.hpp"

namespace dwell::restless {

/// Average cost of a scan when a scalar arm is looked at in the most even way at the rate m / n.
///
/// Look at scan t iff floor((t + 1) m / n) > floor(t m / n): the mechanical (Christoffel) word. One period composes to
/// p -> (a p + b) / (c p + d); its positive fixed point is the root of c p^2 + (d - a) p - b = 0. Convex in m / n, and
/// the least cost of all sequences with that rate. Infinite where the variance grows without end (m = 0 and |f| >= 1).
///
/// Requires 0 <= m <= n, n >= 1, p_detect = 1.
///
/// Source   Dance, Silander (2019).
double mechanical_cost(const ScalarArm& arm, int m, int n);

/// The least of average cost + price dwell rate over all rates: Stern-Brocot descent over the convex cost of the words.
struct RatedCost {
  double cost = 0.0;  ///< a scan, without the price
  double rate = 0.0;  ///< looks a scan
  bool found = true;  ///< else the best waits for longer than the words that are tried
};
/// Denominators to 2048, or until both neighbours of the best differ from it by less than 1e-12.
RatedCost best_rate(const ScalarArm& arm, double price);

}  // namespace dwell::restless
