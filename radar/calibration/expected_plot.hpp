#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <Eigen/LU>

#include "radar/state.hpp"

namespace dwell {

/// What one mode of a track expects of a plot.
struct ExpectedPlot {
  double probability;  ///< c_j
  Vector2 nu;          ///< z - h(x_j)
  Matrix2 track;       ///< H P_j H'
};

/// What all of them do, with the noise R of a radar that is trusted and the density f > 0 of a plot that is not of the
/// track's target, per unit of measurement volume:
///
///   p(k) = c_q N(nu_q; 0, H P_q H' + k^2 R) + sum_j!=q c_j N(nu_j; 0, H P_j H' + R) + f
///
/// the quietest mode q (least |H P H'|) alone under the question, of a shift or of noise of k times its sigma. What
/// another mode explains is no evidence: innovations in a turn are all of one sign, and would look like a bias.
class PlotDensity {
 public:
  PlotDensity(std::span<const ExpectedPlot> modes, const Matrix2& r, double false_density)
      : modes_(modes), r_(r), false_density_(false_density) {
    quiet_ = &*std::min_element(modes.begin(), modes.end(), [](const ExpectedPlot& a, const ExpectedPlot& b) {
      return a.track.determinant() < b.track.determinant();
    });
    as_expected_ = of_modes(1.0);
    rest_ = std::max(as_expected_ - of(*quiet_, 1.0), false_density);
  }

  /// p(1).
  double as_expected() const { return as_expected_; }
  /// sum_j c_j N(nu_j; 0, H P_j H' + k^2 R) + f.
  double of_modes(double k) const {
    double sum = false_density_;
    for (const ExpectedPlot& mode : modes_) sum += of(mode, k);
    return sum;
  }
  /// log p(k) / p(1).
  double log_noise_ratio(double k) const { return std::log((of(*quiet_, k) + rest_) / as_expected_); }
  /// The same of a shift d of the quietest mode.
  double log_shift_ratio(const Vector2& d) const {
    ExpectedPlot shifted = *quiet_;
    shifted.nu -= d;
    return std::log((of(shifted, 1.0) + rest_) / as_expected_);
  }

 private:
  double of(const ExpectedPlot& mode, double k) const {
    const Matrix2 s = mode.track + k * k * r_;
    return mode.probability * std::exp(-0.5 * mode.nu.dot(s.inverse() * mode.nu)) /
           (2.0 * std::numbers::pi * std::sqrt(s.determinant()));
  }

  std::span<const ExpectedPlot> modes_;
  Matrix2 r_;
  double false_density_;
  const ExpectedPlot* quiet_;
  double as_expected_;
  double rest_;
};

}  // namespace dwell
