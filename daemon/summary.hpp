#pragma once

#include <map>
#include <string>
#include <vector>

#include "daemon/engine.hpp"

namespace dwell {

/// What a run came to, against the truth of the simulation: collected scan by scan, printed at the end.
class Summary {
 public:
  void add(const Engine& engine);

  /// A table: one line a target, one a sensor, the totals.
  std::string text(const Engine& engine) const;

  /// sqrt of the mean squared position error over all tracks and scans, metres.
  double position_rms_m() const;

 private:
  struct Row {
    State state = State::Zero();  // of the track, at its last scan
    double sigma_m = 0.0;         // largest 1-sigma of position there
    std::string status;
    std::uint64_t scans = 0;
    double squared_error_m2 = 0.0;  // sum over scans
    std::uint64_t updates = 0;
    double nees_at_updates = 0.0;  // sum over updates
  };
  std::map<std::string, Row> rows_;  // by track name
};

}  // namespace dwell
