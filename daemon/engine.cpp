#include "daemon/engine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "bandit/catalogue.hpp"
#include "bandit/value_table.hpp"
#include "daemon/make.hpp"
#include "radar/assert.hpp"
#include "tracker/metrics/nees.hpp"

namespace dwell {
namespace {

constexpr int kFarLooksToLose = 5;

DiscreteBank bank_of(const EngineConfig& config) {
  auto bank = discretise(config.bank, to_seconds(config.scan_period));
  DWELL_ASSERT(bank.has_value());  // the config reader has refused the others
  return std::move(*bank);
}

std::vector<std::unique_ptr<Sensor>> beliefs_of(const EngineConfig& config) {
  std::vector<std::unique_ptr<Sensor>> beliefs;
  for (const SensorConfig& sensor : config.sensors) beliefs.push_back(make_sensor(sensor));
  return beliefs;
}

/// Room for the plots of a look: every target, and more false alarms than a Poisson count of that mean has once in
/// 1e20.
std::size_t most_plots(const Sensor& sensor, const Vector2& half, std::size_t targets) {
  if (sensor.clutter_density() <= 0.0) return targets;
  const double mean = sensor.clutter_density() * 4.0 * half[0] * half[1];
  return targets + static_cast<std::size_t>(mean + 10.0 * std::sqrt(mean) + 20.0);
}

}  // namespace

/// A target of the config, in its present life.
struct Engine::Target {
  const TargetConfig* config;
  TargetId id;
  int life = 1;  // counts the repeats of a recording
  TimePoint start;
  std::unique_ptr<Trajectory> trajectory;
  std::optional<State> state;  // where it is now
  bool tracked = false;        // has had its track in this life
  RandomStream start_stream;   // of how its track begins
  RandomStream class_stream;   // of what it is
  std::optional<int> target_class = std::nullopt;

  /// Names of its random streams and of its track: the config's, with the life from the second on.
  std::string name() const { return life == 1 ? config->name : config->name + "#" + std::to_string(life); }
};

/// What a track begins with: by a plot, the sensor that it is of as well.
struct Engine::FirstBelief {
  Gaussian gaussian;
  std::size_t sensor = 0;
  std::optional<Plot> plot = std::nullopt;
};

/// Track initiation by one sensor.
struct Engine::Surveillance {
  std::size_t sensor;
  RandomStream stream;
  TrackInitiation initiation;
};

/// What the simulation knows of a track and the tracker does not.
struct Engine::TruthLink {
  static constexpr std::size_t kNoTarget = static_cast<std::size_t>(-1);

  std::size_t target;  // index of targets_, or kNoTarget of a false track
  TargetId id;         // of the life that the track was started for
  int far_looks = 0;   // consecutive detected looks with the truth far from the prediction
};

Engine::Engine(const EngineConfig& config)
    : config_(config),
      root_(config.seed),
      policy_stream_(root_.fork("policy")),
      tracker_(bank_of(config), config.bank.initial_probability, config.tracker, root_.fork("particles")),
      policy_(make_policy(config.policy)),
      beliefs_(beliefs_of(config)),
      calibrator_(config, beliefs_) {
  if (config_.value_table == nullptr) config_.value_table = std::make_shared<ValueTable>();
  for (const SensorConfig& sensor : config_.sensors) {
    sensors_.push_back(make_sensor(sensor));
    sensor_views_.push_back(beliefs_[sensors_.size() - 1].get());
    sensor_streams_.push_back(root_.fork("radar/" + sensor.name));
    usage_cost_.push_back(sensor.usage_cost);
    sensor_states_.push_back({sensor.up, LookBudget(sensor.budget)});
    if (sensor.surveillance_scans > 0) {
      surveillance_.push_back(
          {sensors_.size() - 1, sensor_streams_.back().fork("surveillance"),
           TrackInitiation(config.initiation, sensor.surveillance_scans, to_seconds(config.scan_period))});
    }
  }
  set_faults();
  std::size_t most = 0;
  const std::size_t targets = config_.targets.size();
  for (const auto& sensor : sensors_) {
    most = std::max(most, most_plots(*sensor, sensor->footprint_half_extent(), targets));
  }
  tracker_.reserve(most);
  look_plots_.reserve(most);
  others_plots_.reserve(most);
  for (const Surveillance& surveillance : surveillance_) {
    const Sensor& sensor = *sensors_[surveillance.sensor];
    look_plots_.reserve(most_plots(sensor, sensor.coverage()->half, targets));
  }
  report_.plots.reserve(most * static_cast<std::size_t>(config_.looks_per_scan));
  owed_.reserve(2);
  counts_.looks.resize(sensors_.size());
  counts_.detections.resize(sensors_.size());
  for (const TargetConfig& target : config_.targets) {
    targets_.push_back({&target, TargetId{++last_target_number_}, 0, {}, nullptr, {}, false, root_, root_});
    begin_life(targets_.back(), target.start);
  }
  advance_truth();
  start_tracks();
}

Engine::~Engine() = default;

const ScanReport& Engine::scan() {
  ++report_.scan;
  report_.time += config_.scan_period;
  for (SensorState& sensor : sensor_states_) sensor.budget.next_scan();
  drop_lost_tracks();
  set_faults();
  calibrator_.move_beliefs(report_.scan);
  advance_truth();
  predict_tracks();
  start_tracks();
  list_feasible_pairs();
  find_owed();
  choose();
  for (std::size_t look = 0; look < report_.decision.chosen.size(); ++look) execute(report_.decision.pair(look));
  survey();
  count_losses();
  report_truth();
  return report_;
}

void Engine::set_policy(const PolicySettings& settings) {
  config_.policy = settings;
  policy_ = make_policy(settings);
}

void Engine::drop_lost_tracks() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!tracks_[i].alive()) continue;
    if (kept != i) {
      tracks_[kept] = std::move(tracks_[i]);
      links_[kept] = links_[i];
    }
    ++kept;
  }
  tracks_.resize(kept);
  links_.resize(kept, TruthLink{});
}

void Engine::advance_truth() {
  truth_.clear();
  for (Target& target : targets_) {
    if (target.trajectory->ended(report_.time)) restart(target);
    target.state = target.trajectory->advance(report_.time);
    if (target.state) truth_.push_back({target.id, *target.state, target.target_class});
  }
}

/// A repeated recording begins again, as a new target, at the first scan after its end.
void Engine::restart(Target& target) {
  const auto* recorded = std::get_if<RecordedMotion>(&target.config->motion);
  if (recorded == nullptr || !recorded->repeat) return;
  target.id = TargetId{++last_target_number_};
  begin_life(target, report_.time);
}

void Engine::begin_life(Target& target, TimePoint start) {
  ++target.life;
  target.start = start;
  target.tracked = false;
  const std::string name = target.name();
  target.trajectory = make_trajectory(*target.config, start, config_.scan_period, root_, name);
  target.start_stream = root_.fork("track/" + name + "/start");
  if (config_.tracker.classes.size() == 0) return;
  target.class_stream = root_.fork("target/" + name + "/class");
  const int drawn = draw_index(config_.tracker.classes.prior.transpose(), target.class_stream);
  target.target_class = target.config->target_class.value_or(drawn);
}

void Engine::predict_tracks() {
  for (Track& track : tracks_) tracker_.predict(track);
}

void Engine::start_tracks() {
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (!targets_[i].tracked && targets_[i].state) start_track(i);
  }
}

/// What the track of a target begins with; empty where no plot has come yet.
std::optional<Engine::FirstBelief> Engine::first_belief(std::size_t target) {
  const Target& truth = targets_[target];
  RandomStream stream = truth.start_stream;
  if (const auto* cued = std::get_if<CuedStart>(&truth.config->track_start)) {
    State draw;
    for (double& value : draw) value = stream.normal();
    const StateMatrix root = cued->covariance.llt().matrixL();
    return FirstBelief{{*truth.state + root * draw, cued->covariance}};
  }
  if (std::holds_alternative<NoStart>(truth.config->track_start)) return std::nullopt;
  const auto& first_plot = std::get<FirstPlotStart>(truth.config->track_start);
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const Dwell dwell{RadarId{static_cast<std::uint32_t>(i + 1)}, TrackId{}, report_.time, *truth.state};
    if (!sensor_states_[i].up) continue;
    const TargetTruth alone{truth.id, *truth.state, truth.target_class};
    simulate_look(*sensors_[i], dwell, std::span(&alone, 1), stream.fork(i), look_plots_);
    for (const Plot& plot : look_plots_) {
      if (!plot.source) continue;
      const auto belief = Tracker::belief_from(plot, *beliefs_[i], first_plot.speed_sigma_mps);
      if (belief) return FirstBelief{*belief, i, plot};
    }
  }
  return std::nullopt;
}

void Engine::start_track(std::size_t target) {
  const std::optional<FirstBelief> belief = first_belief(target);
  if (!belief) return;
  Target& truth = targets_[target];
  tracks_.push_back(tracker_.start(TrackId{++last_track_number_}, truth.name(), belief->gaussian));
  tracker_.set_target_weight(tracks_.back(), truth.config->weight);
  if (belief->plot) tracker_.declare(tracks_.back(), *beliefs_[belief->sensor], *belief->plot);
  links_.push_back({target, truth.id});
  truth.tracked = true;
}

void Engine::list_feasible_pairs() {
  feasible_.clear();
  for (std::size_t track = 0; track < tracks_.size(); ++track) {
    if (!tracks_[track].alive()) continue;
    bool covered = false;
    for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor) {
      const SensorState& state = sensor_states_[sensor];
      if (!state.up || !beliefs_[sensor]->covers(tracks_[track].combined.mean)) continue;
      covered = true;
      if (state.budget.allows()) feasible_.push_back({sensor, track});
    }
    if (!covered) tracks_[track].status = TrackStatus::kCoasting;
  }
}

/// The radar that calibration wants a look of, and the feasible track that has waited longest, where that is too long:
/// no policy starves a track. The track, where there is one look for both, has its own a scan later.
void Engine::find_owed() {
  owed_.clear();
  if (const auto sensor = calibrator_.owed(report_.scan, feasible_)) owed_.push_back({sensor, {}});
  if (config_.max_wait_turns == 0 || feasible_.empty()) return;
  const auto waits = [&](const Pair& pair) { return tracks_[pair.track].unseen_scans; };
  const Pair& oldest = *std::max_element(feasible_.begin(), feasible_.end(),
                                         [&](const Pair& a, const Pair& b) { return waits(a) < waits(b); });
  const auto living = std::count_if(tracks_.begin(), tracks_.end(), [](const Track& track) { return track.alive(); });
  const auto limit = static_cast<double>(config_.max_wait_turns) * static_cast<double>(living) / config_.looks_per_scan;
  if (waits(oldest) > limit) owed_.push_back({{}, oldest.track});
}

void Engine::choose() {
  const Situation situation{.time = report_.time,
                            .looks = config_.looks_per_scan,
                            .update = config_.tracker.update,
                            .bank = &tracker_.bank(),
                            .random = policy_stream_.fork(report_.scan),
                            .sensors = sensor_views_,
                            .states = sensor_states_,
                            .usage_cost = usage_cost_,
                            .tracks = tracks_,
                            .feasible = feasible_,
                            .owed = owed_,
                            .scan_period_s = to_seconds(config_.scan_period),
                            .classes = &config_.tracker.classes,
                            .value_table = config_.value_table.get()};
  policy_->decide(situation, report_.decision);
  report_.policy = policy_->name();
  report_.looks.clear();
  report_.plots.clear();
}

/// The truth of each radar as it is now.
void Engine::set_faults() {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    auto* radar = dynamic_cast<CorrectedRadar*>(sensors_[i].get());
    if (radar == nullptr) continue;
    CorrectionVector correction = to_vector(config_.sensors[i].truth.correction);
    double detection = config_.sensors[i].truth.detection_scale;
    double clutter = config_.sensors[i].truth.clutter_scale;
    for (const RadarFault& fault : config_.sensors[i].faults) {
      if (report_.time < fault.start || report_.time >= fault.end) continue;
      correction += to_vector(fault.change.correction);
      detection *= fault.change.detection_scale;
      clutter *= fault.change.clutter_scale;
    }
    radar->set_correction(to_correction(correction));
    radar->set_detection_scale(detection);
    radar->set_clutter_density(clutter * radar->figures().clutter_density);
  }
}

/// The chosen sensor looks, and the track the look was made for is updated: the link carries one report.
void Engine::execute(const Pair& pair) {
  Track& track = tracks_[pair.track];
  LookReport look;
  look.dwell = {RadarId{static_cast<std::uint32_t>(pair.sensor + 1)}, track.id, report_.time, track.combined.mean};
  move_class_of(pair.track);
  simulate_look(*sensors_[pair.sensor], look.dwell, truth_, sensor_streams_[pair.sensor], look_plots_);
  look.first_plot = report_.plots.size();
  look.plots = look_plots_.size();
  report_.plots.insert(report_.plots.end(), look_plots_.begin(), look_plots_.end());
  compare_with_truth(pair.track);
  if (calibrator_.on()) before_look_ = track.estimate;
  const LookOutcome outcome = tracker_.look(track, *beliefs_[pair.sensor], look.dwell, look_plots_, tracks_);
  if (calibrator_.on()) {
    mark_others_plots(pair, look.dwell.pointing, outcome);
    calibrator_.add(report_.scan, look.dwell, before_look_, look_plots_, others_plots_, outcome.used_plot,
                    known_state(pair.track));
  }
  if (outcome.used_plot) look.used_plot = look.first_plot + *outcome.used_plot;
  sensor_states_[pair.sensor].budget.take();
  ++counts_.looks[pair.sensor];
  if (outcome.used_plot) ++counts_.detections[pair.sensor];
  if (links_[pair.track].far_looks >= kFarLooksToLose && track.alive()) track.lose(LossCause::kFromTruth);
  report_.looks.push_back(look);
}

/// A look is about to be made for the track: its target's class moves. By the number of such looks alone, so that it
/// takes the same path under every policy.
void Engine::move_class_of(std::size_t track) {
  const TruthLink& link = links_[track];
  if (!config_.tracker.classes.move() || link.target == TruthLink::kNoTarget) return;
  Target& target = targets_[link.target];
  const auto truth = std::find_if(truth_.begin(), truth_.end(), [&](const TargetTruth& t) { return t.id == link.id; });
  if (target.id != link.id || truth == truth_.end() || !target.target_class) return;
  target.target_class = draw_index(config_.tracker.classes.transition.row(*target.target_class), target.class_stream);
  truth->target_class = target.target_class;
}

/// Before the update: how far the truth is from the prediction, at looks that saw the target.
void Engine::compare_with_truth(std::size_t track) {
  TruthLink& link = links_[track];
  if (link.target == TruthLink::kNoTarget) return;
  const Target& target = targets_[link.target];
  const bool same_life = target.id == link.id && target.state;
  const bool detected =
      std::any_of(look_plots_.begin(), look_plots_.end(), [&](const Plot& plot) { return plot.source == link.id; });
  if (!same_life || !detected) return;
  const bool far = position_nees(*target.state, tracks_[track].combined) > config_.lost_squared_distance;
  link.far_looks = far ? link.far_looks + 1 : 0;
}

/// The surveillance looks that are due; tracks that they confirm join the others from the next scan on.
void Engine::survey() {
  for (Surveillance& surveillance : surveillance_) {
    const auto period = static_cast<std::uint64_t>(config_.sensors[surveillance.sensor].surveillance_scans);
    if (report_.scan % period != 0) continue;
    const Sensor& sensor = *sensors_[surveillance.sensor];
    const Dwell dwell{RadarId{static_cast<std::uint32_t>(surveillance.sensor + 1)}, TrackId{}, report_.time, {}};
    look_plots_.clear();
    if (sensor_states_[surveillance.sensor].up) {
      simulate_survey(sensor, dwell, truth_, surveillance.stream, look_plots_);
    }
    surveillance.initiation.look(tracker_, *beliefs_[surveillance.sensor], dwell, look_plots_, tracks_, found_);
    for (Track& track : found_) hand_over(std::move(track));
  }
}

/// In the simulation the track is of the nearest target, or of none where that is outside a 16-gate.
void Engine::hand_over(Track track) {
  constexpr double kGate = 16.0;
  track.id = TrackId{++last_track_number_};
  TruthLink link{TruthLink::kNoTarget, {}};
  double nearest = kGate;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (!targets_[i].state) continue;
    const double distance = position_nees(*targets_[i].state, track.combined);
    if (distance < nearest) {
      nearest = distance;
      link = {i, targets_[i].id};
    }
  }
  ++counts_.tracks_initiated;
  if (link.target == TruthLink::kNoTarget) {
    ++counts_.tracks_false;
  } else {
    track.name = targets_[link.target].name();
    tracker_.set_target_weight(track, targets_[link.target].config->weight);
  }
  tracks_.push_back(std::move(track));
  links_.push_back(link);
}

/// The plots of a look that were not used and may be of another track.
void Engine::mark_others_plots(const Pair& pair, const State& pointing, const LookOutcome& outcome) {
  others_plots_.assign(look_plots_.size(), 0);
  if (look_plots_.size() == (outcome.used_plot ? 1 : 0)) return;
  const Sensor& sensor = *beliefs_[pair.sensor];
  const Vector2 near = 2.0 * sensor.footprint_half_extent();  // what is farther off has no plot in the footprint
  for (std::size_t other = 0; other < tracks_.size(); ++other) {
    if (other == pair.track || !tracks_[other].alive()) continue;
    const Vector2 apart = sensor.residual(sensor.measure(tracks_[other].combined.mean), sensor.measure(pointing));
    if ((apart.cwiseAbs().array() > near.array()).any()) continue;
    tracker_.mark_gated(tracks_[other], sensor, look_plots_, others_plots_);
  }
  if (outcome.used_plot) others_plots_[*outcome.used_plot] = 0;
}

/// Of a calibration flight's track: where the target is.
std::optional<State> Engine::known_state(std::size_t track) const {
  if (links_[track].target == TruthLink::kNoTarget) return std::nullopt;
  const Target& target = targets_[links_[track].target];
  if (!target.config->calibration_flight || target.id != links_[track].id) return std::nullopt;
  return target.state;
}

void Engine::count_losses() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].alive()) continue;
    const bool has_target = links_[i].target != TruthLink::kNoTarget;
    const bool target_lives =
        has_target && targets_[links_[i].target].id == links_[i].id && targets_[links_[i].target].state.has_value();
    ++(target_lives ? counts_.tracks_lost : counts_.tracks_dropped);
  }
  counts_.filter_failures = tracker_.failures();
}

void Engine::report_truth() {
  report_.truth.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (links_[i].target == TruthLink::kNoTarget) continue;
    const Target& target = targets_[links_[i].target];
    if (!tracks_[i].alive() || target.id != links_[i].id || !target.state) continue;
    report_.truth.push_back({tracks_[i].id, links_[i].target, *target.state, target.trajectory->altitude_m(),
                             target.trajectory->mode(), target.id, target.target_class});
  }
}

}  // namespace dwell
