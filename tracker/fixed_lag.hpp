#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "tracker/tracker.hpp"

namespace dwell {

/// A track whose looks may arrive late, in any order and more than once.
///
/// Keeps the last scans, each with the track as it was predicted to it and the looks that have arrived of it. A look of
/// an earlier scan is put in its place, and what came after it is done again: the track is then bit for bit what it
/// would be had everything arrived in order. To that end looks of one scan are taken by the number of their radar, and
/// plots of one look by their measurement, whatever order they came in. A track that was lost for want of plots lives
/// again where they arrive in time.
///
/// Plots of one radar at one time are of one look; one whose measurement is there already is a duplicate, bit for bit
/// (networks repeat what they carry). Each look is taken alone: tracks that share its plots are not replayed with it.
/// Cost     a look k scans late: k predictions, and the looks of these scans. O(lag) tracks are kept.
/// Source   Bar-Shalom, Willett, Tian, *Tracking and Data Fusion* (2011), 10: reprocessing, the exact solution for
///          out-of-sequence measurements.
class FixedLag {
 public:
  enum class Arrival {
    kUsed,       ///< in its place; some of its plots may have been duplicates
    kDuplicate,  ///< nothing in it was new
    kTooLate,    ///< of a scan that is no longer kept: dropped
  };

  /// Plots that were dropped.
  struct Counts {
    std::uint64_t too_late = 0;
    std::uint64_t duplicates = 0;
  };

  /// The track at `time`, a scan without looks so far. Keeps scans that are at most `lag` >= 0 old. The tracker, whose
  /// scan period `scan_period` is, outlives this.
  FixedLag(Tracker& tracker, Track track, TimePoint time, Duration scan_period, Duration lag);

  /// The next scan: the track is predicted.
  void advance();

  /// A look of this scan or of an earlier one: its time is that of a scan. The sensor outlives this.
  Arrival look(const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots);

  const Track& track() const { return track_; }
  TimePoint time() const { return scans_.back().time; }
  const Counts& counts() const { return counts_; }

 private:
  struct Look {
    const Sensor* sensor;
    Dwell dwell;
    std::vector<Plot> plots;  // by measurement
  };
  struct Scan {
    TimePoint time;
    Track predicted;
    std::vector<Look> looks;  // by radar
  };

  bool insert(Scan& scan, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots);
  void replay(std::size_t from);

  Tracker& tracker_;
  Duration scan_period_;
  Duration lag_;
  std::deque<Scan> scans_;  // the last is the present; never empty
  Track track_;             // after the looks of the present
  Counts counts_;
};

}  // namespace dwell
