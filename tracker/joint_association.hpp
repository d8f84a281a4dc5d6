#pragma once

#include <span>
#include <vector>

namespace dwell {

/// What other tracks leave of the plots: the part of joint probabilistic data association that is not a track's own.
///
/// Each rival s takes at most one plot and each plot goes to at most one of them; an assignment weighs the product of
/// r_s(i) over its pairs, r_s(i) the ratio of "plot i is of s" to "none is". With Z the sum over all assignments and
/// Z(i) over those that leave plot i free, the event "plot i is mine" of one more track weighs
///
///   e_i = Z(i) / Z
///
/// times what it weighs for the track alone, and the marginals of the joint events follow (AssociationEvents::update).
/// Exact, the modes of every IMM included, for tracks that were independent before: r_s(i) is the sum over its modes.
///
/// By dynamic programming over the plots, the state being the set of rivals that have theirs, forwards and backwards.
/// Cost     O(plots rivals 2^rivals), at most kMostRivals. No allocation once the tables have grown.
/// Source   Fortmann, Bar-Shalom, Scheffe (1983), IEEE J. Oceanic Eng. 8; with existence: Musicki, Evans (2004), IEEE
///          T-AES 40(3); the sum over sets is that of Ryser-type permanents.
class JointAssociation {
 public:
  static constexpr int kMostRivals = 7;

  /// Room for so many plots.
  void reserve(std::size_t plots);

  /// `ratio` is rivals x plots, row by row, >= 0; `factor` takes e_i of every plot, in (0, 1].
  void solve(std::span<const double> ratio, std::size_t rivals, std::span<double> factor);

 private:
  std::vector<double> before_;  // [plot][set]: of the plots before this one, by the rivals that have taken them
  std::vector<double> after_;   // [plot][set]: of the plots from this one on, by rivals outside the set
};

}  // namespace dwell
