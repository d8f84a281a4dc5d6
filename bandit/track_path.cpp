#include "bandit/track_path.hpp"

#include <algorithm>
#include <cmath>

#include "radar/assert.hpp"
#include "tracker/footprint.hpp"

namespace dwell {

void TrackPath::lay(const Situation& situation, std::size_t track, int scans) {
  DWELL_ASSERT(scans >= 1);
  situation_ = &situation;
  track_ = track;
  const DiscreteBank& bank = *situation.bank;
  const auto modes = static_cast<std::size_t>(bank.size());
  const ImmEstimate& estimate = situation.tracks[track].estimate;
  DWELL_ASSERT(estimate.modes.size() == modes);
  one_motion_ = std::all_of(bank.f.begin(), bank.f.end(), [&](const StateMatrix& f) { return f == bank.f.front(); });
  budgets_bind_ = std::all_of(situation.states.begin(), situation.states.end(),
                              [](const SensorState& state) { return !state.up || state.budget.limited(); });
  steps_.resize(static_cast<std::size_t>(scans));
  mode_.assign(static_cast<std::size_t>(scans) * modes, 0.0);
  views_.assign(static_cast<std::size_t>(scans) * situation.sensors.size(), View{});
  for (std::size_t j = 0; j < modes; ++j) mode_[j] = estimate.probability[static_cast<Eigen::Index>(j)];
  steps_[0] = {situation.tracks[track].combined.mean, StateMatrix::Zero()};
  for (std::size_t k = 1; k < steps_.size(); ++k) {
    const double* before = &mode_[(k - 1) * modes];
    double* here = &mode_[k * modes];
    Step& step = steps_[k];
    step.mean.setZero();
    step.noise.setZero();
    for (std::size_t j = 0; j < modes; ++j) {
      for (std::size_t i = 0; i < modes; ++i) {
        here[j] += before[i] * bank.transition(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
      step.mean += here[j] * (bank.f[j] * steps_[k - 1].mean);
      step.noise += here[j] * bank.q[j];
    }
    for (std::size_t j = 0; j < modes && !one_motion_; ++j) {
      const State apart = bank.f[j] * steps_[k - 1].mean - step.mean;
      step.noise += here[j] * apart * apart.transpose();
    }
  }
}

/// Of now: the modes', each by its part of the position variance that a look could take away, for that is what is left
/// where the target is in a mode whose footprint misses it. Later there is the one covariance.
double TrackPath::in_footprint(int scan, std::size_t sensor, const StateMatrix& predicted) const {
  const Sensor& with = *situation_->sensors[sensor];
  const State& x = mean(scan);
  if (scan > 0) return footprint_probability(with, {x, predicted}, x);
  const ImmEstimate& estimate = situation_->tracks[track_].estimate;
  double all = 0.0;
  double inside = 0.0;
  for (std::size_t j = 0; j < estimate.modes.size(); ++j) {
    const Gaussian& mode = estimate.modes[j];
    const double spread = position_block(mode.covariance).trace() + (position(mode.mean) - position(x)).squaredNorm();
    const double part = estimate.probability[static_cast<Eigen::Index>(j)] * spread;
    all += part;
    if (part > 0.0) inside += part * footprint_probability(with, mode, x);
  }
  return inside / all;
}

StateMatrix TrackPath::predict(int scan, const StateMatrix& after) const {
  const DiscreteBank& bank = *situation_->bank;
  const auto next = static_cast<std::size_t>(scan) + 1;
  const auto move = [&](const StateMatrix& f) -> StateMatrix {
    const StateMatrix moved = f * after;
    return moved * f.transpose();
  };
  if (one_motion_) return symmetric_part(move(bank.f.front()) + steps_[next].noise);
  StateMatrix sum = steps_[next].noise;
  for (std::size_t j = 0; j < bank.f.size(); ++j) sum += mode_[next * bank.f.size() + j] * move(bank.f[j]);
  return symmetric_part(sum);
}

const TrackPath::View& TrackPath::view(int scan, std::size_t sensor) {
  View& view = views_[static_cast<std::size_t>(scan) * situation_->sensors.size() + sensor];
  if (view.made) return view;
  const Sensor& with = *situation_->sensors[sensor];
  const SensorState& state = situation_->states[sensor];
  const State& x = mean(scan);
  view.made = true;
  view.possible = state.up && (scan == 0 || budgets_bind_ || !state.budget.limited()) && with.covers(x);
  if (!view.possible) return view;
  view.p_detect = with.detection_probability(x);
  view.h = with.jacobian(x);
  view.r = with.noise(x);
  return view;
}

Matrix2 TrackPath::position_information(int scan, std::size_t sensor) {
  const View& seen = view(scan, sensor);
  const Matrix2 h = seen.h({0, 1}, {kX, kY});
  return h.transpose() * seen.r.llt().solve(h);
}

double TrackPath::look(int scan, std::size_t sensor, const StateMatrix& predicted, StateMatrix& seen) {
  seen = predicted;
  const View& from = view(scan, sensor);
  if (!from.possible) return 0.0;
  PredictedMeasurement measurement;
  measurement.h = from.h;
  measurement.r = from.r;
  if (factorise(predicted, measurement) != Numerics::kOk) return 0.0;
  const StateMatrix after = updated_covariance(predicted, measurement, kalman_gain(predicted, measurement));
  const double p = from.p_detect * in_footprint(scan, sensor, predicted);
  if (!after.allFinite() || !std::isfinite(p)) return 0.0;
  seen = after;
  return p;
}

}  // namespace dwell
