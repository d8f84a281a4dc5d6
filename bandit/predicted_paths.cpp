#include "bandit/predicted_paths.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bandit/expected_cost.hpp"
#include "radar/assert.hpp"
#include "tracker/footprint.hpp"

namespace dwell {

void PredictedPaths::lay(const Situation& situation, int scans) {
  DWELL_ASSERT(scans >= 1 && scans <= kMostScans);
  situation_ = &situation;
  scans_ = scans;
  tracks_ = situation.tracks.size();
  sensors_ = situation.sensors.size();
  modes_ = static_cast<std::size_t>(situation.bank->size());
  const std::size_t places = tracks_ * static_cast<std::size_t>(scans);
  mode_places_.resize(places * modes_);
  mixing_.resize(places * modes_ * modes_);
  looks_.assign(places * sensors_, Look{});
  h_.resize(places * sensors_ * modes_);
  heads_.clear();
  covariances_.clear();
  next_.clear();
  on_path_.modes.resize(modes_);
  on_path_.probability.resize(static_cast<Eigen::Index>(modes_));
  for (std::size_t track = 0; track < tracks_; ++track) {
    const ImmEstimate& estimate = situation.tracks[track].estimate;
    DWELL_ASSERT(estimate.modes.size() == modes_);
    heads_.push_back({static_cast<std::uint32_t>(track), -1, 0.0});
    for (const Gaussian& mode : estimate.modes) covariances_.push_back(mode.covariance);
    next_.insert(next_.end(), sensors_ + 2, kNobody);
  }
  for (const Pair& pair : situation.feasible) looks_[place(pair.track, 0) * sensors_ + pair.sensor].covered = true;
  for (std::size_t track = 0; track < tracks_; ++track) lay_track(track);
}

void PredictedPaths::lay_track(std::size_t track) {
  if (!situation_->tracks[track].alive()) {
    for (std::size_t j = 0; j < modes_; ++j) mode_places_[place(track, 0) * modes_ + j] = ModePlace{};
    for (int scan = 1; scan < scans_; ++scan) mix(track, scan);
    return;
  }
  const ImmEstimate& now = situation_->tracks[track].estimate;
  for (std::size_t j = 0; j < modes_; ++j) {
    mode_places_[place(track, 0) * modes_ + j] = {now.modes[j].mean, now.probability[static_cast<Eigen::Index>(j)],
                                                  StateMatrix::Zero()};
  }
  lay_looks(track, 0);
  for (int scan = 1; scan < scans_; ++scan) {
    mix(track, scan);
    lay_looks(track, scan);
  }
}

/// Means, probabilities and noise of the way from the scan before. A mode that cannot be reached goes its own way.
void PredictedPaths::mix(std::size_t track, int scan) {
  const DiscreteBank& bank = *situation_->bank;
  const ModePlace* before = &mode_places_[place(track, scan - 1) * modes_];
  ModePlace* here = &mode_places_[place(track, scan) * modes_];
  Eigen::MatrixXd guarded;
  const bool has_guards = !bank.guards.empty() && situation_->tracks[track].alive();
  if (has_guards) guarded = guarded_transition(track, scan - 1);
  const Eigen::MatrixXd& transition = has_guards ? guarded : bank.transition;
  for (std::size_t j = 0; j < modes_; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    double c = 0.0;
    for (std::size_t i = 0; i < modes_; ++i) {
      c += before[i].probability * transition(static_cast<Eigen::Index>(i), column);
    }
    double* weights = &mixing_[(place(track, scan) * modes_ + j) * modes_];
    State mixed = State::Zero();
    for (std::size_t i = 0; i < modes_; ++i) {
      const double reached = before[i].probability * transition(static_cast<Eigen::Index>(i), column);
      weights[i] = c > 0.0 ? reached / c : (i == j ? 1.0 : 0.0);
      mixed += weights[i] * before[i].mean;
    }
    StateMatrix spread = StateMatrix::Zero();
    for (std::size_t i = 0; i < modes_; ++i) {
      const State d = before[i].mean - mixed;
      spread += weights[i] * d * d.transpose();
    }
    const StateMatrix& f = bank.f[j];
    here[j] = {f * mixed, c, symmetric_part(f * spread * f.transpose() + bank.q[j])};
  }
}

/// Of the modes as they are after `scan` without a look.
Eigen::MatrixXd PredictedPaths::guarded_transition(std::size_t track, int scan) {
  const StateMatrix* covariances = this->covariances(idle(track, scan));
  std::vector<Gaussian> modes(modes_);
  for (std::size_t j = 0; j < modes_; ++j) {
    modes[j] = {mode_places_[place(track, scan) * modes_ + j].mean, covariances[j]};
  }
  return transition_at(*situation_->bank, modes);
}

void PredictedPaths::lay_looks(std::size_t track, int scan) {
  const std::size_t at = place(track, scan);
  const StateMatrix* covariances = this->covariances(idle(track, scan));
  for (std::size_t j = 0; j < modes_; ++j) {
    on_path_.modes[j] = {mode_places_[at * modes_ + j].mean, covariances[j]};
    on_path_.probability[static_cast<Eigen::Index>(j)] = mode_places_[at * modes_ + j].probability;
  }
  const State pointing = combined_mean(on_path_);
  for (std::size_t s = 0; s < sensors_; ++s) {
    Look& look = looks_[at * sensors_ + s];
    const Sensor& sensor = *situation_->sensors[s];
    if (scan > 0) look.covered = situation_->states[s].up && sensor.covers(pointing);
    if (!look.covered) continue;
    look.useful = predict_measurements(sensor, situation_->update, on_path_, measurements_) == Numerics::kOk;
    if (!look.useful) continue;
    look.r = measurements_.front().r;
    double inside = 0.0;
    for (std::size_t j = 0; j < modes_; ++j) {
      h_[(at * sensors_ + s) * modes_ + j] = measurements_[j].h;
      inside += on_path_.probability[static_cast<Eigen::Index>(j)] *
                footprint_probability(sensor, on_path_.modes[j], pointing);
    }
    look.p = sensor.detection_probability(pointing) * inside;
  }
}

PredictedPaths::Belief PredictedPaths::idle(std::size_t track, int scan) {
  Belief belief = start(track);
  while (this->scan(belief) < scan) belief = after(belief, kNoLook);
  return belief;
}

PredictedPaths::Belief PredictedPaths::after(Belief belief, int choice) {
  const std::size_t link = belief * (sensors_ + 2) + static_cast<std::size_t>(choice);
  if (next_[link] == kNobody) {
    const Belief made = make(belief, choice);
    next_[link] = made;
  }
  return next_[link];
}

PredictedPaths::Belief PredictedPaths::make(Belief from, int choice) {
  const Head head{heads_[from].track, heads_[from].scan + 1, 0.0};
  // A look begins where no look leads: the prediction is made once.
  const Belief predicted = choice == kNoLook ? from : after(from, kNoLook);
  const auto made = static_cast<Belief>(heads_.size());
  DWELL_ASSERT(head.scan < scans_ && made != kNobody);
  if (covariances_.size() >= kMostCovariances) throw std::length_error("more beliefs than can be planned with");
  heads_.push_back(head);
  next_.insert(next_.end(), sensors_ + 2, kNobody);
  covariances_.resize(heads_.size() * modes_);
  StateMatrix* to = covariances_.data() + made * modes_;
  if (choice == kNoLook) {
    predict(head.track, head.scan, scale_, covariances(from), to);
  } else {
    std::copy_n(covariances(predicted), modes_, to);
    if (choice == every_sensor()) {
      look_with_all(head.track, head.scan, scale_, to);
    } else {
      look(head.track, head.scan, static_cast<std::size_t>(choice - 1), scale_, to);
    }
  }
  heads_[made].cost = cost(head.track, head.scan, to);
  return made;
}

void PredictedPaths::step(Belief belief, int choice, double scale, StateMatrix* to) const {
  const Head& head = heads_[belief];
  predict(head.track, head.scan + 1, scale, covariances(belief), to);
  if (choice != kNoLook) look(head.track, head.scan + 1, static_cast<std::size_t>(choice - 1), scale, to);
}

/// Scan 0 is where the tracks are: nothing moves.
void PredictedPaths::predict(std::size_t track, int scan, double scale, const StateMatrix* from,
                             StateMatrix* to) const {
  if (scan == 0) {
    std::copy_n(from, modes_, to);
    return;
  }
  const std::size_t at = place(track, scan) * modes_;
  for (std::size_t j = 0; j < modes_; ++j) {
    const double* weights = &mixing_[(at + j) * modes_];
    StateMatrix mixed = StateMatrix::Zero();
    for (std::size_t i = 0; i < modes_; ++i) mixed += weights[i] * from[i];
    const StateMatrix& f = situation_->bank->f[j];
    const StateMatrix moved = f * mixed;
    to[j].noalias() = moved * f.transpose();
    to[j] = symmetric_part(to[j] + scale * mode_places_[at + j].noise);
  }
}

double PredictedPaths::detection(std::size_t track, int scan, std::size_t sensor) const {
  const Look& seen = look(track, scan, sensor);
  return seen.useful ? seen.p : 0.0;
}

void PredictedPaths::look(std::size_t track, int scan, std::size_t sensor, double scale, StateMatrix* covariances,
                          StateMatrix* rest) const {
  const Look& seen = look(track, scan, sensor);
  if (rest != nullptr) std::fill_n(rest, modes_, StateMatrix::Identity());
  if (!seen.useful) return;
  const MeasurementJacobian* h = &h_[(place(track, scan) * sensors_ + sensor) * modes_];
  PredictedMeasurement measurement;
  measurement.r = scale * seen.r;
  for (std::size_t j = 0; j < modes_; ++j) {
    measurement.h = h[j];
    if (factorise(covariances[j], measurement) != Numerics::kOk) continue;  // a look of no use
    const Gain gain = kalman_gain(covariances[j], measurement);
    if (rest != nullptr) rest[j] -= gain * measurement.h;
    covariances[j] = seen.p * updated_covariance(covariances[j], measurement, gain) + (1.0 - seen.p) * covariances[j];
  }
}

/// With the largest p of all, each sensor's look after the other's: below every single look, p U_s(P) + (1 - p) P.
void PredictedPaths::look_with_all(std::size_t track, int scan, double scale, StateMatrix* covariances) const {
  double p = 0.0;
  for (std::size_t s = 0; s < sensors_; ++s) {
    if (look(track, scan, s).useful) p = std::max(p, look(track, scan, s).p);
  }
  PredictedMeasurement measurement;
  for (std::size_t j = 0; j < modes_; ++j) {
    StateMatrix together = covariances[j];
    for (std::size_t s = 0; s < sensors_; ++s) {
      const Look& seen = look(track, scan, s);
      if (!seen.useful) continue;
      measurement.r = scale * seen.r;
      measurement.h = h_[(place(track, scan) * sensors_ + s) * modes_ + j];
      if (factorise(together, measurement) != Numerics::kOk) continue;
      together = updated_covariance(together, measurement, kalman_gain(together, measurement));
    }
    covariances[j] = p * together + (1.0 - p) * covariances[j];
  }
}

double PredictedPaths::cost(std::size_t track, int scan, const StateMatrix* covariances) const {
  const Track& of = situation_->tracks[track];
  if (!of.alive()) return 0.0;
  const std::size_t at = place(track, scan) * modes_;
  double sum = 0.0;
  for (std::size_t j = 0; j < modes_; ++j) {
    sum += mode_places_[at + j].probability * position_block(covariances[j]).trace();
  }
  return of.weight * sum;
}

}  // namespace dwell
