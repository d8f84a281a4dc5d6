#pragma once

#include "radar/calibration/expected_plot.hpp"

namespace dwell {

/// What a detector has found wrong with a radar.
enum class Fault { kNone, kBias, kNoise, kDetection };

/// Above it a cumulative sum of log likelihood ratios flags. As long as the density is right the exponential of a ratio
/// has a mean of 1 or less, and a sum is flagged falsely once in e^h plots at most often, whatever the alternative:
/// log(7 10^5) of each, for seven sums a radar (three here, four in BiasDetector) and 10^5 of its plots between false
/// flags.
/// Source  Lorden (1971), Ann. Math. Statist. 42, 1897, theorem 2.
inline constexpr double kFlag = 13.459;
/// What a plot counts at most, more than h / 2 and less than h: one false plot flags nothing, and a gross error is
/// flagged by the second.
inline constexpr double kMostOfAPlot = 7.9;

/// Watches one radar's plots and detections for what it should not do, by cumulative sums of log likelihood ratios
/// (Page): of the plot's density (PlotDensity),
///
///   gross  k = 20: errors of 5 sigma and more, which are a bias      noise  k = 2
///
/// and of lost detections, half the P_d: log 1/2 seen, log (1 - p/2) / (1 - p) missed. In each
///
///   g <- max(0, g + min(ratio, kMostOfAPlot)),   flagged when some g > kFlag.
///
/// A bias that is not gross is told by BiasDetector. While flagged the question is turned round, healthy against k = 3
/// of all modes (of lost detections, against half the P_d), and it is cleared at log 10^3.
/// Source  Page (1954), Biometrika 41, 100.
class FaultDetector {
 public:
  /// The plot of a look. Whether it is a gross error rather than what was expected.
  bool add_plot(const PlotDensity& density);
  /// A look that should have seen its target with probability `detection`.
  void add_look(bool detected, double detection);
  /// What others have found.
  void flag(Fault fault) {
    *this = FaultDetector();
    fault_ = fault;
  }

  Fault fault() const { return fault_; }
  /// The sum of lost detections; while they are flagged, that of their return. Above zero a change is suspected.
  double detection_sum() const { return fault_ == Fault::kDetection ? healthy_ : detection_; }

 private:
  void add(double& sum, double ratio, Fault fault);
  void add_healthy(double ratio);

  double gross_ = 0.0;
  double noise_ = 0.0;
  double detection_ = 0.0;
  double healthy_ = 0.0;
  Fault fault_ = Fault::kNone;
};

}  // namespace dwell
