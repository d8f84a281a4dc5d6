#include "tracker/tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "radar/assert.hpp"
#include "tracker/footprint.hpp"
#include "tracker/two_point.hpp"

namespace dwell {
namespace {

/// Of a sum of logarithms: runs of just the limit's probability, .1^8 or .01^4 of 1e-8, count as reaching it.
constexpr double kLogRounding = 1e-9;

bool is_gaussian(const Gaussian& g) {
  return is_finite(g) && Eigen::LLT<StateMatrix>(g.covariance).info() == Eigen::Success;
}

ImmEstimate estimate_of(const ParticleFilter& particles) {
  return std::visit([](const auto& filter) { return filter.estimate(); }, particles);
}

}  // namespace

Tracker::Tracker(DiscreteBank bank, Eigen::VectorXd initial_probability, const TrackerSettings& settings,
                 const RandomStream& particles)
    : bank_(std::move(bank)),
      initial_probability_(std::move(initial_probability)),
      settings_(settings),
      particle_stream_(particles) {
  DWELL_ASSERT(bank_.size() >= 1 && bank_.size() <= kMostModes);
  DWELL_ASSERT(initial_probability_.size() == bank_.size());
  DWELL_ASSERT(!settings_.particles ||
               (settings_.association == Association::kNearest && settings_.update == UpdateForm::kEkf));
  scratch_ = make_estimate({}, initial_probability_);
  measurements_.resize(scratch_.modes.size());
  innovations_.resize(scratch_.modes.size());
  best_innovations_.resize(scratch_.modes.size());
  class_mixture_.resize(settings_.classes.size());
}

void Tracker::reserve(std::size_t plots) {
  if (settings_.association == Association::kNearest) return;
  events_.reserve(plots, scratch_.modes.size());
  factor_.reserve(plots);
  if (settings_.is_joint()) cluster_.reserve(plots, scratch_.modes.size());
}

Track Tracker::start(TrackId id, std::string name, const Gaussian& belief) const {
  Track track;
  track.id = id;
  track.name = std::move(name);
  begin(track, belief);
  if (settings_.has_existence()) track.existence = 1.0;
  return track;
}

/// Every mode at the belief, every class by its prior.
void Tracker::begin(Track& track, const Gaussian& belief) const {
  track.estimate = make_estimate(belief, initial_probability_);
  track.combined = belief;
  track.components.clear();
  track.class_belief = settings_.classes.prior;
  weigh(track);
  if (!settings_.particles) return;
  track.particles.emplace(make_particles(*settings_.particles, bank_, belief, initial_probability_,
                                         particle_stream_.fork(track.id.number).fork(track.age_scans)));
}

void Tracker::set_target_weight(Track& track, double weight) const {
  track.target_weight = track.weight = weight;
  weigh(track);
}

/// The mean over its class.
void Tracker::weigh(Track& track) const {
  if (track.class_belief.size() == 0) return;
  track.weight = track.target_weight * settings_.classes.weight.dot(track.class_belief);
}

void Tracker::declare(Track& track, const Sensor& sensor, const Plot& plot) {
  class_mixture_.setZero();
  add_class_posterior(sensor, plot, 1.0, track.class_belief, class_mixture_);
  track.class_belief = class_mixture_;
  weigh(track);
}

void Tracker::fail(Track& track) {
  ++failures_;
  const Gaussian belief = track.combined;
  if (track.restarted || !is_gaussian(belief)) return track.lose(LossCause::kNumerics);
  track.restarted = true;
  track.status = TrackStatus::kCoasting;
  begin(track, belief);
}

std::optional<Gaussian> Tracker::belief_from(const Plot& plot, const Sensor& sensor, double speed_sigma_mps) {
  const std::optional<Vector2> place = sensor.position_of(plot.z);
  if (!place) return std::nullopt;
  Gaussian belief;
  belief.mean = make_state(*place, Vector2::Zero());
  const double speed_variance = speed_sigma_mps * speed_sigma_mps;
  belief.covariance = State(0.0, speed_variance, 0.0, speed_variance).asDiagonal();
  belief.covariance({kX, kY}, {kX, kY}) = position_noise(sensor, belief.mean);
  return belief;
}

void Tracker::predict(Track& track) {
  ++track.age_scans;
  ++track.unseen_scans;
  if (advance(track) != Numerics::kOk) {
    fail(track);
    if (track.alive() && advance(track) != Numerics::kOk) fail(track);
    if (!track.alive()) return;
  }
  const double variance = position_block(track.combined.covariance).trace();
  if (variance > settings_.lost_sigma_m * settings_.lost_sigma_m) track.lose(LossCause::kUncertain);
  if (track.existence) *track.existence *= settings_.existence.survival;
}

/// On an error the track is unchanged, but for the particles.
Numerics Tracker::advance(Track& track) {
  if (track.particles) {
    std::visit([](auto& filter) { filter.predict(); }, *track.particles);
    scratch_ = estimate_of(*track.particles);
  } else if (!track.components.empty()) {
    const Numerics moved = dwell::predict(bank_, track.components, components_);
    if (moved != Numerics::kOk) return moved;
    scratch_ = merged(components_);
  } else if (const Numerics moved = dwell::predict(bank_, track.estimate, scratch_); moved != Numerics::kOk) {
    return moved;
  }
  const Gaussian combined = combine(scratch_);
  if (!is_finite(combined)) return Numerics::kNotFinite;
  std::swap(track.estimate, scratch_);
  if (!track.components.empty()) std::swap(track.components, components_);
  track.combined = combined;
  return Numerics::kOk;
}

LookOutcome Tracker::look(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                          std::span<const Track> others) {
  move_class(settings_.classes, track.class_belief);
  const LookOutcome outcome = observe(track, sensor, dwell, plots, others);
  weigh(track);
  return outcome;
}

LookOutcome Tracker::observe(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                             std::span<const Track> others) {
  refused_plots_ += static_cast<std::uint64_t>(
      std::count_if(plots.begin(), plots.end(), [](const Plot& plot) { return !plot.z.allFinite(); }));
  track.unseen_scans = 0;
  track.last_look = dwell.time;
  track.last_radar = dwell.radar;
  LookOutcome outcome;
  if (settings_.association != Association::kNearest && look_at_all(track, sensor, dwell, plots, others, outcome)) {
    return outcome;
  }
  track.components.clear();  // without clutter there is one account of the plots
  return look_at_nearest(track, sensor, plots, others);
}

LookOutcome Tracker::survey(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots) {
  // Points at the track: what little of it lies beyond the footprint's half extent is all that is miscounted.
  Dwell at_track = dwell;
  at_track.pointing = track.combined.mean;
  const LookOutcome outcome = observe(track, sensor, at_track, plots, {});
  weigh(track);
  return outcome;
}

void Tracker::mark_gated(const Track& track, const Sensor& sensor, std::span<const Plot> plots,
                         std::span<char> marked) {
  if (predict_measurements(sensor, settings_.update, track.estimate, measurements_) != Numerics::kOk) return;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (plots[i].z.allFinite() && gated_innovations(track, sensor, plots[i])) marked[i] = 1;
  }
}

/// Every plot in the gate by its probability. Does nothing and says no where the nearest plot is as good: without
/// clutter and without another track at the plots.
bool Tracker::look_at_all(Track& track, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                          std::span<const Track> others, LookOutcome& outcome) {
  const bool joint = settings_.is_joint();
  const bool pruned = settings_.association == Association::kJpdaStar;
  if (sensor.clutter_density() <= 0.0 && !joint) return false;
  const State pointing = dwell.pointing;
  if (settings_.association == Association::kIts) {
    split(track, sensor, pointing, plots, outcome);
    return true;
  }
  if (events_.list(sensor, settings_.update, settings_.gate, track.estimate, pointing, plots, track.class_belief) !=
      Numerics::kOk) {
    fail(track);
    return true;
  }
  factor_.assign(events_.size(), 1.0);
  if (joint) {
    cluster_.exclude(track.id, events_, others, sensor, settings_.update, settings_.gate, pointing, plots, pruned,
                     factor_);
    if (sensor.clutter_density() <= 0.0 && cluster_.rivals() == 0) return false;
  }
  double likeliest = events_.none();
  for (std::size_t i = 0; i < events_.size(); ++i) {
    if (const double weight = factor_[i] * events_.sum(i); weight > likeliest) {
      likeliest = weight;
      outcome.used_plot = events_.plot(i);
      track.nis = mixture_squared_distance(events_.predicted(), track.estimate.probability, events_.innovations(i));
    }
  }
  const double likelihood_ratio = events_.likelihood_ratio(factor_);
  const double detection = std::min(sensor.detection_probability(track.combined.mean), kLargestBelievedDetection);
  events_.update(factor_, track.estimate);
  mix_classes(track, sensor, plots);
  conclude(track, outcome, detection, likelihood_ratio);
  return true;
}

/// Every component of the track by every event.
void Tracker::split(Track& track, const Sensor& sensor, const State& pointing, std::span<const Plot> plots,
                    LookOutcome& outcome) {
  if (track.components.empty()) track.components.push_back({.estimate = track.estimate});
  const double detection = std::min(sensor.detection_probability(track.combined.mean), kLargestBelievedDetection);
  TrackSplitting::Outcome split;
  if (splitting_.look(sensor, settings_.update, settings_.gate, pointing, plots, track.components, split) !=
          Numerics::kOk ||
      predict_measurements(sensor, settings_.update, track.estimate, measurements_) != Numerics::kOk) {
    return fail(track);
  }
  outcome.used_plot = split.likeliest;
  if (outcome.used_plot) {
    (void)gated_innovations(track, sensor, plots[*outcome.used_plot]);
    track.nis = mixture_squared_distance(measurements_, track.estimate.probability, innovations_);
  }
  track.estimate = merged(track.components);
  conclude(track, outcome, detection, split.likelihood_ratio);
}

/// What a look at all plots leaves to be said of the updated track.
void Tracker::conclude(Track& track, LookOutcome& outcome, double detection, double likelihood_ratio) {
  const Gaussian combined = combine(track.estimate);
  if (!is_finite(combined)) {
    outcome = {};
    return fail(track);
  }
  track.combined = combined;
  track.rejections = 0;
  track.outlier.reset();
  if (outcome.used_plot) {
    track.status = TrackStatus::kConfirmed;
    track.restarted = false;
    track.log_miss_probability = 0.0;
  } else {
    count_miss(track, detection);
  }
  judge_existence(track, likelihood_ratio);
}

/// The class after all events of `events_`, by their probabilities.
void Tracker::mix_classes(Track& track, const Sensor& sensor, std::span<const Plot> plots) {
  if (track.class_belief.size() == 0) return;
  class_mixture_ = events_.none() * track.class_belief;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    add_class_posterior(sensor, plots[events_.plot(i)], factor_[i] * events_.sum(i), track.class_belief,
                        class_mixture_);
  }
  track.class_belief = class_mixture_ / class_mixture_.sum();
}

LookOutcome Tracker::look_at_nearest(Track& track, const Sensor& sensor, std::span<const Plot> plots,
                                     std::span<const Track> others) {
  LookOutcome outcome;
  if (predict_measurements(sensor, settings_.update, track.estimate, measurements_) != Numerics::kOk) {
    fail(track);
    return outcome;
  }
  double best = -std::numeric_limits<double>::infinity();
  bool had_plots = false;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (!plots[i].z.allFinite()) continue;
    had_plots = true;
    if (!gated_innovations(track, sensor, plots[i])) continue;
    const double density = log_density(track) + std::log(declaration_ratio(sensor, plots[i], track.class_belief));
    if (!outcome.used_plot || density > best) {
      best = density;
      outcome.used_plot = i;
      best_innovations_ = innovations_;
    }
  }
  if (!outcome.used_plot) {
    miss(track, sensor, had_plots);
    reacquire(track, sensor, plots, others);
    return outcome;
  }
  const double nis = mixture_squared_distance(measurements_, track.estimate.probability, best_innovations_);
  const Numerics updated = take(sensor, plots[*outcome.used_plot], track);
  const Gaussian combined = combine(track.estimate);
  if (updated != Numerics::kOk || !is_finite(combined)) {
    fail(track);
    return {};
  }
  track.combined = combined;
  declare(track, sensor, plots[*outcome.used_plot]);
  track.nis = nis;
  track.status = TrackStatus::kConfirmed;
  track.restarted = false;
  track.rejections = 0;
  track.outlier.reset();
  track.log_miss_probability = 0.0;
  if (track.existence) track.existence = 1.0;  // without clutter a plot is proof
  return outcome;
}

/// Updates with a plot whose innovations are `best_innovations_`.
Numerics Tracker::take(const Sensor& sensor, const Plot& plot, Track& track) {
  if (!track.particles) return update(measurements_, best_innovations_, track.estimate);
  const Numerics updated = std::visit([&](auto& filter) { return filter.update(sensor, plot.z); }, *track.particles);
  if (updated == Numerics::kOk) track.estimate = estimate_of(*track.particles);
  return updated;
}

/// Fills `innovations_` and says whether the plot is in the gate of any mode.
bool Tracker::gated_innovations(const Track& track, const Sensor& sensor, const Plot& plot) {
  const double widening = 1.0 + track.rejections;
  const double limit = settings_.gate * widening * widening;
  const Vector2 z = measurement_of(sensor, settings_.update, plot.z);
  bool inside = false;
  for (std::size_t j = 0; j < measurements_.size(); ++j) {
    innovations_[j] = innovation(sensor, settings_.update, z, measurements_[j].z);
    inside = inside || measurements_[j].squared_distance(innovations_[j]) < limit;
  }
  return inside;
}

/// log sum_j c_j N(nu_j; 0, S_j).
double Tracker::log_density(const Track& track) const {
  double largest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t j = 0; j < measurements_.size(); ++j) {
    const double term = std::log(track.estimate.probability[j]) + measurements_[j].log_likelihood(innovations_[j]);
    if (term > largest) {
      sum = sum * std::exp(largest - term) + 1.0;
      largest = term;
    } else if (term > -std::numeric_limits<double>::infinity()) {
      sum += std::exp(term - largest);
    }
  }
  return largest + std::log(sum);
}

/// A look without a plot in the gate is evidence too, by Bayes: mu_j proportional to c_j (1 - P_d F_j), F_j the
/// probability that mode j's target is in the footprint. Modes whose target may well have left the beam gain.
void Tracker::miss(Track& track, const Sensor& sensor, bool had_plots) {
  if (had_plots) ++track.rejections;
  const State pointing = track.combined.mean;
  const double detection = std::min(sensor.detection_probability(pointing), kLargestBelievedDetection);
  double unseen = 1.0 - detection;
  if (sensor.footprint_half_extent().allFinite()) {  // without a beam a miss says the same of every mode
    std::array<double, kMostModes> missed{};
    unseen = 0.0;
    for (std::size_t j = 0; j < track.estimate.modes.size(); ++j) {
      missed[j] = 1.0 - detection * footprint_probability(sensor, track.estimate.modes[j], pointing);
      unseen += track.estimate.probability[static_cast<Eigen::Index>(j)] * missed[j];
    }
    if (weigh_modes(std::span(missed).first(track.estimate.modes.size()), track) != Numerics::kOk) return fail(track);
    track.combined = combine(track.estimate);
  }
  count_miss(track, detection);
  judge_existence(track, unseen);
}

/// Keeps the rejected plot that is nearest to the track. With that of the look before, and after so many looks that all
/// were misses is not to be believed, it is where the track begins anew: still coasting, until a plot confirms it.
void Tracker::reacquire(Track& track, const Sensor& sensor, std::span<const Plot> plots,
                        std::span<const Track> others) {
  const std::optional<Outlier> before = std::exchange(track.outlier, std::nullopt);
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t which = 0;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const std::optional<Vector2> place = plots[i].z.allFinite() ? sensor.position_of(plots[i].z) : std::nullopt;
    if (!place) continue;
    const double distance = (*place - position(track.combined.mean)).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    which = i;
    track.outlier = Outlier{plots[i].time, *place, position_noise(sensor, make_state(*place, Vector2::Zero()))};
  }
  const bool believed = track.log_miss_probability > std::log(settings_.reacquire_probability) + kLogRounding;
  if (!track.alive() || !before || !track.outlier || believed || sensor.clutter_density() > 0.0) return;
  const double interval_s = to_seconds(track.outlier->time - before->time);
  if (!(interval_s > 0.0)) return;
  const Gaussian pair = two_point(before->place, before->noise, track.outlier->place, track.outlier->noise, interval_s);
  const auto agrees = [&](const Gaussian& mode) {
    const Vector2 off = velocity(pair.mean) - velocity(mode.mean);
    const Matrix2 spread = (pair.covariance + mode.covariance)({kVx, kVy}, {kVx, kVy});
    return off.dot(spread.ldlt().solve(off)) < settings_.gate;
  };
  if (std::none_of(track.estimate.modes.begin(), track.estimate.modes.end(), agrees)) return;
  const auto has_it = [&](const Track& other) {
    char gated = 0;
    if (other.id != track.id && other.alive()) mark_gated(other, sensor, plots.subspan(which, 1), {&gated, 1});
    return gated != 0;
  };
  if (std::any_of(others.begin(), others.end(), has_it)) return;
  begin(track, pair);
  track.rejections = 0;
}

/// mu_j proportional to mu_j factor_j.
Numerics Tracker::weigh_modes(std::span<const double> factor, Track& track) const {
  if (track.particles) {
    const Numerics weighed = std::visit([&](auto& filter) { return filter.weigh(factor); }, *track.particles);
    if (weighed == Numerics::kOk) track.estimate = estimate_of(*track.particles);
    return weighed;
  }
  for (std::size_t j = 0; j < factor.size(); ++j) {
    track.estimate.probability[static_cast<Eigen::Index>(j)] *= factor[j];
  }
  track.estimate.probability /= track.estimate.probability.sum();
  return Numerics::kOk;
}

/// The run of misses is judged by P_d alone: a target that has left the beam is lost as well.
void Tracker::count_miss(Track& track, double detection) const {
  track.status = TrackStatus::kCoasting;
  track.log_miss_probability += std::log1p(-detection);
  const double limit = std::log(settings_.lost_probability) + kLogRounding;
  if (!track.existence && track.log_miss_probability <= limit) track.lose(LossCause::kNoPlots);
}

void Tracker::judge_existence(Track& track, double likelihood_ratio) const {
  if (!track.existence) return;
  track.existence = existence_after(*track.existence, likelihood_ratio);
  if (!track.tentative && *track.existence < settings_.existence.remove) track.lose(LossCause::kNoPlots);
}

}  // namespace dwell
