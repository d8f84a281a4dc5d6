#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "radar/plot.hpp"
#include "radar/sensor.hpp"

namespace dwell {

/// What targets may be, their type or their intent, and how important it makes them. n classes, or none.
struct TargetClasses {
  static constexpr int kMost = 16;

  std::vector<std::string> names;
  Eigen::VectorXd prior;       ///< n, sums to one
  Eigen::VectorXd weight;      ///< n, above 0: of a target of the class, times the target's own
  Eigen::MatrixXd transition;  ///< n x n, rows sum to one: at each look at a target, just before it is seen

  int size() const { return static_cast<int>(prior.size()); }
  /// Whether a look may change what a target is.
  bool move() const { return !transition.isIdentity(0.0); }
};

/// A declaration that is impossible by the sensor's emission still is no proof: the plot may be false, or another
/// target's. It has at least this probability, as in kLeastClutter of tracker/association_events.hpp.
inline constexpr double kLeastEmission = 1e-6;

/// The class belief pi of one track, pi_k = P(class k | all looks): a hidden Markov chain that moves when it is looked
/// at. B = emission of the sensor, d the class that a plot declares. All of these do nothing, and give 1, where nothing
/// is believed (pi empty) or declared.

/// pi_l = sum_k pi_k transition(k, l).
void move_class(const TargetClasses& classes, Eigen::VectorXd& belief);

/// P(d | the plot is the target's) / P(d | it is false) = n sum_k pi_k B(k, d).
double declaration_ratio(const Sensor& sensor, const Plot& plot, const Eigen::VectorXd& belief);

/// mixture_k += weight pi_k B(k, d) / sum_l pi_l B(l, d): Bayes, given that the plot is the target's.
void add_class_posterior(const Sensor& sensor, const Plot& plot, double weight, const Eigen::VectorXd& belief,
                         Eigen::VectorXd& mixture);

}  // namespace dwell
