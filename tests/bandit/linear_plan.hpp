#pragma once

#include <functional>
#include <limits>

#include <Eigen/LU>

#include "tests/bandit/scene.hpp"

namespace dwell::testing {

/// Tracks of one mode under linear sensors: every plan of looks by enumeration, with Kalman's own steps and nothing of
/// bandit/. Position variances, weighted, summed over scans and tracks, plus the use of the sensors.
class LinearPlan {
 public:
  using Allowed = std::function<bool(int scan, std::size_t sensor, const std::vector<int>& looks)>;

  LinearPlan(Scene& scene, int scans) : scene_(scene), scans_(scans), bank_(*scene.situation().bank) {
    for (const Track& track : scene.tracks) now_.push_back(track.estimate.modes[0].covariance);
  }

  double without_looks() const {
    return follow(now_, 0, [](auto&, int) { return 0.0; });
  }

  /// Of the best plan that begins with the pair; `looks` are the sensors of the scans before, -1: none.
  double best_from(const Pair& first, const Allowed& allowed = all) const {
    std::vector<int> looks;
    return best(now_, 0, looks, allowed, &first);
  }

  static bool all(int /*scan*/, std::size_t /*sensor*/, const std::vector<int>& /*looks*/) { return true; }

 private:
  using Covariances = std::vector<StateMatrix>;

  double cost(const Covariances& p) const {
    double sum = 0.0;
    for (std::size_t t = 0; t < p.size(); ++t) sum += scene_.tracks[t].weight * (p[t](kX, kX) + p[t](kY, kY));
    return sum;
  }

  void predict(Covariances& p) const {
    for (StateMatrix& one : p) one = bank_.f[0] * one * bank_.f[0].transpose() + bank_.q[0];
  }

  template <class Look>
  double follow(Covariances p, int scan, const Look& look) const {
    double sum = 0.0;
    for (; scan < scans_; ++scan) {
      if (scan > 0) predict(p);
      sum += look(p, scan) + cost(p);
    }
    return sum;
  }

  double best(Covariances p, int scan, std::vector<int>& looks, const Allowed& allowed, const Pair* only) const {
    if (scan == scans_) return 0.0;
    if (scan > 0) predict(p);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < p.size(); ++t) {
      for (std::size_t s = 0; s < scene_.sensors.size(); ++s) {
        if (only != nullptr && (only->track != t || only->sensor != s)) continue;
        if (only == nullptr && !allowed(scan, s, looks)) continue;
        Covariances seen = p;
        const MeasurementJacobian h = scene_.sensors[s]->jacobian(State::Zero());
        const Matrix2 r = scene_.sensors[s]->noise(State::Zero());
        const Matrix2 innovation = h * p[t] * h.transpose() + r;
        const StateMatrix after = p[t] - p[t] * h.transpose() * innovation.inverse() * h * p[t];
        const double p_d = scene_.sensors[s]->detection_probability(State::Zero());
        seen[t] = p_d * after + (1.0 - p_d) * p[t];
        looks.push_back(static_cast<int>(s));
        least = std::min(least, scene_.usage_cost[s] + cost(seen) + best(seen, scan + 1, looks, allowed, nullptr));
        looks.pop_back();
      }
    }
    if (least < std::numeric_limits<double>::infinity()) return least;
    looks.push_back(-1);
    const double idle = cost(p) + best(p, scan + 1, looks, allowed, nullptr);
    looks.pop_back();
    return idle;
  }

  Scene& scene_;
  int scans_;
  DiscreteBank bank_;
  Covariances now_;
};

/// Sensors of mixed position and velocity and tracks of one mode, all of them different.
inline Scene linear_scene(int sensors, int tracks, std::uint64_t seed) {
  Scene scene;
  RandomStream stream(seed);
  for (int i = 0; i < sensors; ++i) {
    MeasurementJacobian c = position_selector();
    for (double& value : c.reshaped()) value += 0.3 * stream.normal();
    const double r = std::exp(stream.uniform(-2.0, 3.0));
    scene.add_sensor(std::make_shared<LinearSensor>(c, r * Matrix2::Identity(), stream.uniform(0.5, 1.0)));
  }
  for (int i = 1; i <= tracks; ++i) {
    StateMatrix root;
    for (double& value : root.reshaped()) value = stream.normal();
    const StateMatrix p = root * root.transpose() + 0.1 * StateMatrix::Identity();
    scene.add_track(static_cast<std::uint32_t>(i), make_estimate({State::Zero(), p}, Eigen::VectorXd::Ones(1)),
                    stream.uniform(0.5, 2.0));
  }
  return scene;
}

}  // namespace dwell::testing
