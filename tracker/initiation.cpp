#include "tracker/initiation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tracker/two_point.hpp"

namespace dwell {
namespace {

constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

/// Where along the first axis of the measurement the plots of a track may be: all gates lie within.
struct Window {
  double low;
  double high;
};

Window window_of(const Sensor& sensor, double gate, const ImmEstimate& estimate) {
  Window window{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const Matrix2 noise = sensor.noise(combined_mean(estimate));
  for (const Gaussian& mode : estimate.modes) {
    const double centre = sensor.measure(mode.mean)[0];
    const Eigen::Matrix<double, 1, kStateSize> h = sensor.jacobian(mode.mean).row(0);
    const double reach = std::sqrt(gate * (h.dot(h * mode.covariance) + noise(0, 0)));
    window.low = std::min(window.low, centre - reach);
    window.high = std::max(window.high, centre + reach);
  }
  return window;
}

std::size_t first_beyond(std::span<const Plot> plots, double range) {
  return static_cast<std::size_t>(
      std::lower_bound(plots.begin(), plots.end(), range, [](const Plot& plot, double r) { return plot.z[0] < r; }) -
      plots.begin());
}

}  // namespace

void TrackInitiation::look(Tracker& tracker, const Sensor& sensor, const Dwell& dwell, std::span<const Plot> plots,
                           std::span<const Track> confirmed, std::vector<Track>& found) {
  found.clear();
  withhold(tracker, sensor, plots, confirmed);
  advance(tracker, sensor, dwell);
  settle_disputes();
  confirm(tracker.settings().existence, tracker.settings().has_existence() && !settings_.m_of_n, found);
  begin(tracker, sensor);
}

void TrackInitiation::withhold(Tracker& tracker, const Sensor& sensor, std::span<const Plot> plots,
                               std::span<const Track> confirmed) {
  withheld_.assign(plots.size(), 0);
  for (const Track& track : confirmed) {
    if (track.alive()) tracker.mark_gated(track, sensor, plots, withheld_);
  }
  free_.clear();
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (withheld_[i] == 0 && plots[i].z.allFinite()) free_.push_back(plots[i]);
  }
  std::sort(free_.begin(), free_.end(),
            [](const Plot& a, const Plot& b) { return a.z[0] != b.z[0] ? a.z[0] < b.z[0] : a.z[1] < b.z[1]; });
}

void TrackInitiation::advance(Tracker& tracker, const Sensor& sensor, const Dwell& dwell) {
  for (Tentative& tentative : tentative_) {
    Track& track = tentative.track;
    for (int scan = 0; scan < scans_ && track.alive(); ++scan) tracker.predict(track);
    if (track.alive() && !sensor.covers(track.combined.mean)) track.lose(LossCause::kNoPlots);
    if (!track.alive()) continue;
    const Window window = window_of(sensor, tracker.settings().gate, track.estimate);
    const std::size_t first = first_beyond(free_, window.low);
    const std::size_t count = first_beyond(free_, window.high) - first;
    const LookOutcome outcome = tracker.survey(track, sensor, dwell, std::span(free_).subspan(first, count));
    ++tentative.looks;
    tentative.plot = outcome.used_plot ? std::optional(first + *outcome.used_plot) : std::nullopt;
    if (tentative.plot) ++tentative.plots;
  }
}

bool TrackInitiation::outranks(const Tentative& one, const Tentative& other) const {
  const double existence = one.track.existence.value_or(0.0);
  const double other_existence = other.track.existence.value_or(0.0);
  return existence != other_existence ? existence > other_existence : one.plots > other.plots;
}

void TrackInitiation::settle_disputes() {
  owner_.assign(free_.size(), kNobody);
  for (std::size_t i = 0; i < tentative_.size(); ++i) {
    Tentative& tentative = tentative_[i];
    if (!tentative.track.alive() || !tentative.plot) continue;
    std::size_t& owner = owner_[*tentative.plot];
    if (owner == kNobody) {
      owner = i;
    } else if (outranks(tentative, tentative_[owner])) {
      tentative_[owner].track.lose(LossCause::kNoPlots);
      owner = i;
    } else {
      tentative.track.lose(LossCause::kNoPlots);
    }
  }
}

void TrackInitiation::confirm(const ExistenceSettings& existence, bool by_existence, std::vector<Track>& found) {
  const MOfN rule = settings_.m_of_n.value_or(MOfN{});
  std::size_t kept = 0;
  for (Tentative& tentative : tentative_) {
    if (!tentative.track.alive()) continue;
    const bool confirmed =
        by_existence ? tentative.track.existence.value_or(0.0) > existence.confirm : tentative.plots >= rule.plots;
    const double existence_now = tentative.track.existence.value_or(1.0);
    const bool hopeless = by_existence ? existence_now < kHopeless * tentative.first_odds * (1.0 - existence_now)
                                       : tentative.looks - tentative.plots > rule.looks - rule.plots;
    if (confirmed) {
      tentative.track.tentative = false;
      found.push_back(std::move(tentative.track));
    } else if (!hopeless) {
      if (&tentative_[kept] != &tentative) tentative_[kept] = std::move(tentative);
      ++kept;
    }
  }
  tentative_.erase(tentative_.begin() + static_cast<std::ptrdiff_t>(kept), tentative_.end());
}

void TrackInitiation::begin_with(Track track) {
  const double existence = track.existence.value_or(0.5);
  tentative_.push_back({.track = std::move(track), .first_odds = existence / (1.0 - existence), .plot = {}});
}

void TrackInitiation::begin(Tracker& tracker, const Sensor& sensor) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (owner_[i] == kNobody) free_[kept++] = free_[i];
  }
  free_.resize(kept);
  const double reach_m = settings_.largest_speed_mps * interval_s_;
  for (const Plot& second : free_) {
    const std::optional<Vector2> place = sensor.position_of(second.z);
    if (!place) continue;
    // The noise of both plots, with room for that of the first being greater where it is farther away.
    const double noise = std::sqrt(2.0 * position_noise(sensor, make_state(*place, Vector2::Zero())).trace());
    const double reach = reach_m + 6.0 * noise;
    for (std::size_t i = first_beyond(previous_, second.z[0] - reach); i < previous_.size(); ++i) {
      if (previous_[i].z[0] > second.z[0] + reach) break;
      if (auto track = pair(tracker, sensor, previous_[i], second)) begin_with(std::move(*track));
    }
  }
  std::swap(previous_, free_);
}

double TrackInitiation::existence_of_pair(const ExistenceSettings& existence, const Sensor& sensor,
                                          const State& x) const {
  constexpr double kLikeliest = 0.5;
  const double p_d = sensor.detection_probability(x);
  const double right = existence.new_targets_per_hour * interval_s_ / 3600.0 * p_d * p_d;
  const double reach_m = settings_.largest_speed_mps * interval_s_;
  const double partners = clutter_density(sensor, UpdateForm::kConverted, x) * std::numbers::pi * reach_m * reach_m;
  const auto coverage = sensor.coverage();
  const double volume = coverage ? 4.0 * coverage->half.prod() : 0.0;
  const double wrong = sensor.clutter_density() * volume * partners;
  return std::min(kLikeliest, right / (right + wrong));
}

std::optional<Track> TrackInitiation::pair(Tracker& tracker, const Sensor& sensor, const Plot& first,
                                           const Plot& second) const {
  const std::optional<Vector2> from = sensor.position_of(first.z);
  const std::optional<Vector2> to = sensor.position_of(second.z);
  if (!from || !to) return std::nullopt;
  const Vector2 step = *to - *from;
  const Matrix2 r1 = position_noise(sensor, make_state(*from, Vector2::Zero()));
  const Matrix2 r2 = position_noise(sensor, make_state(*to, Vector2::Zero()));
  const double noise = std::sqrt((r1 + r2).trace());
  if (step.norm() > settings_.largest_speed_mps * interval_s_ + 3.0 * noise) return std::nullopt;
  const Gaussian belief = two_point(*from, r1, *to, r2, interval_s_);
  Track track = tracker.start(TrackId{}, "", belief);
  tracker.declare(track, sensor, first);
  tracker.declare(track, sensor, second);
  track.tentative = true;
  if (track.existence) track.existence = existence_of_pair(tracker.settings().existence, sensor, belief.mean);
  return track;
}

}  // namespace dwell
