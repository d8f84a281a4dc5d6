#pragma once

#include <vector>

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

/// A lower bound on what the rest of any schedule adds to a sum objective: the best that sensors could do if they
/// shared each step.
///
/// With share q_kj of step k sensor j looks with noise R_j / q_kj, which adds q_kj C_j' R_j^-1 C_j to the information;
/// shares of a step sum to one. A schedule is a corner of this set. The cost f(q) of the shares is convex: tr P[k] is
/// the trace of a block of (Omega + sum_l sum_j q_lj M_lj)^-1, Omega the information matrix of the whole trajectory
/// without looks (a limit, where W or P[0] is singular), M_lj what sensor j tells of step l, l up to the last look
/// before P[k]; matrix inversion is convex in the Loewner order, and limits of convex functions are convex. So from
/// any shares q, and for any prices lambda_j >= 0 on the budget of b_j looks that are left,
///
///   cost of a schedule >= f(q) - g.q + sum_k min_j (g_kj + lambda_j) - sum_j lambda_j b_j,   g = the gradient of f at
///   q.
///
/// The shares are made good at one node, by descent, and serve all; the prices are made good at each node.
///
/// Cost     of a bound: O(steps n^3 + steps^2 m), no allocation but in the prices.
/// Source   the convex relaxation of Joshi, Boyd (2009), IEEE Trans. Signal Processing 57, 451-462, over time.
class TimeSharing {
 public:
  /// Shares for `steps` steps from a node. Requires a sum objective; the tree outlives this.
  TimeSharing(SearchTree& tree, const Node& node, int steps);

  /// Bound on what the last `steps` steps add to the cost of a node.
  double bound(const Node& node, int steps);

 private:
  int choices() const { return static_cast<int>(use_cost_.size()); }
  std::vector<double> looks_left(const Node& node) const;
  void aim(const Node& node, int steps);
  void share(const Eigen::MatrixXd& shares);
  double cost(const double* covariance, int steps, Eigen::MatrixXd& gradient);
  double cost_of_block(int block, const double* covariance, int steps, Eigen::MatrixXd& gradient);

  SearchTree& tree_;
  int first_choice_;              // 0 where idle is allowed, else 1: row c is choice first_choice_ + c
  std::vector<double> use_cost_;  // of a choice
  Eigen::MatrixXd shares_;        // choices x steps
  std::vector<Matrix> roots_;     // what is told in step k to a block: k * blocks + block
  std::vector<Sensitivity> sensitivity_;
  Eigen::MatrixXd gradient_;
};

/// The largest sum_k min_c (cost(c, k) + lambda_c) - sum_c lambda_c left[c] that a few rounds over one lambda_c >= 0
/// after the other find: a lower bound on the cheapest way to take one row in each column, row c at most left[c] times.
double assignment_bound(const Eigen::MatrixXd& cost, const std::vector<double>& left);

}  // namespace dwell::lti
