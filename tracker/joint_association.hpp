#pragma once

#include <cstdint>
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

  /// The same of pruned events (JPDA*): of the joint events in which the same tracks have the same plots, only the
  /// likeliest way to deal them out is kept. Tracks side by side then do not lean to each other's plots until they are
  /// one. `own` is the ratio of each plot for the track itself; with W the sums over the events that are kept
  ///
  ///   e_i = W(plot i is mine) / (own_i W(none is mine))
  ///
  /// which may exceed one. The number of events is bounded: beyond kMostEvents, or 64 plots that anybody may take, all
  /// are kept, as in `solve`. Cost     O(events log events). Source   Blom, Bloem (2000), IEEE T-AC 45(2),
  /// "Probabilistic data association avoiding track coalescence".
  void solve_pruned(std::span<const double> own, std::span<const double> ratio, std::size_t rivals,
                    std::span<double> factor);
  static constexpr std::size_t kMostEvents = 1 << 16;

 private:
  struct Event {
    std::uint64_t plots = 0;   // that somebody has, by their places among those that anybody may take
    std::uint32_t tracks = 0;  // that have one; bit 0 is the track itself
    std::uint32_t mine = 0;    // plot + 1, 0: none
    double weight = 1.0;
  };
  bool list_events(std::span<const double> own, std::span<const double> ratio, std::size_t rivals);
  void deal_out(std::span<const double> ratio, std::uint32_t track);

  std::vector<std::uint32_t> shared_;  // plots that anybody may take
  std::vector<Event> events_;
  std::vector<double> before_;  // [plot][set]: of the plots before this one, by the rivals that have taken them
  std::vector<double> after_;   // [plot][set]: of the plots from this one on, by rivals outside the set
};

}  // namespace dwell
