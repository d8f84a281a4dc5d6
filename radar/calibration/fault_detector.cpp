#include "radar/calibration/fault_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace dwell {
namespace {

constexpr double kShift = 1.5;        // sigma
constexpr double kGrossScale = 20.0;  // of the noise
constexpr double kNoiseScale = 2.0;
constexpr double kFaultyScale = 3.0;  // what a healthy radar is told from
constexpr double kMostOfAPlot = 7.9;  // more than h / 2, less than h
constexpr double kFlag = 13.459;      // log(7e5)
constexpr double kClear = 6.908;      // log(1e3)

using Modes = std::span<const ExpectedPlot>;

/// The quietest alone.
Modes quietest(Modes modes) {
  const auto quiet = std::min_element(modes.begin(), modes.end(), [](const ExpectedPlot& a, const ExpectedPlot& b) {
    return a.track.determinant() < b.track.determinant();
  });
  return modes.subspan(static_cast<std::size_t>(quiet - modes.begin()), 1);
}

/// sum_j c_j N(nu_j; b, H P_j H' + k^2 R).
double density(Modes modes, const Matrix2& r, const Vector2& shift, double scale) {
  double sum = 0.0;
  for (const ExpectedPlot& mode : modes) {
    const Matrix2 s = mode.track + scale * scale * r;
    const Vector2 nu = mode.nu - shift;
    sum += mode.probability * std::exp(-0.5 * nu.dot(s.inverse() * nu)) /
           (2.0 * std::numbers::pi * std::sqrt(s.determinant()));
  }
  return sum;
}

}  // namespace

bool FaultDetector::add_plot(std::span<const ExpectedPlot> modes, const Matrix2& r, double false_density) {
  const Vector2 none = Vector2::Zero();
  const double expected = density(modes, r, none, 1.0) + false_density;
  const Modes quiet = quietest(modes);
  const double rest = std::max(expected - density(quiet, r, none, 1.0), false_density);
  const auto ratio = [&](const Vector2& shift, double scale) {
    return std::log((density(quiet, r, shift, scale) + rest) / expected);
  };
  const double gross = ratio(none, kGrossScale);
  if (fault_ == Fault::kBias || fault_ == Fault::kNoise) {
    add_healthy(std::log(expected / (density(modes, r, none, kFaultyScale) + false_density)));
  }
  if (fault_ != Fault::kNone) return gross > 0.0;
  for (int k = 0; k < 2; ++k) {
    const Vector2 shift = kShift * std::sqrt(quiet[0].track(k, k) + r(k, k)) * Vector2::Unit(k);
    add(bias_[2 * k], ratio(shift, 1.0), Fault::kBias);
    add(bias_[2 * k + 1], ratio(-shift, 1.0), Fault::kBias);
  }
  add(gross_, gross, Fault::kBias);
  add(noise_, ratio(none, kNoiseScale), Fault::kNoise);
  return gross > 0.0;
}

void FaultDetector::add_look(bool detected, double detection) {
  const double p = std::clamp(detection, 0.01, 0.99);
  const double ratio = detected ? std::log(0.5) : std::log((1.0 - 0.5 * p) / (1.0 - p));
  if (fault_ == Fault::kNone) {
    add(detection_, ratio, Fault::kDetection);
  } else if (fault_ == Fault::kDetection) {
    add_healthy(-ratio);
  }
}

void FaultDetector::add(double& sum, double ratio, Fault fault) {
  sum = std::max(0.0, sum + std::min(ratio, kMostOfAPlot));
  if (sum > kFlag && fault_ == Fault::kNone) fault_ = fault;
}

void FaultDetector::add_healthy(double ratio) {
  healthy_ = std::max(0.0, healthy_ + ratio);
  if (healthy_ > kClear) *this = FaultDetector();
}

}  // namespace dwell
