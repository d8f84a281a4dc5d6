#pragma once

#include <vector>

#include "bandit/restless/covariance.hpp"
#include "bandit/restless/packed.hpp"

namespace dwell::restless {

/// The priced value of one arm as the least of many plans, each linear in P ("alpha-matrices").
///
///   V(P) = min_k <L_k, P> + c_k
///
/// A plan is a fixed sequence of looks with fixed gains, which costs a linear function of P (Joseph's form): V is
/// concave and, as each L_k is positive semidefinite, monotone in P. Every plan can be carried out: V is from above.
class ValueSet {
 public:
  ValueSet() = default;
  /// Plans as columns: `weights` m x K in weight form, `constants` K.
  ValueSet(Eigen::MatrixXd weights, Eigen::VectorXd constants);

  Eigen::Index plans() const { return constants_.size(); }
  double value(const Matrix& p) const { return value(pack_state(p)); }
  double value(const Packed& p) const;
  /// The plan that attains it.
  Eigen::Index best_plan(const Packed& p) const;

  const Eigen::MatrixXd& weights() const { return weights_; }
  const Eigen::VectorXd& constants() const { return constants_; }

 private:
  Eigen::MatrixXd weights_;  // m x K
  Eigen::VectorXd constants_;
  std::vector<double> blocks_;  // of 16 plans: their constants, then component by component of their weights
};

/// What one scan and the value afterwards cost at predicted covariance P, discount b:
///
///   idle    w <C, P> + b V(F P F' + Q)
///   look    P_d (w <C, M> + b V(F M F' + Q)) + (1 - P_d) idle + price dwell
double idle_cost(const Arm& arm, const ValueSet& value, double discount, const Matrix& predicted);
double look_cost(const Arm& arm, std::size_t sensor, const ValueSet& value, double discount, double price,
                 const Matrix& predicted, double idle);

}  // namespace dwell::restless
