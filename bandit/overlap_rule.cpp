#include "bandit/overlap_rule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace dwell {
namespace {

double value(const WeightedNormal& f, const Vector2& y) { return -f.log_density(y); }
Vector2 gradient(const WeightedNormal& f, const Vector2& y) { return f.information * (y - f.z); }

/// How far from y along d the value -log f reaches `level`; 0 where it is above already and rising.
double reach(const WeightedNormal& f, const Vector2& y, const Vector2& d, double level) {
  const Vector2 information_d = f.information * d;
  const double curvature = d.dot(information_d);
  const double slope = (y - f.z).dot(information_d);
  const double rise = level - value(f, y);
  return std::max(0.0, (std::sqrt(std::max(0.0, slope * slope + 2.0 * curvature * rise)) - slope) / curvature);
}

double reach(const WeightedNormal& a, const WeightedNormal& b, const Vector2& y, const Vector2& d, double level) {
  return std::min(reach(a, y, d, level), reach(b, y, d, level));
}

struct Peak {
  Vector2 y;
  double height;    // -log h
  Matrix2 hessian;  // of -log h
};

/// The root in x = logit(s) of x + A - B at y(s): it rises by 1 at least, and lies between its values at z_b
/// and z_a.
Peak find_peak(const WeightedNormal& a, const WeightedNormal& b) {
  constexpr int kMostSteps = 100;
  constexpr double kTolerance = 1e-9;  // of x
  const auto difference = [&](const Vector2& y) { return value(a, y) - value(b, y); };
  double low = -difference(b.z);
  double high = -difference(a.z);
  double x = std::clamp(0.0, std::min(low, high), std::max(low, high));
  Peak peak;
  for (int step = 0; step < kMostSteps; ++step) {
    const double s = 1.0 / (1.0 + std::exp(-x));
    const Matrix2 information = (1.0 - s) * a.information + s * b.information;
    const Matrix2 covariance = information.inverse();
    peak.y = a.z + covariance * (s * (b.information * (b.z - a.z)));
    const Vector2 slope = gradient(a, peak.y) - gradient(b, peak.y);
    const double variance = s * (1.0 - s);
    peak.hessian = information + variance * slope * slope.transpose();
    const double excess = x + difference(peak.y);
    (excess > 0.0 ? high : low) = x;
    double next = x - excess / (1.0 + variance * slope.dot(covariance * slope));
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) <= kTolerance) break;
    x = next;
  }
  const double value_a = value(a, peak.y);
  const double value_b = value(b, peak.y);
  peak.height = std::max(value_a, value_b) + std::log1p(std::exp(-std::abs(value_a - value_b)));
  return peak;
}

}  // namespace

OverlapRule::OverlapRule(int nodes) : radii_(gauss_legendre(nodes)), depth_(4.0 + 0.6 * nodes) {
  const int rays = 2 * (nodes / 2) + 4;
  for (int k = 0; k < rays; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.5) / rays;
    directions_.emplace_back(std::cos(angle), std::sin(angle));
  }
  nodes_.resize(radii_.size() * directions_.size());
}

std::span<const OverlapRule::Node> OverlapRule::place(const WeightedNormal& a, const WeightedNormal& b) {
  constexpr double kWidthLevel = 2.0;
  const Peak peak = find_peak(a, b);
  const Eigen::LLT<Matrix2> metric(a.information + b.information);
  const Matrix2 half = metric.matrixL().solve(peak.hessian);
  Eigen::SelfAdjointEigenSolver<Matrix2> axes;
  axes.computeDirect(metric.matrixL().solve(half.transpose()));
  Matrix2 frame = metric.matrixU().solve(axes.eigenvectors());
  Vector2 centre = peak.y;
  for (int i = 0; i < 2; ++i) {
    const Vector2 axis = frame.col(i);
    const double ahead = reach(a, b, peak.y, axis, peak.height + kWidthLevel);
    const double behind = reach(a, b, peak.y, -axis, peak.height + kWidthLevel);
    centre += 0.5 * (ahead - behind) * axis;
    frame.col(i) *= 0.5 * (ahead + behind);
  }
  const double sector =
      2.0 * std::numbers::pi / static_cast<double>(directions_.size()) * std::abs(frame.determinant());
  auto node = nodes_.begin();
  for (const Vector2& direction : directions_) {
    const Vector2 ray = frame * direction;
    const double length = reach(a, b, centre, ray, peak.height + depth_);
    for (const QuadratureNode& radius : radii_) {
      const double rho = length * radius.u;
      *node++ = {centre + rho * ray, sector * rho * length * radius.weight};
    }
  }
  return nodes_;
}

}  // namespace dwell
