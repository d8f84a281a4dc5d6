#include "daemon/encode.hpp"

#include <array>
#include <cmath>

#include "tracker/metrics/nees.hpp"

namespace dwell {
namespace {

v1::Track::State state_of(TrackStatus status) {
  switch (status) {
    case TrackStatus::kConfirmed:
      return v1::Track::CONFIRMED;
    case TrackStatus::kCoasting:
      return v1::Track::COASTING;
    case TrackStatus::kLost:
      break;
  }
  return v1::Track::LOST;
}

std::uint32_t number_of(std::size_t index) { return static_cast<std::uint32_t>(index + 1); }

void encode(const TruthReport& truth, const Track& track, v1::Truth& message) {
  message.set_track(truth.track.number);
  for (const double value : truth.state) message.add_state(value);
  message.set_altitude_m(truth.altitude_m);
  message.set_position_error_m((position(truth.state) - position(track.combined.mean)).norm());
  message.set_nees(nees(truth.state, track.combined));
  if (truth.target_class) message.set_target_class(number_of(static_cast<std::size_t>(*truth.target_class)));
}

/// A correction in the units of the wire.
std::array<double, kCorrectionSize> in_words(const Correction& correction) {
  return {std::exp(correction.log_range_scale), std::exp(correction.log_azimuth_scale), correction.range_bias_m,
          correction.azimuth_bias_rad / kDegree, correction.time_bias_s};
}

constexpr std::array<const char*, kCorrectionSize> kParameters{"range_noise_scale", "azimuth_noise_scale",
                                                               "range_bias_m", "azimuth_bias_deg", "time_bias_s"};

void encode(const CalibrationEstimate& estimate, int radar, v1::RadarCalibration& message) {
  message.set_plots(static_cast<std::uint32_t>(estimate.plots[radar]));
  if (estimate.plots[radar] > 0) {
    message.set_nis_before(estimate.nis_before[radar]);
    message.set_nis_after(estimate.nis_after[radar]);
  }
  const auto values = in_words(estimate.correction(radar));
  for (int k = 0; k < kCorrectionSize; ++k) {
    const auto kind = static_cast<CorrectionKind>(k);
    v1::CalibrationParameter& parameter = *message.add_parameter();
    parameter.set_name(kParameters[k]);
    parameter.set_value(values[k]);
    const double unit = kind == CorrectionKind::kAzimuthBias ? kDegree : 1.0;
    parameter.set_standard_error(estimate.standard_error(radar, kind) / unit);
    parameter.set_prior_share(estimate.prior_share(radar, kind));
    parameter.set_observable(estimate.observable(radar, kind));
    if (estimate.observable(radar, kind)) continue;
    for (int other = 0; other < estimate.radars(); ++other) {
      if (other != radar && estimate.difference_observable(radar, other, kind)) {
        parameter.add_difference_observable(number_of(static_cast<std::size_t>(other)));
      }
    }
  }
}

}  // namespace

double weighted_cost(std::span<const Track> tracks) {
  double cost = 0.0;
  for (const Track& track : tracks) {
    if (track.alive()) cost += track.weight * position_block(track.combined.covariance).trace();
  }
  return cost;
}

void encode(const Track& track, v1::Track& message) {
  message.Clear();
  message.set_id(track.id.number);
  message.set_name(track.name);
  message.set_status(state_of(track.status));
  for (const double value : track.combined.mean) message.add_state(value);
  for (int row = 0; row < kStateSize; ++row) {
    for (int column = row; column < kStateSize; ++column) {
      message.add_covariance(track.combined.covariance(row, column));
    }
  }
  for (const double probability : track.estimate.probability) message.add_mode_probability(probability);
  if (track.last_look) {
    message.set_last_look_time_ns(track.last_look->time_since_epoch().count());
    message.set_last_look_radar(track.last_radar.number);
  }
  message.set_age_scans(static_cast<std::uint32_t>(track.age_scans));
  if (track.nis) message.set_nis(*track.nis);
  if (track.existence) message.set_existence_probability(*track.existence);
  for (const double probability : track.class_belief) message.add_class_belief(probability);
  if (track.class_belief.size() > 0) message.set_weight(track.weight);
}

void encode(const ScanReport& report, std::span<const Track> tracks, v1::ScanReport& message) {
  message.Clear();
  message.set_scan(report.scan);
  message.set_policy(report.policy);
  for (const Candidate& candidate : report.decision.candidates) {
    v1::Candidate& out = *message.add_candidate();
    out.set_radar(number_of(candidate.pair.sensor));
    out.set_track(tracks[candidate.pair.track].id.number);
    out.set_score(candidate.score);
    if (candidate.cost_without_look) out.set_cost_without_look(*candidate.cost_without_look);
    if (candidate.expected_cost) out.set_expected_cost(*candidate.expected_cost);
    if (candidate.weight) out.set_weight(*candidate.weight);
    if (!candidate.parts) continue;
    out.set_gain_now(candidate.parts->gain_now);
    out.set_value_later(candidate.parts->value_later);
    out.set_price(candidate.parts->price);
  }
  for (std::size_t i = 0; i < report.looks.size(); ++i) {
    const LookReport& look = report.looks[i];
    v1::Look& out = *message.add_look();
    out.set_radar(look.dwell.radar.number);
    out.set_track(look.dwell.track.number);
    out.set_plots(static_cast<std::uint32_t>(look.plots));
    if (!look.used_plot) continue;
    out.set_used_plot(number_of(*look.used_plot - look.first_plot));
    const Track& track = tracks[report.decision.pair(i).track];
    if (track.nis) out.set_nis(*track.nis);
  }
  if (report.decision.margin) message.set_margin(*report.decision.margin);
  message.set_fell_back(report.decision.fell_back);
  message.set_owed(report.decision.owed);
  message.set_answered_by(std::string(report.decision.answered_by));
  message.set_cost(weighted_cost(tracks));
  if (report.decision.relaxed) {
    message.mutable_relaxed()->set_price(report.decision.relaxed->price);
    message.mutable_relaxed()->set_reference(report.decision.relaxed->reference);
  }
  std::size_t place = 0;
  for (const TruthReport& truth : report.truth) {
    while (tracks[place].id != truth.track) ++place;  // both in the order of the tracks
    encode(truth, tracks[place], *message.add_truth());
  }
}

void encode(const ScanReport& report, const LookReport& look, std::size_t plot, const Sensor& sensor,
            v1::Plot& message) {
  message.Clear();
  const Plot& detection = report.plots[plot];
  message.set_radar(look.dwell.radar.number);
  message.set_track(look.dwell.track.number);
  message.set_number(number_of(plot - look.first_plot));
  if (const auto place = sensor.position_of(detection.z)) {
    message.set_range_m(detection.z[0]);
    message.set_azimuth_rad(detection.z[1]);
    message.set_x_m(place->x());
    message.set_y_m(place->y());
  } else {
    for (const double value : detection.z) message.add_measurement(value);
  }
  message.set_used(look.used_plot == plot);
  message.set_false_alarm(!detection.source.has_value());
  if (detection.declared) message.set_declared_class(number_of(static_cast<std::size_t>(*detection.declared)));
}

bool encode_calibration(const Engine& engine, std::size_t sensor, v1::RadarCalibration& message) {
  message.Clear();
  const Calibrator& calibrator = engine.calibrator();
  const RadarCalibration* radar = calibrator.on() ? calibrator.radar(sensor) : nullptr;
  if (radar == nullptr) return false;
  message.set_radar(number_of(sensor));
  message.set_name(engine.config().sensors[sensor].name);
  message.set_detection_scale(radar->detection.scale());
  message.set_detection_looks(radar->detection.looks());
  const double configured = std::get<RadarFigures>(engine.config().sensors[sensor].figures).clutter_density;
  message.set_clutter_density(radar->clutter.density(configured));
  message.set_clutter_density_error(radar->clutter.standard_error(configured));
  message.set_fault(static_cast<v1::RadarCalibration::Fault>(radar->detector.fault()));
  if (calibrator.applies()) {
    for (const double value : in_words(radar->applied)) message.add_applied_value(value);
  }
  if (!calibrator.last()) return true;
  const CalibrationEstimate& estimate = calibrator.last()->estimate;
  message.set_asked_scan(calibrator.last_scan());
  message.set_effective_scan(calibrator.last_scan() + static_cast<std::uint64_t>(calibrator.settings().delay_scans));
  message.set_failure(to_string(estimate.status));
  message.set_rolled_back(calibrator.last()->rolled_back);
  message.set_joint(calibrator.last()->joint);
  if (estimate.status != EstimatorStatus::kDone) return true;
  message.set_applied(calibrator.applies() && !calibrator.last()->rolled_back);
  encode(estimate, calibrator.radar_index(sensor), message);
  return true;
}

void encode_radar(const Engine& engine, std::size_t sensor, v1::RadarState& message) {
  const SensorConfig& config = engine.config().sensors[sensor];
  message.Clear();
  message.set_number(number_of(sensor));
  message.set_name(config.name);
  const SensorState& state = engine.sensor_state(sensor);
  message.set_up(state.up);
  message.set_looks(engine.counts().looks[sensor]);
  message.set_detections(engine.counts().detections[sensor]);
  if (state.budget.limited()) {
    v1::BudgetState& budget = *message.mutable_budget();
    budget.set_looks(static_cast<std::uint32_t>(config.budget.looks));
    budget.set_left(static_cast<std::uint32_t>(state.budget.left()));
    budget.set_due(state.budget.allows());
  }
  if (const auto* figures = std::get_if<RadarFigures>(&config.figures)) {
    message.set_x_m(figures->position_m.x());
    message.set_y_m(figures->position_m.y());
  }
  if (!encode_calibration(engine, sensor, *message.mutable_calibration())) message.clear_calibration();
}

}  // namespace dwell
