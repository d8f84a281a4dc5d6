#include "bandit/restless/plan_points.hpp"

#include <cmath>
#include <limits>

#include "bandit/restless/covariance.hpp"

namespace dwell::restless {
namespace {

/// Doublings of a pause; a covariance that has not moved after so many scans has settled.
constexpr int kPauses = 30;
/// A pause ends that far from its start, in the distance at which covariances are one: what is one with the end is then
/// beyond the start. Requires distances below .04.
constexpr double kApart = 1.05;

bool within(const Packed& a, const Packed& b, const Packed& tolerance) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= tolerance[i])) return false;
  }
  return true;
}

}  // namespace

PlanPoints::PlanPoints(const Arm& arm, double discount)
    : arm_(arm), idle_map_(congruence(arm.f)), q_(pack_state(arm.q)), scan_cost_(pack_weight(arm.weight * arm.cost)) {
  pauses_.push_back({1.0, discount, idle_map_, q_, scan_cost_, 0.0});
  while (pauses_.size() < kPauses) {
    const Pause& half = pauses_.back();
    pauses_.push_back({2.0 * half.scans, half.discount * half.discount, half.after * half.after,
                       half.after * half.noise + half.noise,
                       half.cost + half.discount * (half.after.transpose() * half.cost),
                       half.cost_noise + half.discount * (half.cost.dot(half.noise) + half.cost_noise)});
    if (!pauses_.back().after.allFinite() || !pauses_.back().cost.allFinite()) {
      pauses_.pop_back();
      break;
    }
  }
}

/// How far each element may be from that of `p`: a part of the product of two standard deviations.
Packed PlanPoints::tolerance(const Packed& p, double relative) const {
  const Eigen::Index n = arm_.states();
  double sigma[kMaximumStates];
  Eigen::Index at = 0;
  for (Eigen::Index j = 0; j < n; at += n - j, ++j) sigma[j] = std::sqrt(p[at]);
  Packed tolerance(p.size());
  at = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i, ++at) tolerance[at] = relative * sigma[i] * sigma[j];
  }
  return tolerance;
}

int PlanPoints::find(const Packed& p) const {
  const Packed tolerance = this->tolerance(p, same_point_);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (within(p, points_[k].p, tolerance)) return static_cast<int>(k);
  }
  return -1;
}

/// The shortest pause that leaves the point's neighbourhood: what is the same as its end is another point, and not one
/// on the way. One scan where none does: the covariance has settled.
void PlanPoints::place_pause(Point& point) const {
  for (std::size_t k = 0; k < pauses_.size(); ++k) {
    const Packed end = pauses_[k].after * point.p + pauses_[k].noise;
    if (!end.allFinite()) break;
    if (within(end, point.p, tolerance(end, kApart * same_point_))) continue;
    point.pause = static_cast<int>(k);
    point.pause_successor = end;
    return;
  }
  point.pause = 0;
  point.pause_successor = point.idle_successor;
}

int PlanPoints::find_or_add(const Packed& p) {
  const int found = find(p);
  if (found >= 0) return found;
  Point point{p, idle_map_ * p + q_, 0, {}, {}};
  place_pause(point);
  const Matrix predicted = unpack_state(p, arm_.states());
  for (const Sensor& sensor : arm_.sensors) {
    const LookUpdate look = look_update(sensor, predicted);
    LookMap map;
    map.after = congruence(arm_.f * look.a);
    map.after_noise = pack_state(restless::predict(arm_, look.noise));
    map.cost = congruence(look.a).transpose() * scan_cost_;
    map.cost_noise = scan_cost_.dot(pack_state(look.noise));
    map.successor = pack_state(restless::predict(arm_, look.covariance));
    point.looks.push_back(std::move(map));
  }
  points_.push_back(std::move(point));
  return static_cast<int>(points_.size()) - 1;
}

int PlanPoints::nearest(const Packed& p) const {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const double apart = (points_[k].p - p).squaredNorm();
    if (apart < least) {
      least = apart;
      nearest = static_cast<int>(k);
    }
  }
  return nearest;
}

void PlanPoints::keep_only(const std::vector<char>& keep) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (keep[k] == 0) continue;
    if (count != k) points_[count] = std::move(points_[k]);
    ++count;
  }
  points_.resize(count);
}

void PlanPoints::restart(double same_point) {
  same_point_ = same_point;
  points_.clear();
}

}  // namespace dwell::restless
