#include "bandit/restless/scalar_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bandit/restless/scalar_arm.hpp"
#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

constexpr double kUnlikely = 1e-12;
constexpr int kMostMisses = 400;

}  // namespace

ScalarMesh::ScalarMesh(const Arm& arm, double discount, double high, int points) : arm_(arm), discount_(discount) {
  DWELL_ASSERT(arm.states() == 1 && arm.q(0, 0) > 0.0);
  double least_detection = 1.0;
  for (const Sensor& sensor : arm.sensors) least_detection = std::min(least_detection, sensor.p_detect);
  const double f2 = arm.f(0, 0) * arm.f(0, 0);
  const double q = arm.q(0, 0);
  double top = std::max(high, arm.p0(0, 0));
  double probability = 1.0;
  for (int miss = 0; miss < kMostMisses && probability > kUnlikely; ++miss) {
    probability *= 1.0 - least_detection;
    top = std::max(top, f2 * top + q);
  }
  low_log_ = std::log(q);
  step_log_ = (std::log(top) - low_log_) / (points - 1);
  for (int j = 0; j < points; ++j) p_.push_back(std::exp(low_log_ + j * step_log_));
  p_.front() = q;
  seen_.resize(arm.sensors.size());
  seen_cost_.resize(arm.sensors.size());
  for (const double p : p_) {
    idle_.push_back(place(f2 * p + q));
    for (std::size_t s = 0; s < arm.sensors.size(); ++s) {
      const double after = scalar_arm(arm, arm.sensors[s])->after_look(p);
      seen_[s].push_back(place(f2 * after + q));
      seen_cost_[s].push_back(arm.weight * arm.cost(0, 0) * after);
    }
  }
  v_.assign(p_.size(), 0.0);
  work_.assign(p_.size(), 0.0);
}

ScalarMesh::Place ScalarMesh::place(double p) const {
  const auto last = static_cast<int>(p_.size()) - 1;
  if (p_.empty()) return {};
  if (p >= p_.back()) return {last - 1, 1.0};
  int below = std::clamp(static_cast<int>((std::log(p) - low_log_) / step_log_), 0, last - 1);
  while (below > 0 && p_[static_cast<std::size_t>(below)] > p) --below;
  while (below < last - 1 && p_[static_cast<std::size_t>(below) + 1] < p) ++below;
  const double from = p_[static_cast<std::size_t>(below)];
  const double to = p_[static_cast<std::size_t>(below) + 1];
  return {below, std::max(0.0, (p - from) / (to - from))};
}

double ScalarMesh::at(const std::vector<double>& v, const Place& place) const {
  const auto below = static_cast<std::size_t>(place.below);
  return v[below] + place.above_share * (v[below + 1] - v[below]);
}

PricedValue ScalarMesh::solve(double price) {
  constexpr int kMost = 200'000;
  const bool average = discount_ == 1.0;
  const double mix = average ? 0.5 : 1.0;
  price_ = price;
  const std::size_t points = p_.size();
  if (!average) std::fill(v_.begin(), v_.end(), 0.0);
  std::vector<double> next(points), next_work(points);
  PricedValue value;
  for (int step = 0; step < kMost; ++step) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double low_work = 0.0;
    double scale = 0.0;
    for (std::size_t j = 0; j < points; ++j) {
      const double idle = arm_.weight * arm_.cost(0, 0) * p_[j] + discount_ * at(v_, idle_[j]);
      const double idle_work = discount_ * at(work_, idle_[j]);
      double least = idle;
      double work = idle_work;
      for (std::size_t s = 0; s < seen_.size(); ++s) {
        const double p_d = arm_.sensors[s].p_detect;
        const double look =
            p_d * (seen_cost_[s][j] + discount_ * at(v_, seen_[s][j])) + (1.0 - p_d) * idle + price * arm_.dwell;
        if (look >= least) continue;
        least = look;
        work = p_d * discount_ * at(work_, seen_[s][j]) + (1.0 - p_d) * idle_work + arm_.dwell;
      }
      const double change = least - v_[j];
      if (change < low) low_work = work - work_[j];
      low = std::min(low, change);
      high = std::max(high, change);
      scale = std::max(scale, std::abs(least));
      next[j] = v_[j] + mix * change;
      next_work[j] = work_[j] + mix * (work - work_[j]);
    }
    std::swap(v_, next);
    std::swap(work_, next_work);
    if (average) {
      value = {low - price * low_work, low_work};
      if (high - low <= 1e-10 * std::abs(low)) break;
      if (step % 256 == 255) {
        const double shift = v_[0], shift_work = work_[0];
        for (double& v : v_) v -= shift;
        for (double& w : work_) w -= shift_work;
      }
    } else if (std::max(-low, high) <= 1e-13 * scale) {
      break;
    }
  }
  if (average) return value;
  return value_at_start();
}

/// One step of the dynamic programme from p0 itself, which may be below the grid; its successors are not.
PricedValue ScalarMesh::value_at_start() const {
  const double p = arm_.p0(0, 0);
  const Place idle_next = place(arm_.f(0, 0) * arm_.f(0, 0) * p + arm_.q(0, 0));
  const double idle = arm_.weight * arm_.cost(0, 0) * p + discount_ * at(v_, idle_next);
  const double idle_work = discount_ * at(work_, idle_next);
  double least = idle;
  double work = idle_work;
  for (std::size_t s = 0; s < arm_.sensors.size(); ++s) {
    const double look = look_cost(s, p, idle);
    if (look >= least) continue;
    least = look;
    const ScalarArm scalar = *scalar_arm(arm_, arm_.sensors[s]);
    work = scalar.p_detect * discount_ * at(work_, place(scalar.predict(scalar.after_look(p)))) +
           (1.0 - scalar.p_detect) * idle_work + arm_.dwell;
  }
  return {least - price_ * work, work};
}

double ScalarMesh::look_cost(std::size_t sensor, double p, double idle) const {
  const ScalarArm scalar = *scalar_arm(arm_, arm_.sensors[sensor]);
  const double after = scalar.after_look(p);
  const double seen = scalar.weight * after + discount_ * at(v_, place(scalar.predict(after)));
  return scalar.p_detect * seen + (1.0 - scalar.p_detect) * idle + price_ * arm_.dwell;
}

double ScalarMesh::look_gain(std::size_t sensor, double p) const {
  const ScalarArm scalar = *scalar_arm(arm_, arm_.sensors[sensor]);
  const double idle = scalar.weight * p + discount_ * at(v_, place(scalar.predict(p)));
  return idle - look_cost(sensor, p, idle);
}

double calibrated_index(ScalarMesh& mesh, std::size_t sensor, double p, double high_price) {
  double low = 0.0;
  double high = high_price;
  for (int halving = 0; halving < 40 && high - low > 1e-9 * high; ++halving) {
    const double price = 0.5 * (low + high);
    mesh.solve(price);
    (mesh.look_gain(sensor, p) > 0.0 ? low : high) = price;
  }
  return 0.5 * (low + high);
}

}  // namespace dwell::restless
