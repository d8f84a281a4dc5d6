#pragma once

#include <span>
#include <vector>

#include "radar/random.hpp"

namespace dwell {

/// Which of the weighted particles go on, and with what weight.
struct Survivors {
  std::vector<std::size_t> index;  ///< ascending; a particle may stand here more than once
  std::vector<double> weight;
};

/// `count` particles of equal weight 1 / count, each weight w_i standing for floor or ceil of count w_i of them.
///
/// Requires weights >= 0 that sum to one.
/// Source   Kitagawa (1996), J. Comp. Graph. Stat. 5; Douc, Cappe, Moulines (2005), ISPA.
void resample_systematically(std::span<const double> weight, std::size_t count, RandomStream& stream, Survivors& out);

/// At most `count` different particles whose weights are, on average, what they were, and differ from that least.
///
///   c: sum_i min(w_i / c, 1) = count;   w_i > c stays as it is; of the others each stays with probability w_i / c, as
///   c
///
/// For weights on a finite set of alternatives, where to keep one twice is a waste. All stay where there are no more
/// than `count`.
/// Requires weights >= 0 that sum to one. Cost O(n log n).
/// Source   Fearnhead, Clifford (2003), J. R. Statist. Soc. B 65, 5 (optimal resampling).
void resample_optimally(std::span<const double> weight, std::size_t count, RandomStream& stream, Survivors& out);

}  // namespace dwell
