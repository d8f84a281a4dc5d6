#pragma once

#include <cmath>

namespace dwell {

/// How often a radar sees what it looks at, against its configured P_d, by counting with forgetting.
///
///   scale = (w p + D) / (w p + E),   D = sum_i g^(n-i) d_i,  E = sum_i g^(n-i) p_i,  n' = sum_i g^(n-i),  p = E / n'
///
/// d_i is 1 for a detection, p_i the configured P_d. With one P_d for all looks, scale x P_d is the posterior mean of
/// the Beta-Bernoulli model whose prior has the mean P_d and the weight of w looks; without forgetting (g = 1) that is
/// exact Bayes. Where P_d depends on range it is the ratio of seen to expected, drawn to one.
/// Source  Gelman et al. (2013), Bayesian Data Analysis, 2.1; West, Harrison (1997), 2.3.2 and 14.4, for the discount
/// g.
class DetectionCount {
 public:
  static constexpr double kPriorWeight = 2.0;  ///< w, looks: one unlucky pair of them does not condemn a radar
  static constexpr double kForgetting = 0.99;  ///< g: a memory of 100 looks; P_d to .03 at .9

  void add(bool detected, double configured) {
    detections_ = kForgetting * detections_ + (detected ? 1.0 : 0.0);
    expected_ = kForgetting * expected_ + configured;
    looks_ = kForgetting * looks_ + 1.0;
  }

  double scale() const {
    if (expected_ <= 0.0) return 1.0;
    const double prior = kPriorWeight * expected_ / looks_;
    return (prior + detections_) / (prior + expected_);
  }
  /// Posterior 1-sigma of P_d where the configured one is `configured`.
  double standard_error(double configured) const {
    const double p = std::fmin(scale() * configured, 1.0);
    return std::sqrt(p * (1.0 - p) / (kPriorWeight + looks_ + 1.0));
  }
  /// Looks that still count.
  double looks() const { return looks_; }

 private:
  double detections_ = 0.0;
  double expected_ = 0.0;
  double looks_ = 0.0;
};

/// False plots per metre and radian by counting with forgetting: Gamma-Poisson,
///
///   density = (w v c + F) / (w v + V),   F = sum_i g^(n-i) f_i,  V = sum_i g^(n-i) v_i
///
/// f_i false plots in the volume v_i of a look's footprint. The prior has the mean c, the configured density, and the
/// weight of w looks of the mean volume v, as in DetectionCount. Without forgetting that is exact Bayes.
/// Source  Gelman et al. (2013), 2.6.
class ClutterCount {
 public:
  void add(int false_plots, double volume) {
    plots_ = DetectionCount::kForgetting * plots_ + false_plots;
    volume_ = DetectionCount::kForgetting * volume_ + volume;
    looks_ = DetectionCount::kForgetting * looks_ + 1.0;
  }

  /// Posterior mean; the configured density before the first look.
  double density(double configured) const {
    return looks_ > 0.0 ? (prior_volume() * configured + plots_) / (prior_volume() + volume_) : configured;
  }
  /// Posterior 1-sigma, with half a plot more: none seen is not none. 0 before the first look.
  double standard_error(double configured) const {
    if (looks_ <= 0.0) return 0.0;
    return std::sqrt(prior_volume() * configured + plots_ + 0.5) / (prior_volume() + volume_);
  }

 private:
  double prior_volume() const { return DetectionCount::kPriorWeight * volume_ / looks_; }

  double looks_ = 0.0;
  double plots_ = 0.0;
  double volume_ = 0.0;
};

}  // namespace dwell
