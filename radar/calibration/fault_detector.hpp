#pragma once

#include <array>
#include <span>

#include "radar/state.hpp"

namespace dwell {

/// What a detector has found wrong with a radar.
enum class Fault { kNone, kBias, kNoise, kDetection };

/// What one mode of a track expects of a plot.
struct ExpectedPlot {
  double probability;  ///< c_j
  Vector2 nu;          ///< z - h(x_j)
  Matrix2 track;       ///< H P_j H'
};

/// Watches one radar's plots and detections for what it should not do, by cumulative sums of log likelihood ratios
/// (Page). A plot's predicted density, of the modes and of a plot that is not of the track's target, with the quietest
/// mode q (least |H P H'|) alone under the question,
///
///   p(b, k) = c_q N(nu_q; b, H P_q H' + k^2 R) + sum_j!=q c_j N(nu_j; 0, H P_j H' + R) + f
///
/// and, with sigma a component's root of H P_q H' + R, the sums of log p(b, k) / p(0, 1) for
///
///   bias   b = +-1.5 sigma in one component (four sums)     noise  k = 2
///   gross  k = 20: errors of 5 sigma and more
///
/// and of lost detections, half the P_d: log 1/2 seen, log (1 - p/2) / (1 - p) missed. In each
///
///   g <- max(0, g + min(ratio, 7.9)),   flagged when some g > h.
///
/// What another mode explains is no evidence: innovations in a turn are all of one sign, and would look like a bias.
/// As long as the density is right the exponential of a ratio has a mean of 1 or less, and a sum is flagged falsely
/// once in e^h plots at most often (Lorden), whatever the alternative; seven sums and 10^5 plots between false flags
/// give h = log(7 10^5) = 13.5. A plot counts 7.9 at most: one false plot flags nothing, and a gross error is flagged
/// by the second. While flagged the question is turned round, healthy against k = 3 of all modes (of lost detections,
/// against half the P_d), and it is cleared at log 10^3.
/// Source  Page (1954), Biometrika 41, 100; Lorden (1971), Ann. Math. Statist. 42, 1897, theorem 2.
class FaultDetector {
 public:
  /// The plot of a look, the noise of the radar that is trusted, and f > 0, per unit of measurement volume. Whether the
  /// plot is a gross error rather than what was expected.
  bool add_plot(std::span<const ExpectedPlot> modes, const Matrix2& r, double false_density);
  /// A look that should have seen its target with probability `detection`.
  void add_look(bool detected, double detection);

  Fault fault() const { return fault_; }

 private:
  void add(double& sum, double ratio, Fault fault);
  void add_healthy(double ratio);

  std::array<double, 4> bias_{};
  double gross_ = 0.0;
  double noise_ = 0.0;
  double detection_ = 0.0;
  double healthy_ = 0.0;
  Fault fault_ = Fault::kNone;
};

}  // namespace dwell
