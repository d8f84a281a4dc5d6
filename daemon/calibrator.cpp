#include "daemon/calibrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "radar/assert.hpp"
#include "radar/calibration/information.hpp"
#include "radar/calibration/innovations.hpp"
#include "radar/calibration/joint.hpp"

namespace dwell {
namespace {

/// A gap that is longer starts a track of the window anew: its motion says little of the plots on the other side.
constexpr int kLongestGap = 30;
/// Scans over which a new correction comes into use: a jump of several sigma would look like a manoeuvre.
constexpr std::uint64_t kRampScans = 10;
/// Both sigmas of a radar under suspicion: its plots weigh a hundredth.
constexpr double kDistrust = 10.0;
/// Tracks whose disturbance is remembered, the latest: more at a time are no question of one radar.
constexpr std::size_t kMostDisturbances = 16;
/// Fresh plots that it takes to judge what is in use, and the log likelihood ratio at which it goes: by chance once in
/// e^3 = 20 judgements of two that are equally good, and then nothing is lost.
constexpr std::size_t kLeastFreshPlots = 20;
constexpr double kRollBack = 3.0;

std::shared_ptr<const MotionPrior> motion_prior(const EngineConfig& config) {
  auto prior = std::make_shared<MotionPrior>();
  prior->initial_probability = config.bank.initial_probability;
  const double period_s = to_seconds(config.scan_period);
  const auto one = discretise(config.bank, period_s);
  DWELL_ASSERT(one.has_value());  // the config reader has refused the others
  Eigen::MatrixXd chain = Eigen::MatrixXd::Identity(one->size(), one->size());
  for (int gap = 0; gap <= kLongestGap; ++gap, chain = chain * one->transition) {
    MotionStep step;
    step.transition = chain;
    for (const Mode& mode : config.bank.modes) {
      step.f.push_back(transition(mode.motion, gap * period_s));
      step.q.push_back(process_noise(mode.motion, mode.noise, gap * period_s));
    }
    prior->steps.push_back(std::move(step));
  }
  return prior;
}

double footprint_volume(const Sensor& sensor) {
  const Vector2 half = sensor.footprint_half_extent();
  return 4.0 * half[0] * half[1];
}

/// Of the plots that are not marked and finite, the one with the least distance from the prediction in sigmas.
std::optional<std::size_t> nearest(const CorrectedRadar& radar, const State& predicted, std::span<const Plot> plots,
                                   std::span<const char> marked) {
  const Vector2 sigma = radar.configured_noise(predicted).diagonal().cwiseSqrt();
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const Vector2 apart = radar.residual(plots[i].z, radar.measure(predicted)).cwiseQuotient(sigma);
    if (marked[i] || !(apart.squaredNorm() < least)) continue;
    least = apart.squaredNorm();
    best = i;
  }
  return best;
}

/// Its plots, that is: a radar that sees less than it should still measures what it sees.
bool is_trusted(const RadarCalibration& radar) {
  return radar.detector.fault() == Fault::kNone || radar.detector.fault() == Fault::kDetection;
}

Correction between(const Correction& from, const Correction& to, double share) {
  return to_correction(to_vector(from) + share * (to_vector(to) - to_vector(from)));
}

/// What is to be used of an estimate: what is not observable and not plainly off either stays as it is in use, since a
/// value of its prior's size may be no error of the radar's, and the rest is the estimate's mean given that,
///
///   theta_k + C_kr C_rr^-1 (used_r - theta_r)
///
/// Plainly: by four sigma. The five parameters of three radars in eight solves are 120 trials, of which one in a
/// hundred runs is that far off by chance.
Eigen::VectorXd known_part(const CalibrationEstimate& estimate, const Eigen::VectorXd& used) {
  constexpr double kPlain = 4.0;  // sigma
  std::vector<Eigen::Index> known;
  std::vector<Eigen::Index> rest;
  for (Eigen::Index i = 0; i < used.size(); ++i) {
    const auto radar = static_cast<int>(i / kCorrectionSize);
    const auto kind = static_cast<CorrectionKind>(i % kCorrectionSize);
    const double off = std::abs(estimate.value[i] - used[i]) / estimate.standard_error(radar, kind);
    (estimate.observable(radar, kind) || off > kPlain ? known : rest).push_back(i);
  }
  if (rest.empty()) return estimate.value;
  const Eigen::MatrixXd among_rest = estimate.covariance(rest, rest);
  const Eigen::VectorXd moved = among_rest.llt().solve(Eigen::VectorXd(used(rest) - estimate.value(rest)));
  Eigen::VectorXd result = used;
  result(known) = estimate.value(known) + estimate.covariance(known, rest) * moved;
  return result;
}

}  // namespace

CalibrationOutcome solve(const CalibrationTask& task, EstimatorSettings settings) {
  CalibrationOutcome outcome;
  outcome.joint = task.joint;
  settings.prior = task.prior;
  if (task.fresh.plots.size() >= kLeastFreshPlots) {
    const double in_use = log_likelihood(task.fresh, *task.motion, task.applied);
    const double before = log_likelihood(task.fresh, *task.motion, task.previous);
    outcome.rolled_back = before > in_use + kRollBack;
  }
  const auto& method = task.joint ? estimate_jointly : estimate_corrections;
  outcome.estimate = method(task.window, *task.motion, task.applied, settings);
  return outcome;
}

Calibrator::Calibrator(const EngineConfig& config, const std::vector<std::unique_ptr<Sensor>>& beliefs)
    : settings_(config.calibration), radar_of_sensor_(beliefs.size(), -1) {
  for (std::size_t i = 0; i < beliefs.size(); ++i) {
    auto* radar = dynamic_cast<CorrectedRadar*>(beliefs[i].get());
    if (radar == nullptr) continue;
    radar_of_sensor_[i] = static_cast<int>(beliefs_.size());
    beliefs_.push_back(radar);
  }
  radars_.resize(beliefs_.size());
  if (!on()) return;
  plots_.reserve(static_cast<std::size_t>(settings_.window_plots));
  bias_detector_ = BiasDetector(beliefs_.size(), config.targets.size());
  disturbances_.reserve(kMostDisturbances);
  expected_.reserve(static_cast<std::size_t>(config.bank.initial_probability.size()));
  motion_ = motion_prior(config);
}

std::optional<std::size_t> Calibrator::owed(std::uint64_t scan, std::span<const Pair> feasible) const {
  if (!applies() || settings_.exploration <= 0.0) return std::nullopt;
  const auto interval = static_cast<std::uint64_t>(std::ceil(1.0 / settings_.exploration - 1e-9));
  if (scan % interval != 0) return std::nullopt;
  std::optional<std::size_t> longest;
  std::uint64_t last_look = scan - interval + 1;  // of those that have waited for so long
  for (const Pair& pair : feasible) {
    const RadarCalibration* radar = this->radar(pair.sensor);
    if (radar == nullptr || radar->last_look >= last_look) continue;
    longest = pair.sensor;
    last_look = radar->last_look;
  }
  return longest;
}

void Calibrator::add(std::uint64_t scan, const Dwell& dwell, const ImmEstimate& before, std::span<const Plot> plots,
                     std::span<const char> others, std::optional<std::size_t> used, const std::optional<State>& truth) {
  if (!on()) return;
  const int index = radar_of_sensor_[dwell.radar.number - 1];
  if (index < 0) return;
  const CorrectedRadar& belief = *beliefs_[index];
  RadarCalibration& radar = radars_[index];
  radar.last_look = scan;
  const auto unexplained = std::count(others.begin(), others.end(), 0) - (used ? 1 : 0);
  radar.clutter.add(static_cast<int>(unexplained), footprint_volume(belief));

  // A plot that is alone counts in the gate or not: of a noise that is too large the gate lets in what is small. What
  // is not the target's is the estimator's outlier.
  std::optional<std::size_t> own = used;
  if (!used) own = nearest(belief, dwell.pointing, plots, others);
  watch_detection(index, dwell, used.has_value());
  if (own) watch_plot(index, dwell, before, plots[*own], used.has_value(), scan);
  for (RadarCalibration& each : radars_) {
    if (each.detector.fault() != each.fault) change_fault(each, scan);
  }
  if (used || (own && unexplained == 1)) keep(scan, dwell, plots[*own], truth);
}

void Calibrator::watch_detection(int index, const Dwell& dwell, bool detected) {
  const CorrectedRadar& belief = *beliefs_[index];
  RadarCalibration& radar = radars_[index];
  const double configured = belief.configured_detection(dwell.pointing);
  if (radar.detector.detection_sum() <= 0.0) {
    radar.since_change = DetectionCount();
    const double sure = radar.detection.scale() - 2.0 * radar.detection.standard_error(configured) / configured;
    radar.held_scale = std::max(sure, 0.0);
  }
  radar.detection.add(detected, configured);
  radar.since_change.add(detected, configured);
  radar.detector.add_look(detected, radar.held_scale * configured);
}

/// The plot with what the track expects.
void Calibrator::watch_plot(int index, const Dwell& dwell, const ImmEstimate& before, const Plot& plot, bool used,
                            std::uint64_t scan) {
  const CorrectedRadar& belief = *beliefs_[index];
  const Matrix2 noise = belief.noise(dwell.pointing);
  const Matrix2 trusted = noise / (belief.distrust() * belief.distrust());
  BiasLook look{scan,
                dwell.track.number,
                static_cast<std::size_t>(index),
                belief.jacobian(dwell.pointing),
                Eigen::Matrix<double, kStateSize, 2>::Zero(),
                trusted.diagonal().cwiseSqrt()};
  expected_.clear();
  double total = 0.0;
  for (int j = 0; j < before.size(); ++j) {
    const Gaussian& mode = before.modes[j];
    const MeasurementJacobian h = belief.jacobian(mode.mean);
    const Eigen::Matrix<double, kStateSize, 2> ph = mode.covariance * h.transpose();
    const Vector2 nu = belief.residual(plot.z, belief.measure(mode.mean));
    const Matrix2 s = h * ph + noise;
    const double weight =
        before.probability[j] * std::exp(-0.5 * nu.dot(s.inverse() * nu)) / std::sqrt(s.determinant());
    expected_.push_back({before.probability[j], nu, h * ph});
    look.gain += weight * ph * s.inverse();
    total += weight;
  }
  if (used && total > 0.0) {
    look.gain /= total;
  } else {
    look.gain.setZero();
  }
  const double false_density = belief.clutter_density() + calibration::kOutlierProbability / footprint_volume(belief);
  const PlotDensity density(expected_, trusted, false_density);
  const bool disturbed = is_disturbed(index, look.track);
  const bool says = !disturbed && is_trusted(radars_[index]);
  if (const auto biased = bias_detector_.add(*motion_, look, says ? &density : nullptr)) {
    radars_[*biased].detector.flag(Fault::kBias);
  }
  if (disturbed || !radars_[index].detector.add_plot(density)) return;
  if (disturbances_.size() == kMostDisturbances) disturbances_.erase(disturbances_.begin());
  disturbances_.push_back({look.track, index});
}

/// A gross error takes the track with it, and then the next radar is as far off: the first to disagree is to answer for
/// it, so the other's plot is no evidence.
bool Calibrator::is_disturbed(int index, std::uint32_t track) {
  const auto disturbance = std::ranges::find(disturbances_, track, &Disturbance::track);
  if (disturbance == disturbances_.end()) return false;
  const bool others = disturbance->radar != index;
  disturbances_.erase(disturbance);
  return others;
}

void Calibrator::keep(std::uint64_t scan, const Dwell& dwell, const Plot& plot, const std::optional<State>& truth) {
  const int index = radar_of_sensor_[dwell.radar.number - 1];
  CalibrationPlot kept;
  kept.scan = scan;
  kept.track = dwell.track.number;
  kept.radar = static_cast<std::uint32_t>(index);
  kept.z = plot.z;
  kept.sigma = beliefs_[index]->configured_noise(dwell.pointing).diagonal().cwiseSqrt();
  kept.predicted = dwell.pointing;
  kept.truth = truth;
  if (plots_.size() < static_cast<std::size_t>(settings_.window_plots)) {
    plots_.push_back(kept);
  } else {
    plots_[next_] = kept;
    next_ = (next_ + 1) % plots_.size();
  }
}

/// What a radar measured before it went bad, or came back, says nothing of it now, nor what it detected. As long as no
/// bias of it has been found the fault may be in its figures, which the plots at hand are to find.
void Calibrator::change_fault(RadarCalibration& radar, std::uint64_t scan) {
  const bool of_plots = !is_trusted(radar) || (radar.fault != Fault::kNone && radar.fault != Fault::kDetection);
  if (radar.fault == Fault::kDetection || radar.detector.fault() == Fault::kDetection) {
    radar.detection = radar.since_change;
  }
  radar.fault = radar.detector.fault();
  if (!of_plots) return;
  if (!to_vector(radar.applied).tail<3>().isZero(0.0)) radar.since_scan = scan + 1;
  bias_detector_.restart(scan);
  distrust();
}

/// Whose plots are under suspicion weighs little, as long as another is not.
void Calibrator::distrust() {
  if (!applies()) return;
  const bool any = std::ranges::any_of(radars_, is_trusted);
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    beliefs_[i]->set_distrust(any && !is_trusted(radars_[i]) ? kDistrust : 1.0);
  }
}

void Calibrator::move_beliefs(std::uint64_t scan) {
  if (!applies()) return;
  const double share = std::min(1.0, static_cast<double>(scan - applied_scan_) / static_cast<double>(kRampScans));
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    beliefs_[i]->set_correction(between(radars_[i].previous, radars_[i].applied, share));
    beliefs_[i]->set_detection_scale(radars_[i].detection.scale());
    beliefs_[i]->set_clutter_density(radars_[i].clutter.density(beliefs_[i]->figures().clutter_density));
  }
}

CalibrationWindow Calibrator::empty_window() const {
  CalibrationWindow window;
  for (const CorrectedRadar* radar : beliefs_) {
    window.radar_position_m.push_back(radar->figures().position_m);
    window.outlier_density.push_back(1.0 / footprint_volume(*radar));
  }
  return window;
}

CalibrationTask Calibrator::task(std::uint64_t scan, bool joint) const {
  CalibrationTask task{scan, empty_window(), empty_window(), {}, {}, motion_, settings_.prior, joint};
  for (const RadarCalibration& radar : radars_) {
    task.applied.push_back(radar.applied);
    task.previous.push_back(radar.previous);
  }
  for (const CalibrationPlot& plot : plots_) {
    if (plot.scan < radars_[plot.radar].since_scan) continue;
    task.window.plots.push_back(plot);
    if (applied_scan_ > 0 && plot.scan > applied_scan_ + kRampScans) task.fresh.plots.push_back(plot);
  }
  sort_plots(task.window.plots);
  sort_plots(task.fresh.plots);
  return task;
}

void Calibrator::finish(const CalibrationTask& task, CalibrationOutcome outcome, std::uint64_t scan) {
  last_scan_ = task.scan;
  if (outcome.rolled_back) {
    for (RadarCalibration& radar : radars_) std::swap(radar.applied, radar.previous);
    applied_scan_ = scan;
  } else if (outcome.estimate.status == EstimatorStatus::kDone && applies()) {
    const std::vector<Correction> next = unstacked(known_part(outcome.estimate, stacked(task.applied)));
    for (std::size_t i = 0; i < radars_.size(); ++i) {
      radars_[i].previous = radars_[i].applied;
      radars_[i].applied = next[i];
    }
    applied_scan_ = scan;
  }
  last_ = std::move(outcome);
}

void Calibrator::give_up() {
  CalibrationOutcome late;
  late.estimate.status = EstimatorStatus::kTimeLimit;
  last_ = std::move(late);
}

const RadarCalibration* Calibrator::radar(std::size_t sensor) const {
  const int index = radar_of_sensor_[sensor];
  return index < 0 ? nullptr : &radars_[index];
}

}  // namespace dwell
