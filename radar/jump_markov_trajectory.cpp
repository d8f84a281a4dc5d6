#include "radar/jump_markov_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace dwell {
namespace {

/// A turn at rate w that slows down at rate d: v(t) = v exp((i w - d) t), x + i y; the position is its integral.
State spiral(const State& x, double w, double d, double dt_s) {
  const std::complex<double> v(velocity(x).x(), velocity(x).y());
  const std::complex<double> rate(-d, w);
  const std::complex<double> turned = v * std::exp(rate * dt_s);
  const std::complex<double> along = (turned - v) / rate;
  return make_state(position(x) + Vector2(along.real(), along.imag()), {turned.real(), turned.imag()});
}

}  // namespace

int draw_index(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& probability, RandomStream& stream) {
  double left = stream.uniform();
  int index = 0;
  for (; index + 1 < probability.size(); ++index) {
    left -= probability[index];
    if (left < 0.0) break;
  }
  return index;
}

JumpMarkovTrajectory::JumpMarkovTrajectory(JumpMarkovSystem system, JumpMarkovScript script, RandomStream stream)
    : system_(std::move(system)),
      script_(std::move(script)),
      stream_(stream),
      state_(script_.initial),
      mode_(script_.initial_mode),
      now_(script_.start) {}

std::optional<State> JumpMarkovTrajectory::advance(TimePoint time) {
  if (time < script_.start || time > script_.end) return std::nullopt;
  for (; now_ < time; now_ += script_.scan_period) step();
  return state_;
}

void JumpMarkovTrajectory::step() {
  mode_ = next_mode();
  State draw;
  for (double& value : draw) value = stream_.normal();
  if (const auto rate = turn_back_rate()) {
    const double dt_s = to_seconds(script_.scan_period);
    const double speed = velocity(state_).norm();
    const double wanted = std::max(velocity(script_.initial).norm(), speed * std::exp(-std::abs(*rate) * dt_s));
    state_ = spiral(state_, *rate, speed > wanted ? std::log(speed / wanted) / dt_s : 0.0, dt_s);
    return;
  }
  const auto mode = static_cast<std::size_t>(mode_);
  state_ = system_.transition_matrix[mode] * state_ + system_.process_noise_root[mode] * draw;
}

int JumpMarkovTrajectory::next_mode() {
  for (const Guard& guard : system_.guards) {
    if (guard.from == mode_ && holds(guard)) return guard.to;
  }
  return draw_index(system_.transition.row(mode_), stream_);
}

bool JumpMarkovTrajectory::holds(const Guard& guard) {
  Eigen::VectorXd draw(guard.b.size());
  for (double& value : draw) value = stream_.normal();
  return (guard.l * state_ + guard.b + guard.noise_root * draw).maxCoeff() <= 0.0;
}

/// The turn rate (counter-clockwise positive) while the target is outside its area and not yet heading within 60
/// degrees of the centre; empty otherwise.
std::optional<double> JumpMarkovTrajectory::turn_back_rate() const {
  if (!script_.area) return std::nullopt;
  const Vector2 inward = script_.area->centre_m - position(state_);
  const Vector2 v = velocity(state_);
  const bool homing = inward.dot(v) > 0.5 * inward.norm() * v.norm();
  if (inward.norm() <= script_.area->radius_m || homing) return std::nullopt;
  const double cross = v.x() * inward.y() - v.y() * inward.x();
  return cross >= 0.0 ? script_.area->turn_rate_radps : -script_.area->turn_rate_radps;
}

}  // namespace dwell
