#pragma once

#include <optional>

#include "radar/ids.hpp"
#include "radar/time.hpp"

namespace dwell {

/// How one target was tracked over its life, scan by scan.
///
///   completeness   share of its scans at which it had a track
///   breaks         how often its track ended or became another one while it lived
///   latency        from its first scan to its first track
///
/// Tentative tracks are none.
/// Source   Votruba, Nisley, Rothrock, Zombro (2001), *Single Integrated Air Picture (SIAP) Metrics Implementation*:
///          completeness and track continuity.
class Continuity {
 public:
  /// The next scan of the living target, and its track.
  void add(TimePoint time, std::optional<TrackId> track) {
    if (scans_ == 0) first_ = time;
    ++scans_;
    if (track) {
      ++tracked_;
      if (!found_) found_ = time;
    }
    breaks_ += track_ && track != track_ ? 1 : 0;
    track_ = track;
  }

  int scans() const { return scans_; }
  int tracked() const { return tracked_; }
  int breaks() const { return breaks_; }
  /// Empty where it never had a track.
  std::optional<double> latency_s() const {
    if (!found_) return std::nullopt;
    return to_seconds(*found_ - first_);
  }

 private:
  int scans_ = 0;
  int tracked_ = 0;
  int breaks_ = 0;
  TimePoint first_;
  std::optional<TimePoint> found_;
  std::optional<TrackId> track_;  // at the last scan
};

}  // namespace dwell
