#pragma once

#include <optional>
#include <span>
#include <vector>

#include "radar/plot.hpp"
#include "tracker/measurement.hpp"

namespace dwell {

/// A certain detection that fails still is no proof that the target is gone: it is counted as this P_d.
inline constexpr double kLargestBelievedDetection = 0.99;

/// What the plots of one look may be to one track: the events of probabilistic data association.
///
///   w_0j = c_j (1 - D_j P_G)                    no plot in the gate is the target's
///   w_ij = c_j D_j N(nu_ij; 0, S_j) l_i / lambda    plot i is, the others are false
///
/// for mode j, as ratios to "all plots are false". c_j is the predicted mode probability; D_j = P_d F_j, P_d that of
/// the combined mean, at most kLargestBelievedDetection, and F_j the probability of being in the footprint; lambda the
/// density of false plots (`clutter_density`), at least that of kLeastClutter plots in a 16-gate: what is not explained
/// otherwise, as another target's plot, still is no contradiction. l_i is what the class that plot i declares says for
/// it (declaration_ratio of tracker/class_belief.hpp; 1 without classes).
///
/// A plot is in when any mode's squared distance is under the gate, and then counts in every mode. P_G = 1 - exp(-gate
/// / 2) is that of a mode's own ellipse: the plots that the other modes let in besides are not counted, an error of at
/// most exp(-gate / 2), 3.4e-4 at 16.
/// Source   Bar-Shalom, Li, Multitarget-Multisensor Tracking (1995), 3.4 (parametric PDA) and 4.5 (with an IMM).
class AssociationEvents {
 public:
  static constexpr double kLeastClutter = 1e-6;

  /// Room for looks of so many plots.
  void reserve(std::size_t plots, std::size_t modes);

  /// The events of `plots` (those that are finite; one that came twice, bit for bit, counts once) for a predicted
  /// estimate, in a look that points at `pointing`. No allocation once the vectors have grown to plots x modes.
  /// Errors   kNotPositiveDefinite of an S_j, kNotFinite of a weight; there are no events then.
  Numerics list(const Sensor& sensor, UpdateForm form, double gate, const ImmEstimate& predicted, const State& pointing,
                std::span<const Plot> plots, const Eigen::VectorXd& class_belief = {});

  std::size_t size() const { return in_gate_.size(); }           ///< plots in the gate
  std::size_t plot(std::size_t i) const { return in_gate_[i]; }  ///< its place in the look
  double none() const { return none_; }                          ///< sum_j w_0j
  double sum(std::size_t i) const { return sums_[i]; }           ///< sum_j w_ij
  std::span<const PredictedMeasurement> predicted() const { return measurements_; }
  std::span<const Vector2> innovations(std::size_t i) const {
    return std::span(innovations_).subspan(i * modes_, modes_);
  }

  /// sum_j w_0j + sum_i e_i sum_j w_ij: the likelihood ratio of a target that is there to none, e_i = `factor`.
  double likelihood_ratio(std::span<const double> factor) const;

  /// Updates the predicted estimate by all events, plot i weighted by e_i besides (1 for a track alone; what other
  /// tracks leave of it: tracker/joint_association.hpp).
  ///
  ///   mu_j    proportional to w_0j + sum_i e_i w_ij
  ///   beta_ij = e_i w_ij / (w_0j + sum_i e_i w_ij)                        beta_0j likewise
  ///   x_j     = x_j + K_j nu_j,  nu_j = sum_i beta_ij nu_ij
  ///   P_j     = beta_0j P_j + (1 - beta_0j) P_j^c + K_j (sum_i beta_ij nu_ij nu_ij' - nu_j nu_j') K_j'
  ///
  /// P^c the covariance after a certain plot, in Joseph's form. The mean and covariance of the mixture of all events,
  /// exactly, mode by mode.
  void update(std::span<const double> factor, ImmEstimate& estimate) const;

  /// Updates the predicted estimate by one event alone: plot i is the target's, or none is.
  ///
  ///   mu_j    proportional to w_ij, or w_0j
  ///   x_j, P_j   after a certain plot i, or as they are
  ///
  /// Requires sum(i) > 0, or none() > 0.
  void condition(std::optional<std::size_t> i, ImmEstimate& estimate) const;

 private:
  void update_mode(std::size_t mode, double total, std::span<const double> factor, Gaussian& belief) const;

  std::size_t modes_ = 0;
  std::vector<PredictedMeasurement> measurements_;
  std::vector<std::size_t> in_gate_;
  std::vector<Vector2> innovations_;  // [plot][mode]
  std::vector<double> weights_;       // w_ij, [plot][mode]
  std::vector<double> none_of_mode_;  // w_0j
  std::vector<double> detected_;      // c_j D_j
  std::vector<double> sums_;
  double none_ = 1.0;
};

}  // namespace dwell
