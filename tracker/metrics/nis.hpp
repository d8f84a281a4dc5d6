#pragma once

namespace dwell {

/// Where the normalised innovation squared of a plot, nu' S^-1 nu with two degrees of freedom, lies 95 times of 100 if
/// the filter is right: -2 log(.975) .. -2 log(.025), the chi-square distribution being exponential there. Of n
/// independent plots a binomial share is outside.
/// Source   Bar-Shalom, Li, Kirubarajan (2001), 5.4.2.
struct NisBand {
  double low = 0.050635615968579795;
  double high = 7.3777589082278725;

  bool contains(double nis) const { return low <= nis && nis <= high; }
};
inline constexpr NisBand kNisBand;

}  // namespace dwell
