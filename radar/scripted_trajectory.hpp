#pragma once

#include <vector>

#include "radar/random.hpp"
#include "radar/trajectory.hpp"

namespace dwell {

/// A manoeuvre during (start, end]: a constant acceleration, or a turn at constant speed (counter-clockwise
/// positive). The other of the two is zero.
struct Leg {
  TimePoint start;
  TimePoint end;
  Vector2 acceleration_mps2 = Vector2::Zero();
  double turn_rate_radps = 0.0;
  double process_noise_scale = 1.0;  ///< times the variance, at scan times inside the leg
};

struct Script {
  State initial = State::Zero();
  TimePoint start;
  TimePoint end = TimePoint::max();
  double altitude_m = 0.0;
  std::vector<Leg> legs;                                 ///< in order of time, not overlapping
  StateMatrix process_noise_root = StateMatrix::Zero();  ///< L, L L' = Q of one scan period
};

/// Straight and level flight with legs, integrated exactly over each interval; process noise enters at scan times.
class ScriptedTrajectory final : public Trajectory {
 public:
  ScriptedTrajectory(Script script, RandomStream stream);

  std::optional<State> advance(TimePoint time) override;
  bool ended(TimePoint time) const override { return time > script_.end; }
  double altitude_m() const override { return script_.altitude_m; }

 private:
  Script script_;
  RandomStream stream_;
  State state_;
  TimePoint now_;
};

}  // namespace dwell
