#pragma once

#include <vector>

#include "bandit/policy.hpp"

namespace dwell {

/// The looks of the greatest total score, each of another sensor at another track: what is best for a scan of several
/// looks where the scores of looks at different tracks add up.
///
/// A matching of sensors and tracks, from none upwards: the best alternating path lets one look more in, and sensors
/// change tracks on its way. What it finds is the best of its size, so exact.
/// Cost     O(looks (S^3 + S T)) for S sensors and T tracks; no allocation once its stores have grown.
/// Source   successive shortest paths: Ahuja, Magnanti, Orlin (1993), Network Flows, 9.7 and 12.4.
class BestLooks {
 public:
  /// Adds to what is chosen, of sensors and tracks that are not, up to the situation's looks in all; best first.
  void add(const Situation& situation, Decision& decision);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  bool augment(const Decision& decision);
  std::size_t& candidate(std::size_t sensor, std::size_t track) { return candidate_[sensor * tracks_ + track]; }

  std::size_t sensors_ = 0;
  std::size_t tracks_ = 0;
  std::vector<std::size_t> candidate_;  // of [sensor][track]; kNone: not feasible, or taken
  std::vector<std::size_t> look_;       // the candidate of each sensor; kNone: no look
  std::vector<char> looked_at_;         // of each track
  std::vector<double> gain_;            // of each sensor: best path that takes its track away
  std::vector<std::size_t> before_;     // on that path, the sensor that takes it
};

}  // namespace dwell
