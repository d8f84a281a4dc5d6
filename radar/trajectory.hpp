#pragma once

#include <optional>

#include "radar/state.hpp"
#include "radar/time.hpp"

namespace dwell {

/// The truth's motion of one target.
///
/// Models  ScriptedTrajectory, JumpMarkovTrajectory, RecordedTrajectory.
class Trajectory {
 public:
  virtual ~Trajectory() = default;

  /// The state at `time`; empty before the start and after the end. Times never go back, and those from the start
  /// on are one scan period apart.
  virtual std::optional<State> advance(TimePoint time) = 0;
  /// True once `time` is past the end.
  virtual bool ended(TimePoint time) const = 0;
  /// Altitude at the last time advanced to, metres. Carried along; no sensor measures it.
  virtual double altitude_m() const { return 0.0; }
  /// The mode that brought the target to the last time; empty where the truth has no modes.
  virtual std::optional<int> mode() const { return std::nullopt; }
};

}  // namespace dwell
