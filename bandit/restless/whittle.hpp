#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bandit/restless/scalar_arm.hpp"

namespace dwell::restless {

/// Whittle's index of a scalar arm at predicted variance p: the price of a unit of dwell at which looking and not
/// looking are worth the same.
///
///   index(p) = [F(0,p) - F(1,p)] / [W(1,p) - W(0,p)]
///
/// F and W are the cost and the dwell that follow when the first scan is without (0) or with (1) a look and afterwards
/// an arm at p or above is looked at. Both orbits are deterministic. Discounted sums are cut where b^t < 1e-17. Average
/// costs (no discount) are sums under a smooth cutoff chi(t / T), C-infinity and 1 below T / 4: periodic orbits have no
/// convergent sums, but their smooth means differ from Cesaro's by less than any power of period / T. T starts at 4000
/// and is doubled, at most six times, until the index moves by less than 1e-9 of itself.
///
/// Exceptional states, where both orbits fall in phase and the two differences vanish, take the mean of their
/// neighbours: the index is continuous. Where a look is not due again for more scans than the longest horizon (256
/// 000), the index at discount 1 - 1e-5 stands in for the average one.
///
/// Identities  index(p; w, d) = w / d index(p; 1, 1);  index(c p; c q, c r) = c index(p; q, r);
///             b -> 0: w p^2 / (p + r) / d, the one-step gain;  nondecreasing in p.
/// Requires p > 0, p_detect = 1 (see calibrated_index), 0 < discount < 1 where there is one.
/// Accuracy 1e-9 discounted, 1e-6 average with periods up to some 10 000 scans, relative.
/// Source   Nino-Mora (2006), Dance, Silander (2019): threshold policies and mechanical words; the cutoff is ours.
double whittle_index(const ScalarArm& arm, double p, std::optional<double> discount);

/// Whether the index is what it must be, over `states` variances spread evenly in log p from low to high.
struct IndexabilityReport {
  bool indexable = true;          ///< W(1,p) - W(0,p) > 0 at all: looking first is never less work
  bool monotone = true;           ///< index nondecreasing, to 1e-9 discounted and 1e-6 average
  std::vector<double> offenders;  ///< the variances where either failed
};
IndexabilityReport check_indexability(const ScalarArm& arm, double low, double high, int states,
                                      std::optional<double> discount);

}  // namespace dwell::restless
