#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tracker/tracker.hpp"

namespace dwell {

/// A tentative track is confirmed when `plots` of `looks` surveillance looks on end gave it one, the two that it was
/// begun by among them; it is dropped when they no longer can.
struct MOfN {
  int plots = 4;
  int looks = 5;
};

struct InitiationSettings {
  /// Two plots are of one target when it needs no more than this between them, besides 3 sigma of the plots' noise.
  /// 500 m/s: what flies below Mach 1.5.
  double largest_speed_mps = 500.0;
  /// Instead of the probability of existence; always where the association has none.
  std::optional<MOfN> m_of_n;
};

/// Track initiation from the surveillance looks of one sensor.
///
/// Two plots of looks on end that belong to no track and are a possible speed apart begin a tentative track (two-point
/// differencing). It lives on the surveillance looks of this sensor alone: the link and the policies know only
/// confirmed tracks. At each look
///   1. plots in the gate of a confirmed track are withheld,
///   2. each tentative track is predicted and updated; where several take the same plot for theirs the one most likely
///      to exist stays (M of N: that with the most plots), the first among equals,
///   3. those that the rule confirms are handed over,
///   4. plots that are nobody's begin tentative tracks with those of the look before.
/// A pair is of a new target with odds nu P_d^2 / F, at most one to one: nu new targets are expected between looks, and
/// F = lambda V n false pairs a look, V the volume of the coverage and n the mean number of false plots within the
/// speed gate. A tentative track whose odds have fallen to kHopeless of these is dropped.
///
/// Tentative tracks are associated alone also where confirmed ones are jointly.
/// Cost     O(tentative x plots in their range window + pairs). Allocates where a tentative track starts.
/// Source   Bar-Shalom, Li, Kirubarajan (2001), 5.5.3 (two-point differencing); Musicki, Evans, Stankovic (1994);
///          Blackman, Popoli (1999), 6.2 (M of N).
class TrackInitiation {
 public:
  static constexpr double kHopeless = 0.05;  ///< two misses at P_d = .9

  /// One surveillance look every `scans` scan periods of `period_s`.
  TrackInitiation(const InitiationSettings& settings, int scans, double period_s)
      : settings_(settings), scans_(scans), interval_s_(scans * period_s) {}

  /// The next look. `found` takes the tracks that are confirmed, without a number; it is cleared first.
  void look(Tracker& tracker, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
            std::span<const Track> confirmed, std::vector<Track>& found);

  std::size_t tentative() const { return tentative_.size(); }

 private:
  struct Tentative {
    Track track;
    int looks = 2;
    int plots = 2;
    double first_odds = 1.0;          // of existence, at the start
    std::optional<std::size_t> plot;  // that it took at this look, in free_
  };
  void withhold(Tracker& tracker, const Sensor& sensor, std::span<const Plot> plots, std::span<const Track> confirmed);
  void advance(Tracker& tracker, const Sensor& sensor, const Dwell& dwell);
  void settle_disputes();
  void confirm(const ExistenceSettings& existence, bool by_existence, std::vector<Track>& found);
  void begin(Tracker& tracker, const Sensor& sensor);
  void begin_with(Track track);
  double existence_of_pair(const ExistenceSettings& existence, const Sensor& sensor, const State& x) const;
  std::optional<Track> pair(Tracker& tracker, const Sensor& sensor, const Plot& first, const Plot& second) const;
  bool outranks(const Tentative& one, const Tentative& other) const;

  InitiationSettings settings_;
  int scans_;
  double interval_s_;
  std::vector<Tentative> tentative_;
  std::vector<Plot> free_;      // of this look, nearest first: in no confirmed track's gate
  std::vector<Plot> previous_;  // of the look before, nobody's
  std::vector<char> withheld_;
  std::vector<std::size_t> owner_;  // of each free plot, an index into tentative_
};

}  // namespace dwell
