#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "bandit/policy.hpp"
#include "radar/linear_sensor.hpp"
#include "radar/random.hpp"
#include "tests/bandit/predicted_states.hpp"

namespace dwell::testing {

/// Modes of constant velocity, each of ten times the noise of the one before, that change once in ten scans.
inline DiscreteBank plain_bank(int modes) {
  DiscreteBank bank;
  double q = 1.0;
  for (int i = 0; i < modes; ++i, q *= 10.0) {
    bank.f.push_back(transition(ConstantVelocity{}, 1.0));
    bank.q.push_back(white_noise(ConstantVelocity{}, q, 1.0));
  }
  bank.transition = Eigen::MatrixXd::Constant(modes, modes, modes > 1 ? 0.1 / (modes - 1) : 0.0);
  bank.transition.diagonal().setConstant(modes > 1 ? 0.9 : 1.0);
  return bank;
}

/// What a situation points into: sensors, tracks, and which sensors are up.
struct Scene {
  std::vector<std::shared_ptr<const Sensor>> owned;
  std::vector<const Sensor*> sensors;
  std::vector<double> usage_cost;
  std::vector<bool> up;
  std::vector<LookBudget> budgets;
  std::vector<Track> tracks;
  std::vector<SensorState> states;
  std::vector<Pair> feasible;
  UpdateForm update = UpdateForm::kEkf;
  DiscreteBank bank;
  std::uint64_t scans = 0;  // moved on so far

  void add_sensor(std::shared_ptr<const Sensor> sensor) {
    sensors.push_back(sensor.get());
    owned.push_back(std::move(sensor));
    usage_cost.push_back(0.0);
    up.push_back(true);
    budgets.emplace_back();
  }

  void add_track(std::uint32_t number, const ImmEstimate& estimate, double weight = 1.0) {
    Track track;
    track.id = TrackId{number};
    track.weight = weight;
    track.estimate = estimate;
    track.combined = combine(estimate);
    tracks.push_back(track);
  }

  /// The feasible pairs of now: tracks in order, then sensors.
  Situation situation(int looks = 1) {
    feasible.clear();
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      for (std::size_t s = 0; s < sensors.size(); ++s) {
        if (up[s] && budgets[s].allows() && tracks[t].alive()) feasible.push_back({s, t});
      }
    }
    states.clear();
    for (std::size_t s = 0; s < sensors.size(); ++s) states.push_back({up[s], budgets[s]});
    if (!tracks.empty() && bank.size() != tracks.front().estimate.size()) {
      bank = plain_bank(tracks.front().estimate.size());
    }
    return {.time = kStreamStart + std::chrono::seconds(scans),
            .looks = looks,
            .update = update,
            .bank = &bank,
            .random = RandomStream(1).fork(scans),
            .sensors = sensors,
            .states = states,
            .usage_cost = usage_cost,
            .tracks = tracks,
            .feasible = feasible};
  }

  /// Something happens: every track grows uncertain, those looked at less so.
  void move_on(const Decision& decision) {
    ++scans;
    for (Track& track : tracks) {
      for (Gaussian& mode : track.estimate.modes) mode.covariance *= 1.3;
    }
    for (const std::size_t choice : decision.chosen) {
      for (Gaussian& mode : tracks[decision.candidates[choice].pair.track].estimate.modes) mode.covariance *= 0.3;
    }
    for (Track& track : tracks) track.combined = combine(track.estimate);
  }
};

/// Evans' three radars and tracks 1 .. n somewhere among them: two modes each, random places, sizes and
/// probabilities.
inline Scene random_scene(int tracks, std::uint64_t seed) {
  Scene scene;
  for (const auto& radar : evans_radars()) scene.add_sensor(radar);
  RandomStream stream(seed);
  for (int i = 1; i <= tracks; ++i) {
    const double c = stream.uniform(0.1, 0.9);
    ImmEstimate estimate = make_estimate({}, Eigen::Vector2d(c, 1.0 - c));
    const State centre = make_state({stream.uniform(50e3, 200e3), stream.uniform(20e3, 200e3)}, {200.0, 0.0});
    for (Gaussian& mode : estimate.modes) {
      const double sigma_m = std::exp(stream.uniform(std::log(1.0), std::log(300.0)));
      for (int axis = 0; axis < kStateSize; ++axis) mode.mean[axis] = centre[axis] + sigma_m * stream.normal();
      mode.covariance = sigma_m * sigma_m * State(1.0, 0.1, stream.uniform(0.2, 5.0), 0.1).asDiagonal().toDenseMatrix();
    }
    scene.add_track(static_cast<std::uint32_t>(i), estimate, stream.uniform(0.5, 2.0));
  }
  return scene;
}

/// n sensors of x and y that differ in nothing, tracks with the given numbers that differ in nothing: for
/// policies that take turns.
inline Scene plain_scene(int sensors, const std::vector<std::uint32_t>& numbers) {
  Scene scene;
  for (int i = 0; i < sensors; ++i) {
    scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), Matrix2::Identity(), 1.0));
  }
  for (const std::uint32_t number : numbers) {
    scene.add_track(number, make_estimate({State::Zero(), StateMatrix::Identity()}, Eigen::VectorXd::Ones(1)));
  }
  return scene;
}

/// What was chosen, by numbers from 1: {sensor, track}.
using Choice = std::pair<int, int>;

inline Choice choice_of(const Scene& scene, const Decision& decision, std::size_t look = 0) {
  const Pair& pair = decision.pair(look);
  return {static_cast<int>(pair.sensor) + 1, static_cast<int>(scene.tracks[pair.track].id.number)};
}

inline std::vector<Choice> choices(Policy& policy, Scene& scene, int scans) {
  std::vector<Choice> made;
  Decision decision;
  for (int i = 0; i < scans; ++i) {
    policy.decide(scene.situation(), decision);
    made.push_back(choice_of(scene, decision));
  }
  return made;
}

}  // namespace dwell::testing
