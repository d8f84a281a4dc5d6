#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include "radar/calibration/innovations.hpp"
#include "radar/calibration/trajectories.hpp"

namespace dwell::calibration {

inline constexpr int kBiasSize = 3;  // range_m, azimuth_rad, time_s

/// (z - h(x, b)) / sigma of one plot. Scalar T: double or a dual number.
struct PlotResidual {
  Vector2 z;
  Vector2 sigma;  ///< with the radar's noise scales
  Vector2 radar_m;

  template <class T>
  bool operator()(const T* x, const T* b, T* residual) const {
    using std::atan2;
    using std::sqrt;
    const T dx = x[kX] + b[2] * x[kVx] - radar_m.x();
    const T dy = x[kY] + b[2] * x[kVy] - radar_m.y();
    // In axes turned to the plot's bearing the difference of bearings is an angle near zero: nothing to wrap.
    const double sine = std::sin(z[1]);
    const double cosine = std::cos(z[1]);
    residual[0] = (z[0] - sqrt(dx * dx + dy * dy) - b[0]) / sigma[0];
    residual[1] = (-atan2(dx * cosine - dy * sine, dx * sine + dy * cosine) - b[1]) / sigma[1];
    return true;
  }
};

/// The same where the state is known.
struct KnownPlotResidual {
  PlotResidual plot;
  State truth;

  template <class T>
  bool operator()(const T* b, T* residual) const {
    const Eigen::Matrix<T, kStateSize, 1> x = truth.cast<T>();
    return plot(x.data(), b, residual);
  }
};

/// A gap's factor as squares: for each axis v of Lambda with its value d, sqrt(d) v' x - v' eta / sqrt(d).
class MotionResidual final : public ceres::SizedCostFunction<2 * kStateSize, kStateSize, kStateSize> {
 public:
  explicit MotionResidual(const Gap& gap) {
    const Eigen::SelfAdjointEigenSolver<PairMatrix> solver(gap.information);
    const PairVector root = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const double least = 1e-9 * root.maxCoeff();  // under it is rounding
    for (int k = 0; k < 2 * kStateSize; ++k) {
      if (root[k] <= least) continue;
      rows_.row(k) = root[k] * solver.eigenvectors().col(k).transpose();
      offset_[k] = solver.eigenvectors().col(k).dot(gap.pull) / root[k];
    }
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    using Rows = Eigen::Matrix<double, 2 * kStateSize, kStateSize, Eigen::RowMajor>;
    Eigen::Map<PairVector>{residuals} = rows_.leftCols<kStateSize>() * Eigen::Map<const State>(parameters[0]) +
                                        rows_.rightCols<kStateSize>() * Eigen::Map<const State>(parameters[1]) -
                                        offset_;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<Rows>{jacobians[0]} = rows_.leftCols<kStateSize>();
    if (jacobians[1] != nullptr) Eigen::Map<Rows>{jacobians[1]} = rows_.rightCols<kStateSize>();
    return true;
  }

 private:
  PairMatrix rows_ = PairMatrix::Zero();
  PairVector offset_ = PairVector::Zero();
};

/// (x - mean) / sigma, each element by its own.
template <int kSize>
class PriorResidual final : public ceres::SizedCostFunction<kSize, kSize> {
 public:
  using Vector = Eigen::Matrix<double, kSize, 1>;
  PriorResidual(const Vector& mean, const Vector& sigma) : mean_(mean), weight_(sigma.cwiseInverse()) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector>{residuals} = (Eigen::Map<const Vector>(parameters[0]) - mean_).cwiseProduct(weight_);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>{jacobians[0]} = weight_.asDiagonal();
    return true;
  }

 private:
  Vector mean_;
  Vector weight_;
};

/// Minus twice the log of (1 - eps) N(e; 0, I) + eps u, less its value at e = 0; s = |e|^2, and u the outlier density
/// in units of the whitened plot.
class OutlierLoss final : public ceres::LossFunction {
 public:
  explicit OutlierLoss(double whitened_density)
      : outlier_(2.0 * std::numbers::pi * kOutlierProbability / (1.0 - kOutlierProbability) * whitened_density) {}

  /// Probability that the plot is the target's.
  double weight(double s) const {
    const double inlier = std::exp(-0.5 * s);
    return inlier / (inlier + outlier_);
  }

  void Evaluate(double s, double rho[3]) const override {
    const double w = weight(s);
    rho[0] = -2.0 * std::log((std::exp(-0.5 * s) + outlier_) / (1.0 + outlier_));
    rho[1] = w;
    rho[2] = -0.5 * w * (1.0 - w);
  }

 private:
  double outlier_;
};

}  // namespace dwell::calibration
