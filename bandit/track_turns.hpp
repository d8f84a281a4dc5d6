#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tracker/track.hpp"

namespace dwell {

/// The living tracks in a cycle, in the order of their numbers; a track that comes or goes does not move the others.
class TrackTurns {
 public:
  /// `tracks` in the order of their numbers.
  void set(std::span<const Track> tracks, TrackId last) {
    rank_.clear();
    count_ = 0;
    next_ = 0;
    for (const Track& track : tracks) {
      rank_.push_back(count_);
      if (!track.alive()) continue;
      ++count_;
      if (track.id.number <= last.number) next_ = count_;
    }
    wrapped_ = next_ == count_;
    if (wrapped_) next_ = 0;
  }

  std::size_t count() const { return count_; }
  /// Of the track at a place of the span.
  std::size_t rank(std::size_t place) const { return rank_[place]; }
  /// Of the first track after the last one; 0, and `wrapped`, where there is none.
  std::size_t next() const { return next_; }
  bool wrapped() const { return wrapped_; }

 private:
  std::vector<std::size_t> rank_;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  bool wrapped_ = false;
};

}  // namespace dwell
