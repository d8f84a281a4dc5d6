#pragma once

#include <vector>

#include <Eigen/Core>

#include "radar/violation.hpp"

namespace dwell::lti {

inline constexpr int kMaximumStates = 16;
inline constexpr int kMaximumHorizon = 10'000;

/// A sensor of a linear system: y = C x + v, v ~ N(0, R).
struct Sensor {
  Eigen::MatrixXd c;  ///< p x n, any p >= 1
  Eigen::MatrixXd r;  ///< p x p, symmetric and positive definite
  double cost = 0.0;  ///< of one look, added to the objective; >= 0
  int max_looks = 0;  ///< over the horizon; 0: no limit
};

enum class Objective {
  kSum,    ///< m sum_k tr P[k] + the cost of the looks, m sensors
  kFinal,  ///< tr P[N]
};

enum class CovarianceKind {
  kPredicted,  ///< P[k] = before the look of step k; the sum has k = 0 .. N and P[0] is the initial covariance
  kFiltered,  ///< P[k] = after the look of step k; the sum has k = 1 .. N and P[0] is where the first prediction starts
};

/// One linear system, several sensors, one look a step: which sensor, in which order?
///
///   x[k+1] = A x[k] + w[k],  w ~ N(0, W)              y_j[k] = C_j x[k] + v_j[k],  v_j ~ N(0, R_j)
///
/// A schedule names the sensor of each of N steps, 1 .. m, or 0 for none (idle). Covariances do not depend on what is
/// measured, so schedules are made before any look.
///
/// With communication noise a > 0, node i filters the look of sensor j with R_j + a I for i != j and with R_j for
/// i = j. There are then m covariances, and "m tr P" and "tr P" both stand for sum_i tr P_i.
///
/// Source  Chung et al. (2004), II; Gupta et al. (2004), 2; Evans et al. (2005), III-B (kFiltered).
struct Problem {
  int horizon = 0;          ///< N
  Eigen::MatrixXd a;        ///< n x n, stable or not
  Eigen::MatrixXd w;        ///< n x n, symmetric, positive semidefinite
  Eigen::MatrixXd initial;  ///< P[0], n x n, symmetric, positive semidefinite
  std::vector<Sensor> sensors;
  Objective objective = Objective::kSum;
  CovarianceKind covariance = CovarianceKind::kPredicted;
  bool allow_idle = false;
  double communication_noise = 0.0;  ///< a, variance per component of a look; >= 0
  bool spread = false;               ///< of max_looks, no more than ceil(k max_looks / N) by step k: see looks_by

  int states() const { return static_cast<int>(a.rows()); }
  int sensor_count() const { return static_cast<int>(sensors.size()); }
};

/// Looks that a sensor may have taken by step k = 1 .. N. Spread evenly, no sensor is ever more than a look ahead of
/// its share of the horizon, and of sensors that last for all steps together one always has a look left.
int looks_by(const Problem& problem, int sensor, int step);

/// Everything that is wrong with the problem; empty: it can be solved. Sensors are counted from 1: "sensor[1].r".
std::vector<Violation> validate(const Problem& problem);

}  // namespace dwell::lti
