#pragma once

#include <Eigen/Cholesky>

#include "radar/sensor.hpp"
#include "tracker/gaussian.hpp"

namespace dwell {

/// The posterior Cramer-Rao bound conditioned on the schedule and the detections of a run: the covariance that no
/// unbiased filter of the same model goes below when it is given these looks.
///
///   C <- F C F' + Q                       at every scan
///   C^-1 <- C^-1 + H' R^-1 H              at every look that saw the target, H and R at the true state
///
/// F and Q are those of the motion that the truth is taken to have; where the truth is scripted or recorded that is
/// an assumption, which whoever shows the figure states.
/// Source  Tichavsky, Muravchik, Nehorai (1998), (21), for linear motion with Gaussian noise.
class CramerRaoBound {
 public:
  explicit CramerRaoBound(const StateMatrix& start) : covariance_(start) {}

  void predict(const StateMatrix& f, const StateMatrix& q) {
    covariance_ = symmetric_part(f * covariance_ * f.transpose() + q);
  }

  /// In Joseph's form, as the filter's own update.
  void look(const Sensor& sensor, const State& truth) {
    const MeasurementJacobian h = sensor.jacobian(truth);
    const Matrix2 r = sensor.noise(truth);
    const Matrix2 s = h * covariance_ * h.transpose() + r;
    const Eigen::Matrix<double, kStateSize, 2> k = s.llt().solve(h * covariance_).transpose();
    const StateMatrix rest = StateMatrix::Identity() - k * h;
    covariance_ = symmetric_part(rest * covariance_ * rest.transpose() + k * r * k.transpose());
  }

  const StateMatrix& covariance() const { return covariance_; }

 private:
  StateMatrix covariance_;
};

}  // namespace dwell
