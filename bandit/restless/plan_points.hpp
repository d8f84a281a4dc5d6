#pragma once

#include <vector>

#include "bandit/restless/packed.hpp"

namespace dwell::restless {

/// The predicted covariances at which the plans of one arm are made, each with what the arm's actions do there.
///
/// Covariances that are as close as `same_point`, relative to their standard deviations, are one point.
class PlanPoints {
 public:
  /// What a look with one sensor does at one point, in packed form: the gain is the one that is right there.
  struct LookMap {
    PackedMap after;     // P -> (F A) P (F A)'
    Packed after_noise;  // F K R K' F' + Q
    Packed cost;         // of the scan, weight form
    double cost_noise;
    Packed successor;  // predicted covariance after a detection
  };
  /// What n scans without a look do.
  struct Pause {
    double scans;       // n
    double discount;    // b^n
    PackedMap after;    // P -> F^n P F^n'
    Packed noise;       // covariance that n scans make of 0
    Packed cost;        // of the scans, weight form
    double cost_noise;  // of what the noise adds
  };
  struct Point {
    Packed p;
    Packed idle_successor;   // after one scan
    int pause;               // of an idle node here: index into the pauses
    Packed pause_successor;  // after it
    std::vector<LookMap> looks;
  };

  /// Pauses are of 1, 2, 4, .. scans.
  PlanPoints(const Arm& arm, double discount);

  const Arm& arm() const { return arm_; }
  std::size_t size() const { return points_.size(); }
  const Point& operator[](std::size_t k) const { return points_[k]; }
  const Pause& pause(std::size_t k) const { return pauses_[static_cast<std::size_t>(points_[k].pause)]; }
  const PackedMap& idle_map() const { return idle_map_; }  ///< P -> F P F'
  const Packed& noise() const { return q_; }               ///< Q
  const Packed& scan_cost() const { return scan_cost_; }   ///< w C, weight form
  double same_point() const { return same_point_; }

  /// The point that is the same covariance; -1: none.
  int find(const Packed& p) const;
  int find_or_add(const Packed& p);
  /// By the squares of the differences. Requires a point.
  int nearest(const Packed& p) const;
  /// Keeps the points with `keep`, in their order.
  void keep_only(const std::vector<char>& keep);
  /// Forgets all points.
  void restart(double same_point);
  /// From now on; points that are there stay. Requires less than .04: see place_pause.
  void set_same_point(double same_point) { same_point_ = same_point; }

 private:
  Packed tolerance(const Packed& p, double relative) const;
  void place_pause(Point& point) const;

  Arm arm_;
  double same_point_ = 1e-3;
  PackedMap idle_map_;
  Packed q_;
  Packed scan_cost_;
  std::vector<Pause> pauses_;
  std::vector<Point> points_;
};

}  // namespace dwell::restless
