#include "radar/scripted_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dwell {
namespace {

State accelerate(const State& x, const Vector2& a, double dt_s) {
  return make_state(position(x) + velocity(x) * dt_s + 0.5 * a * dt_s * dt_s, velocity(x) + a * dt_s);
}

/// A turn at constant speed and rate w: v rotates by w dt, the position moves along the arc.
State turn(const State& x, double w, double dt_s) {
  const double angle = w * dt_s;
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  const Vector2 v = velocity(x);
  const Vector2 left(-v.y(), v.x());
  return make_state(position(x) + (s * v + (1.0 - c) * left) / w, c * v + s * left);
}

State fly(const State& x, const Leg* leg, double dt_s) {
  if (leg == nullptr) return accelerate(x, Vector2::Zero(), dt_s);
  return leg->turn_rate_radps == 0.0 ? accelerate(x, leg->acceleration_mps2, dt_s)
                                     : turn(x, leg->turn_rate_radps, dt_s);
}

}  // namespace

ScriptedTrajectory::ScriptedTrajectory(Script script, RandomStream stream)
    : script_(std::move(script)), stream_(stream), state_(script_.initial), now_(script_.start) {}

std::optional<State> ScriptedTrajectory::advance(TimePoint time) {
  if (time < script_.start || time > script_.end) return std::nullopt;
  if (time == now_) return state_;
  double noise_scale = 1.0;
  while (now_ < time) {
    TimePoint until = time;
    const Leg* active = nullptr;
    for (const Leg& leg : script_.legs) {
      if (now_ < leg.start) {
        until = std::min(until, leg.start);
      } else if (now_ < leg.end) {
        active = &leg;
        until = std::min(until, leg.end);
      }
    }
    state_ = fly(state_, active, to_seconds(until - now_));
    now_ = until;
    noise_scale = active == nullptr ? 1.0 : active->process_noise_scale;
  }
  State draw;
  for (double& value : draw) value = stream_.normal();
  state_ += std::sqrt(noise_scale) * (script_.process_noise_root * draw);
  return state_;
}

}  // namespace dwell
