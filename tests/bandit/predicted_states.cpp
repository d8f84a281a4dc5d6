#include "tests/bandit/predicted_states.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "bandit/sa_imm.hpp"
#include "radar/jump_markov_trajectory.hpp"
#include "radar/linear_sensor.hpp"
#include "radar/look.hpp"
#include "radar/range_bearing_radar.hpp"
#include "radar/scripted_trajectory.hpp"
#include "tracker/tracker.hpp"

namespace dwell::testing {
namespace {

using SensorList = std::vector<std::shared_ptr<const Sensor>>;

Gaussian start_belief(const State& truth, double sigma, RandomStream& stream) {
  Gaussian belief;
  for (double& value : belief.mean) value = sigma * stream.normal();
  belief.mean += truth;
  belief.covariance = sigma * sigma * StateMatrix::Identity();
  return belief;
}

/// One target, one look a scan chosen by sa_imm; keeps the predicted estimate of every scan.
std::vector<ImmEstimate> run_closed_loop(const ModeBank& bank, UpdateForm update, const SensorList& sensors,
                                         Trajectory& truth, double start_sigma, int scans, RandomStream stream) {
  TrackerSettings settings;
  settings.update = update;
  settings.gate = std::numeric_limits<double>::infinity();
  Tracker tracker(*discretise(bank, 1.0), bank.initial_probability, settings);
  const State start = *truth.advance(kStreamStart);
  std::vector<Track> tracks{tracker.start(TrackId{1}, "", start_belief(start, start_sigma, stream))};
  SaImm policy(SaImmSettings{});
  std::vector<const Sensor*> believed;
  std::vector<Pair> feasible;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    believed.push_back(sensors[s].get());
    feasible.push_back({s, 0});
  }
  const std::vector<double> free_use(sensors.size(), 0.0);
  const std::vector<SensorState> unlimited(sensors.size());
  std::vector<ImmEstimate> kept;
  Decision decision;
  std::vector<Plot> plots;
  for (int k = 1; k <= scans; ++k) {
    const TimePoint time = kStreamStart + from_seconds(k);
    const State x = *truth.advance(time);
    tracker.predict(tracks[0]);
    if (!tracks[0].alive()) break;
    kept.push_back(tracks[0].estimate);
    const DiscreteBank& moves = tracker.bank();
    policy.decide({time, 1, update, &moves, stream.fork("policy"), believed, unlimited, free_use, tracks, feasible},
                  decision);
    const std::size_t s = decision.pair(0).sensor;
    const Dwell dwell{RadarId{static_cast<std::uint32_t>(s + 1)}, TrackId{1}, time, x};
    simulate_look(*sensors[s], dwell, std::vector<TargetTruth>{{TargetId{1}, x}}, stream.fork(s), plots);
    (void)tracker.look(tracks[0], *sensors[s], dwell, plots);
    if (!tracks[0].alive()) break;
  }
  return kept;
}

ScriptedTrajectory evans_truth(RandomStream stream) {
  Script script;
  script.initial = make_state({100e3, 200e3}, {0.0, -2000.0});
  Leg manoeuvre;
  manoeuvre.start = kStreamStart + from_seconds(25.0);
  manoeuvre.end = kStreamStart + from_seconds(28.0);
  manoeuvre.acceleration_mps2 = {500.0 / 3.0, 400.0 / 3.0};
  manoeuvre.process_noise_scale = 10.0;
  script.legs = {manoeuvre};
  const double b = std::sqrt(0.1);
  script.process_noise_root = State(b, b, 0.1, 0.1).asDiagonal();
  return {script, stream};
}

JumpMarkovTrajectory liu_hwang_truth(RandomStream stream) {
  const DiscreteBank bank = *discretise(*named_bank("liu_hwang"), 1.0);
  JumpMarkovSystem system{bank.f, std::vector<StateMatrix>(bank.f.size(), StateMatrix::Zero()), bank.transition};
  JumpMarkovScript script;
  script.initial = make_state({0.0, 0.0}, {18.0, 0.0});
  script.initial_mode = 2;
  script.scan_period = from_seconds(1.0);
  return {std::move(system), script, stream};
}

int draw_scan(int scans, RandomStream& stream) { return static_cast<int>(stream.uniform(0.0, scans)); }

void keep(const std::vector<ImmEstimate>& run, int index, const std::string& origin, const SensorList& sensors,
          UpdateForm update, std::vector<PredictedState>& states) {
  if (index >= std::ssize(run)) return;
  for (const auto& sensor : sensors) states.push_back({origin, run[static_cast<std::size_t>(index)], sensor, update});
}

void add_evans(int runs, const std::string& bank, UpdateForm update, const RandomStream& stream,
               std::vector<PredictedState>& states) {
  const std::string origin = bank + (update == UpdateForm::kEkf ? "/ekf" : "/converted");
  for (int r = 0; r < runs; ++r) {
    const RandomStream own = stream.fork(static_cast<std::uint64_t>(r));
    ScriptedTrajectory truth = evans_truth(own.fork("truth"));
    RandomStream draw = own.fork("scans");
    const auto run = run_closed_loop(*named_bank(bank), update, evans_radars(), truth, 100.0, 60, own.fork("looks"));
    for (int scan = 26; scan <= 31; ++scan) keep(run, scan - 1, origin, evans_radars(), update, states);
    for (int i = 0; i < 3; ++i) keep(run, draw_scan(60, draw), origin, evans_radars(), update, states);
  }
}

void add_liu_hwang(int runs, const RandomStream& stream, std::vector<PredictedState>& states) {
  for (int r = 0; r < runs; ++r) {
    const RandomStream own = stream.fork(static_cast<std::uint64_t>(r));
    JumpMarkovTrajectory truth = liu_hwang_truth(own.fork("truth"));
    RandomStream draw = own.fork("scans");
    const auto run = run_closed_loop(*named_bank("liu_hwang"), UpdateForm::kEkf, liu_hwang_sensors(), truth, 1.0, 110,
                                     own.fork("looks"));
    for (int i = 0; i < 6; ++i) {
      keep(run, draw_scan(110, draw), "liu_hwang", liu_hwang_sensors(), UpdateForm::kEkf, states);
    }
  }
}

double draw_log(double low, double high, RandomStream& stream) {
  return std::exp(stream.uniform(std::log(low), std::log(high)));
}

Vector2 draw_direction(RandomStream& stream) {
  const double angle = stream.uniform(0.0, 2.0 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

Matrix2 rotation(RandomStream& stream) {
  const Vector2 e = draw_direction(stream);
  return (Matrix2() << e.x(), -e.y(), e.y(), e.x()).finished();
}

/// A sensor, a place for the target, and the sensor's typical position sigma there, metres.
struct Site {
  std::shared_ptr<const Sensor> sensor;
  State place = State::Zero();
  double sigma_m = 1.0;
  UpdateForm update = UpdateForm::kEkf;
  std::string name;
};

Site draw_site(RandomStream& stream) {
  const double p_d = stream.uniform() < 0.25 ? 1.0 : stream.uniform(0.3, 1.0);
  const double kind = stream.uniform(0.0, 4.0);
  if (kind < 1.0) {
    const bool first = stream.uniform() < 0.5;
    const MeasurementJacobian c = liu_hwang_sensors()[first ? 0 : 1]->jacobian(State::Zero());
    return {std::make_shared<LinearSensor>(c, Matrix2::Identity(), p_d), State::Zero(), 1.0, UpdateForm::kEkf,
            first ? "random/C1" : "random/C2"};
  }
  if (kind < 2.0) {
    const double aspect = draw_log(1.0, 30.0, stream);
    const Matrix2 turn = rotation(stream);
    const Matrix2 r = turn * Vector2(1.0, aspect * aspect).asDiagonal() * turn.transpose();
    return {std::make_shared<LinearSensor>(position_selector(), r, p_d), State::Zero(), std::sqrt(aspect),
            UpdateForm::kEkf, "random/xy"};
  }
  RadarFigures figures;
  figures.beamwidth_rad = stream.uniform(0.2, 2.0) * kDegree;
  figures.detection = FixedDetection{p_d};
  const auto radar = std::make_shared<RangeBearingRadar>(figures);
  const double range_m = stream.uniform(5e3, 200e3);
  const Vector2 place = range_m * draw_direction(stream);
  const double sigma_m = std::sqrt(radar->range_sigma_m(range_m) * range_m * radar->azimuth_sigma_rad(range_m));
  const bool ekf = kind < 3.0;
  return {radar, make_state(place, {0.0, 0.0}), sigma_m, ekf ? UpdateForm::kEkf : UpdateForm::kConverted,
          ekf ? "random/radar/ekf" : "random/radar/converted"};
}

/// Covariance of position sigma `size` on the mean and a random shape.
StateMatrix draw_shape(double size_m, RandomStream& stream) {
  const double aspect = std::sqrt(draw_log(1.0, 10.0, stream));
  const double interval_s = draw_log(1.0, 10.0, stream);
  const double correlation = stream.uniform(0.0, 0.95);
  const Matrix2 turn = rotation(stream);
  const Matrix2 place =
      turn * Vector2(aspect, 1.0 / aspect).cwiseAbs2().asDiagonal() * turn.transpose() * size_m * size_m;
  StateMatrix p;
  p({kX, kY}, {kX, kY}) = place;
  p({kVx, kVy}, {kVx, kVy}) = place / (interval_s * interval_s);
  p({kX, kY}, {kVx, kVy}) = p({kVx, kVy}, {kX, kY}) = correlation / interval_s * place;
  return p;
}

/// |S| of a mode with covariance p.
double determinant(const StateMatrix& p, const Site& site) {
  std::vector<PredictedMeasurement> out;
  if (predict_measurements(*site.sensor, site.update, make_estimate({site.place, p}, Eigen::VectorXd::Ones(1)), out) !=
      Numerics::kOk) {
    return 0.0;
  }
  return out[0].s.determinant();
}

/// The multiple of `shape` whose |S| is `target`: |S| grows with the multiple.
StateMatrix scaled_to(const StateMatrix& shape, double target, const Site& site) {
  double low = 1e-9;
  double high = 1e9;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (determinant(middle * shape, site) < target ? low : high) = middle;
  }
  return low * shape;
}

ImmEstimate draw_estimate(const Site& site, RandomStream& stream) {
  const int count = stream.uniform() < 0.5 ? 2 : 3;
  ImmEstimate estimate = make_estimate({site.place, StateMatrix::Identity()}, Eigen::VectorXd::Ones(count));
  for (double& probability : estimate.probability) probability = draw_log(1e-4, 1.0, stream);
  estimate.probability /= estimate.probability.sum();
  estimate.modes[0].covariance = draw_shape(draw_log(0.1, 10.0, stream) * site.sigma_m, stream);
  const double narrowest = determinant(estimate.modes[0].covariance, site);
  for (std::size_t j = 1; j < estimate.modes.size(); ++j) {
    Gaussian& mode = estimate.modes[j];
    mode.covariance = scaled_to(draw_shape(1.0, stream), draw_log(1.0, 1e4, stream) * narrowest, site);
    const Gaussian& measure = stream.uniform() < 0.5 ? estimate.modes[0] : mode;
    std::vector<PredictedMeasurement> out;
    (void)predict_measurements(*site.sensor, site.update,
                               make_estimate({site.place, measure.covariance}, Eigen::VectorXd::Ones(1)), out);
    const Vector2 direction = draw_direction(stream);
    const double speed = 2.0 * std::sqrt(mode.covariance(kVx, kVx));
    State offset = make_state(direction, Vector2::Zero());
    const double distance = stream.uniform() < 0.25 ? 0.0 : stream.uniform(0.0, 10.0);
    offset *= distance / std::sqrt(out[0].squared_distance(out[0].h * offset));
    mode.mean += offset + make_state(Vector2::Zero(), {stream.uniform(-speed, speed), stream.uniform(-speed, speed)});
  }
  const auto other = static_cast<std::size_t>(stream.uniform(0.0, count));
  std::swap(estimate.modes[0], estimate.modes[other]);
  return estimate;
}

}  // namespace

SensorList evans_radars() {
  const Vector2 positions_m[] = {{120e3, 120e3}, {100e3, 50e3}, {150e3, 100e3}};
  const double beamwidths_deg[] = {1.0, 0.2, 1.0};
  SensorList radars;
  for (int i = 0; i < 3; ++i) {
    RadarFigures figures;
    figures.position_m = positions_m[i];
    figures.beamwidth_rad = beamwidths_deg[i] * kDegree;
    radars.push_back(std::make_shared<RangeBearingRadar>(figures));
  }
  return radars;
}

SensorList liu_hwang_sensors() {
  MeasurementJacobian c1;
  MeasurementJacobian c2;
  c1 << 1.0, 0.0, 0.0, 0.1, 0.0, 1.0, 0.1, 0.0;
  c2 << 0.1, 0.0, 0.0, 1.0, 0.0, 0.1, 1.0, 0.0;
  return {std::make_shared<LinearSensor>(c1, Matrix2::Identity(), 1.0),
          std::make_shared<LinearSensor>(c2, Matrix2::Identity(), 1.0)};
}

std::vector<PredictedState> closed_loop_states(int runs, std::uint64_t seed) {
  const RandomStream stream(seed);
  std::vector<PredictedState> states;
  for (const char* bank : {"as_printed", "evans_practical"}) {
    for (const UpdateForm update : {UpdateForm::kConverted, UpdateForm::kEkf}) {
      add_evans(runs, bank, update, stream.fork(bank).fork(static_cast<std::uint64_t>(update)), states);
    }
  }
  add_liu_hwang(runs, stream.fork("liu_hwang"), states);
  return states;
}

std::vector<PredictedState> random_states(int count, std::uint64_t seed) {
  std::vector<PredictedState> states;
  for (int i = 0; i < count; ++i) {
    RandomStream stream = RandomStream(seed).fork(static_cast<std::uint64_t>(i));
    const Site site = draw_site(stream);
    states.push_back({site.name, draw_estimate(site, stream), site.sensor, site.update});
  }
  return states;
}

}  // namespace dwell::testing
