#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "radar/violation.hpp"

namespace dwell::restless {

inline constexpr int kMaximumStates = 6;
inline constexpr double kMostMemory = 1.0 - 1e-4;  ///< ten thousand scans

/// A small matrix without heap: states and measurements have at most kMaximumStates components.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaximumStates, kMaximumStates>;

/// How an arm can be looked at: y = H x + v, v ~ N(0, R), seen with probability P_d.
struct Sensor {
  Matrix h;               ///< m x n
  Matrix r;               ///< m x m, symmetric and positive definite
  double p_detect = 1.0;  ///< (0, 1]
};

/// One target: x' = F x + w, w ~ N(0, Q).
///
/// Its state in the scheduling problem is the predicted covariance P at the scan. A scan costs weight <C, M>, where M
/// is the covariance after it: P without a look or detection, else that of the Kalman update. Then P' = F M F' + Q.
struct Arm {
  Matrix f;             ///< n x n
  Matrix q;             ///< n x n, symmetric, positive semidefinite
  Matrix cost;          ///< C, n x n, symmetric, positive semidefinite
  double weight = 1.0;  ///< >= 0
  double dwell = 1.0;   ///< capacity that one look takes, > 0
  Matrix p0;            ///< predicted covariance at the first scan
  std::vector<Sensor> sensors;

  int states() const { return static_cast<int>(f.rows()); }
};

/// Arms that all change, looked at or not (restless), and so many looks a scan at different arms.
///
/// Capacity: each scan adds looks_per_scan to a bucket that holds at most max(looks_per_scan, largest dwell) and starts
/// with looks_per_scan; a look takes its arm's dwell.
/// The aim is the least average cost a scan or, with a discount b, the least sum of b^t cost_t.
struct Problem {
  std::optional<double> discount;  ///< (0, 1); none: average cost
  int looks_per_scan = 1;
  std::vector<Arm> arms;

  double discount_or_one() const { return discount.value_or(1.0); }
};

/// One thing that can be done in a scan.
struct Look {
  std::size_t arm = 0;
  std::size_t sensor = 0;
};

/// Everything that is wrong with the problem's numbers, one by one. Counted from 1: "arm[2].sensor[1].r".
std::vector<Violation> validate(const Problem& problem);

/// Of a problem that is valid: arms that have no finite cost, or do not forget where they started. b times what a scan
/// of all looks leaves of a difference (AllLooks::memory) must be at most kMostMemory, b times the growth of what the
/// best sensor misses below 1. Each arm alone, as if all looks were its own: that looks_per_scan suffice for all of
/// them at a finite cost is not checked; a policy that cannot do it fails as it runs.
std::vector<Violation> validate_costs(const Problem& problem);

}  // namespace dwell::restless
