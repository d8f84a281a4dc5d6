#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "radar/calibration/corrected_radar.hpp"
#include "radar/calibration/estimator.hpp"
#include "radar/frames.hpp"
#include "radar/random.hpp"

namespace dwell::testing {

inline StateMatrix constant_velocity(double dt_s) {
  StateMatrix f = StateMatrix::Identity();
  f(kX, kVx) = f(kY, kVy) = dt_s;
  return f;
}

/// Q of white-noise acceleration of density q on each axis.
inline StateMatrix white_acceleration(double q, double dt_s) {
  StateMatrix m = StateMatrix::Zero();
  m(kX, kX) = m(kY, kY) = q * dt_s * dt_s * dt_s / 3.0;
  m(kX, kVx) = m(kVx, kX) = m(kY, kVy) = m(kVy, kY) = q * dt_s * dt_s / 2.0;
  m(kVx, kVx) = m(kVy, kVy) = q * dt_s;
  return m;
}

/// One mode of white-noise acceleration; scans of 1 s, gaps up to 30.
inline MotionPrior one_mode(double q) {
  MotionPrior prior;
  prior.initial_probability = Eigen::VectorXd::Ones(1);
  for (int gap = 0; gap <= 30; ++gap) {
    prior.steps.push_back({{constant_velocity(gap)}, {white_acceleration(q, gap)}, Eigen::MatrixXd::Ones(1, 1)});
  }
  return prior;
}

/// The three radars of recorded_flights.
inline std::vector<RadarFigures> three_radars() {
  std::vector<RadarFigures> radars(3);
  const Vector2 place[] = {{0, 50e3}, {51962, -30e3}, {-60622, -35e3}};
  const double range_m[] = {15, 30, 50};
  const double azimuth_deg[] = {0.05, 0.1, 0.15};
  for (int i = 0; i < 3; ++i) {
    radars[i].position_m = place[i];
    radars[i].range_noise_floor_m = range_m[i];
    radars[i].azimuth_noise_floor_rad = azimuth_deg[i] * kDegree;
  }
  return radars;
}

struct SceneOptions {
  std::vector<RadarFigures> radars = three_radars();
  std::vector<Correction> truth = std::vector<Correction>(3);
  int scans = 600;
  int targets = 3;
  double q = 0.1;  ///< of the truth's white-noise acceleration, m^2/s^3
  double detection = 0.9;
  double turn_every_s = 0;  ///< > 0: the velocity turns by 90 degrees at once, so often; the track starts anew there
};

/// Plots of a round robin over radars and targets, one look a second: targets of 200 m/s that start 20 km out.
inline CalibrationWindow simulate(const SceneOptions& options, RandomStream stream) {
  CalibrationWindow window;
  std::vector<CorrectedRadar> radars;
  for (std::size_t i = 0; i < options.radars.size(); ++i) {
    radars.emplace_back(options.radars[i]);
    radars.back().set_correction(options.truth[i]);
    window.radar_position_m.push_back(options.radars[i].position_m);
    window.outlier_density.push_back(1.0 / (20e3 * 6.0 * kDegree));
  }
  const auto normal_vector = [&] {
    State draw;
    for (double& value : draw) value = stream.normal();
    return draw;
  };
  std::vector<State> state;
  for (int i = 0; i < options.targets; ++i) {
    const double angle = 2.0 * i + 0.3;
    const Vector2 out(std::sin(angle), std::cos(angle));
    state.push_back(make_state(20e3 * out, 200.0 * Vector2(-out.y(), out.x())));
  }
  const StateMatrix root = options.q > 0 ? StateMatrix(white_acceleration(options.q, 1.0).llt().matrixL())
                                         : StateMatrix(StateMatrix::Zero());
  std::uint32_t leg = 0;
  for (int scan = 1; scan <= options.scans; ++scan) {
    if (options.turn_every_s > 0 && scan % static_cast<int>(options.turn_every_s) == 0) {
      ++leg;
      for (State& x : state) x = make_state(position(x), {-velocity(x).y(), velocity(x).x()});
    }
    for (State& x : state) x = constant_velocity(1.0) * x + root * normal_vector();
    const auto radar = static_cast<std::size_t>(scan) % radars.size();
    const auto target = (static_cast<std::size_t>(scan) / radars.size()) % state.size();
    const bool seen = stream.uniform() < options.detection;
    const Vector2 noise(stream.normal(), stream.normal());
    const State guess = normal_vector();
    if (!seen) continue;
    CalibrationPlot plot;
    plot.scan = static_cast<std::uint64_t>(scan);
    plot.track = static_cast<std::uint32_t>(100 * leg + target);
    plot.radar = static_cast<std::uint32_t>(radar);
    plot.sigma = RangeBearingRadar(options.radars[radar]).noise(state[target]).diagonal().cwiseSqrt();
    const Vector2 sigma = radars[radar].noise(state[target]).diagonal().cwiseSqrt();
    plot.z = radars[radar].measure(state[target]) + noise.cwiseProduct(sigma);
    plot.predicted =
        state[target] + make_state({300.0 * guess[0], 300.0 * guess[2]}, {20.0 * guess[1], 20.0 * guess[3]});
    window.plots.push_back(plot);
  }
  sort_plots(window.plots);
  return window;
}

}  // namespace dwell::testing
