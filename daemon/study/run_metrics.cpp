#include "daemon/study/run_metrics.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "bandit/catalogue.hpp"
#include "daemon/calibration_loop.hpp"
#include "radar/assert.hpp"
#include "tracker/metrics/continuity.hpp"
#include "tracker/metrics/mode_error.hpp"
#include "tracker/metrics/nees.hpp"
#include "tracker/metrics/nis.hpp"
#include "tracker/metrics/track_loss.hpp"

namespace dwell {
namespace {

const std::vector<std::string> kTotals{"x_variance_m2",
                                       "position_variance_m2",
                                       "weighted_variance_m2",
                                       "position_rms_m",
                                       "x_rms_m",
                                       "y_rms_m",
                                       "position_mse_m2",
                                       "weighted_mse_m2",
                                       "nees",
                                       "mode_errors",
                                       "tracks_lost",
                                       "starvation_scans",
                                       "cramer_rao_rms_m",
                                       "nis_in_band",
                                       "tracks_off_beam",
                                       "completeness",
                                       "track_breaks",
                                       "confirm_latency_s",
                                       "false_tracks_per_h",
                                       "answered"};

/// Sums of one target over the scans that count.
struct TargetSums {
  double scans = 0.0;
  double x_variance = 0.0;
  double position_variance = 0.0;
  double squared_x = 0.0;
  double squared_y = 0.0;
  double updates = 0.0;
  double nees = 0.0;
  double nis_in_band = 0.0;
  double off_beam = 0.0;  // tracks
  double mode_errors = 0.0;
  double bound = 0.0;
  double looks = 0.0;
  int starving = 0;    // scans since the last look
  int starvation = 0;  // the longest of them
  TrackId track;       // of the target's present life
  TrackId off_beam_track;
  std::optional<CramerRaoBound> cramer_rao;
};

/// The motion over the scan period that ends at `time`, as the bound takes the truth to move: as its script says,
/// whose legs are known; by its true mode; by the bank's first mode where the truth is recorded.
struct BoundMotion {
  const DiscreteBank& bank;
  double dt_s;
  TimePoint time;
  std::optional<int> mode;

  void operator()(const ScriptedMotion& motion, StateMatrix& f, StateMatrix& q) const {
    f = transition(ConstantVelocity{}, dt_s);
    q = motion.process_noise_root * motion.process_noise_root.transpose();
    for (const Leg& leg : motion.legs) {
      if (time <= leg.start || time > leg.end) continue;
      if (leg.turn_rate_radps != 0.0) f = transition(CoordinatedTurn{leg.turn_rate_radps}, dt_s);
      q *= leg.process_noise_scale;
    }
  }
  void operator()(const JumpMarkovMotion& motion, StateMatrix& f, StateMatrix& q) const {
    const auto index = static_cast<std::size_t>(mode.value_or(0));
    const StateMatrix& root = motion.system.process_noise_root[index];
    f = motion.system.transition_matrix[index];
    q = root * root.transpose();
  }
  void operator()(const RecordedMotion& /*motion*/, StateMatrix& f, StateMatrix& q) const {
    f = bank.f.front();
    q = bank.q.front();
  }
};

class Measurer {
 public:
  Measurer(const EngineConfig& config, const TimeWindow& window)
      : config_(config),
        window_(window),
        bank_(*discretise(config.bank, to_seconds(config.scan_period))),
        targets_(config.targets.size()),
        looks_(config.sensors.size()) {}

  ScanSample add(const Engine& engine) {
    const ScanReport& report = engine.last();
    const double time_s = to_seconds(report.time);
    const bool counts = time_s >= window_.first_s && time_s <= window_.last_s;
    ScanSample sample;
    if (!report.looks.empty()) {
      sample.sensor = static_cast<int>(report.looks.front().dwell.radar.number);
      sample.track = static_cast<int>(report.looks.front().dwell.track.number);
    }
    double weighted = 0.0;
    double weighted_error = 0.0;
    auto track = engine.tracks().begin();
    for (const TruthReport& truth : report.truth) {
      while (track->id != truth.track) ++track;
      add_track(engine, truth, *track, counts, sample);
      weighted += track->weight * position_block(track->combined.covariance).trace();
      weighted_error += track->weight * (position(truth.state) - position(track->combined.mean)).squaredNorm();
    }
    if (counts) {
      for (const TargetTruth& target : engine.living_targets()) {
        const auto truth = std::find_if(report.truth.begin(), report.truth.end(),
                                        [&](const TruthReport& of_track) { return of_track.life == target.id; });
        lives_[target.id].add(report.time, truth == report.truth.end() ? std::nullopt : std::optional(truth->track));
      }
      false_ += static_cast<double>(engine.counts().tracks_false - false_before_);
      weighted_variance_ += weighted;
      weighted_error_ += weighted_error;
      decisions_ += report.decision.candidates.empty() ? 0.0 : 1.0;
      fell_back_ += report.decision.fell_back ? 1.0 : 0.0;
      ++scans_;
      for (const LookReport& look : report.looks) looks_[look.dwell.radar.number - 1] += 1.0;
      lost_ += static_cast<double>(engine.counts().tracks_lost - lost_before_);
    }
    lost_before_ = engine.counts().tracks_lost;
    false_before_ = engine.counts().tracks_false;
    return sample;
  }

  std::vector<double> figures() const {
    TargetSums all;
    for (const TargetSums& target : targets_) {
      all.scans += target.scans;
      all.x_variance += target.x_variance;
      all.position_variance += target.position_variance;
      all.squared_x += target.squared_x;
      all.squared_y += target.squared_y;
      all.updates += target.updates;
      all.nees += target.nees;
      all.nis_in_band += target.nis_in_band;
      all.off_beam += target.off_beam;
      all.mode_errors += target.mode_errors;
      all.bound += target.bound;
      all.starvation = std::max(all.starvation, target.starvation);
    }
    double present = 0.0, tracked = 0.0, breaks = 0.0, latency_s = 0.0, found = 0.0;
    for (const auto& [id, life] : lives_) {
      present += life.scans();
      tracked += life.tracked();
      breaks += life.breaks();
      latency_s += life.latency_s().value_or(0.0);
      found += life.latency_s() ? 1.0 : 0.0;
    }
    const double hours = scans_ * to_seconds(config_.scan_period) / 3600.0;
    const double scans = std::max(all.scans, 1.0);
    std::vector<double> figures{all.x_variance / scans,
                                all.position_variance / scans,
                                weighted_variance_ / std::max(scans_, 1.0),
                                std::sqrt((all.squared_x + all.squared_y) / scans),
                                std::sqrt(all.squared_x / scans),
                                std::sqrt(all.squared_y / scans),
                                (all.squared_x + all.squared_y) / scans,
                                weighted_error_ / std::max(scans_, 1.0),
                                all.nees / std::max(all.updates, 1.0),
                                all.mode_errors,
                                lost_,
                                static_cast<double>(all.starvation),
                                std::sqrt(all.bound / scans),
                                all.nis_in_band / std::max(all.updates, 1.0),
                                all.off_beam,
                                tracked / std::max(present, 1.0),
                                breaks,
                                latency_s / std::max(found, 1.0),
                                hours > 0.0 ? false_ / hours : 0.0,
                                decisions_ > 0.0 ? 1.0 - fell_back_ / decisions_ : 1.0};
    DWELL_ASSERT(figures.size() == kTotals.size());
    figures.insert(figures.end(), looks_.begin(), looks_.end());
    for (const TargetSums& target : targets_) figures.push_back(target.looks);
    for (const TargetSums& target : targets_) {
      figures.push_back(std::sqrt((target.squared_x + target.squared_y) / std::max(target.scans, 1.0)));
    }
    return figures;
  }

 private:
  void add_track(const Engine& engine, const TruthReport& truth, const Track& track, bool counts, ScanSample& sample) {
    const std::size_t index = truth.target;
    TargetSums& sums = targets_[index];
    const Vector2 error = position(truth.state) - position(track.combined.mean);
    const double variance = position_block(track.combined.covariance).trace();
    sample.tracks += 1.0;
    sample.squared_x_error_m2 += error.x() * error.x();
    sample.squared_y_error_m2 += error.y() * error.y();
    sample.position_variance_m2 += variance;
    bool looked = false;
    bool updated = false;
    advance_bound(engine, truth, track, looked, updated);
    if (!counts) return;
    sums.looks += looked ? 1.0 : 0.0;
    sums.starving = looked ? 0 : sums.starving + 1;
    sums.starvation = std::max(sums.starvation, sums.starving);
    sums.scans += 1.0;
    sums.x_variance += track.combined.covariance(kX, kX);
    sums.position_variance += variance;
    sums.squared_x += error.x() * error.x();
    sums.squared_y += error.y() * error.y();
    sums.bound += position_block(sums.cramer_rao->covariance()).trace();
    if (truth.mode && mode_is_wrong(index, *truth.mode, track)) sums.mode_errors += 1.0;
    if (updated) {
      sums.nees += nees(truth.state, track.combined);
      sums.nis_in_band += track.nis && kNisBand.contains(*track.nis) ? 1.0 : 0.0;
      sums.updates += 1.0;
    }
    for (const LookReport& look : engine.last().looks) {
      if (look.dwell.track != track.id || sums.off_beam_track == track.id) continue;
      const Sensor& sensor = *engine.sensors()[look.dwell.radar.number - 1];
      if (!is_lost(sensor, truth.state, look.dwell.pointing, sensor.footprint_half_extent())) continue;
      sums.off_beam += 1.0;
      sums.off_beam_track = track.id;
    }
  }

  /// Also says whether the track was looked at, and updated.
  void advance_bound(const Engine& engine, const TruthReport& truth, const Track& track, bool& looked, bool& updated) {
    TargetSums& sums = targets_[truth.target];
    const TargetConfig& target = config_.targets[truth.target];
    const ScanReport& report = engine.last();
    const auto* cued = std::get_if<CuedStart>(&target.track_start);
    const bool begins = !sums.cramer_rao || sums.track != track.id;
    const bool by_plot = begins && cued == nullptr;  // then the bound begins with what the first scan left
    if (begins) {
      sums.cramer_rao.emplace(by_plot ? track.combined.covariance : cued->covariance);
      sums.track = track.id;
    }
    if (track.age_scans > 0 && !by_plot) {
      StateMatrix f, q;
      const BoundMotion motion{bank_, to_seconds(config_.scan_period), report.time, truth.mode};
      std::visit([&](const auto& of_target) { motion(of_target, f, q); }, target.motion);
      sums.cramer_rao->predict(f, q);
    }
    for (const LookReport& look : report.looks) {
      if (look.dwell.track != track.id) continue;
      looked = true;
      updated = look.used_plot.has_value();
      if (!updated || by_plot) continue;
      sums.cramer_rao->look(*engine.sensors()[look.dwell.radar.number - 1], truth.state);
    }
  }

  bool mode_is_wrong(std::size_t target, int true_mode, const Track& track) const {
    const auto likeliest = static_cast<std::size_t>(likeliest_mode(track.estimate));
    const auto* motion = std::get_if<JumpMarkovMotion>(&config_.targets[target].motion);
    const auto& names = motion->mode_names;
    return config_.bank.modes[likeliest].name != names[static_cast<std::size_t>(true_mode)];
  }

  const EngineConfig& config_;
  TimeWindow window_;
  DiscreteBank bank_;
  std::vector<TargetSums> targets_;
  std::vector<double> looks_;  // of each sensor
  std::map<TargetId, Continuity> lives_;
  double lost_ = 0.0;
  std::uint64_t lost_before_ = 0;
  double false_ = 0.0;
  std::uint64_t false_before_ = 0;
  double weighted_variance_ = 0.0;
  double weighted_error_ = 0.0;
  double decisions_ = 0.0;
  double fell_back_ = 0.0;
  double scans_ = 0.0;
};

class TimedPolicy final : public Policy {
 public:
  TimedPolicy(std::unique_ptr<Policy> policy, std::vector<double>& decision_us)
      : policy_(std::move(policy)), decision_us_(decision_us) {}

  std::string_view name() const override { return policy_->name(); }
  void decide(const Situation& situation, Decision& decision) override {
    const auto before = std::chrono::steady_clock::now();
    policy_->decide(situation, decision);
    const auto took = std::chrono::steady_clock::now() - before;
    decision_us_.push_back(std::chrono::duration<double, std::micro>(took).count());
  }

 private:
  void score(const Situation& /*situation*/, std::span<Candidate> /*candidates*/) override {}

  std::unique_ptr<Policy> policy_;
  std::vector<double>& decision_us_;
};

}  // namespace

std::unique_ptr<Policy> timed(std::unique_ptr<Policy> policy, std::vector<double>& decision_us) {
  return std::make_unique<TimedPolicy>(std::move(policy), decision_us);
}

std::vector<std::string> metric_names(const EngineConfig& config) {
  std::vector<std::string> names = kTotals;
  for (const SensorConfig& sensor : config.sensors) names.push_back("looks.radar." + sensor.name);
  for (const TargetConfig& target : config.targets) names.push_back("looks.track." + target.name);
  for (const TargetConfig& target : config.targets) names.push_back("position_rms_m.track." + target.name);
  return names;
}

RunResult run_and_measure(const EngineConfig& config, std::uint64_t scans, const TimeWindow& window) {
  Engine engine(config);
  CalibrationLoop calibration(engine);
  const bool calibrates = engine.calibrator().applies();  // what only observes changes no figure
  Measurer measurer(engine.config(), window);
  RunResult result;
  result.scans.reserve(scans);
  result.decision_us.reserve(scans);
  engine.set_policy(timed(make_policy(config.policy), result.decision_us));
  while (engine.last().scan < scans) {
    if (calibrates) (void)calibration.before_scan();
    engine.scan();
    if (calibrates) calibration.after_scan();
    result.scans.push_back(measurer.add(engine));
  }
  result.figures = measurer.figures();
  return result;
}

}  // namespace dwell
