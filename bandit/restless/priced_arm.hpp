#pragma once

#include <vector>

#include "bandit/restless/plan_points.hpp"
#include "bandit/restless/value_set.hpp"

namespace dwell::restless {

/// The best that one arm can do when every look costs price x dwell.
struct PricedValue {
  double cost = 0.0;   ///< average a scan, or discounted from p0; without what the looks cost
  double usage = 0.0;  ///< dwell: average a scan, or discounted from p0

  double total(double price) const { return cost + price * usage; }
};

struct PricedArmSettings {
  int maximum_points = 2000;  ///< where a policy asks for more, twice as much is one point
  int improvements = 60;      ///< of the policy; a dozen is usual
  /// Covariances this close, relative to their standard deviations, are one point. Plans are tangents of V: what is
  /// lost is of second order. Where misses branch, the coarser one keeps the points few.
  double same_point = 1e-3;
  double same_point_with_misses = 2e-3;
  double same_point_of_many_states = 2e-2;  ///< at least that of arms with more than two states
};

/// Solves one arm at a price by point-based policy iteration over alpha-matrices.
///
/// A node is a covariance P_k, an action (idle, or a sensor with the gain K that is right at P_k) and the nodes where a
/// detection and a miss lead. Its plan costs <L_k, P> + c_k from any P:
///
///   look branch   L1 = A' E1 A,  c1 = <K R K', E1> + b (<L_j1, Q> + c_j1),   E1 = w C + b F' L_j1 F,  A = I - K H
///   idle branch   L0 = w C + b F' L_j0 F,                 c0 = b (<L_j0, Q> + c_j0)
///   node          L = P_d L1 + (1 - P_d) L0,   c likewise + price dwell
///
/// Idle nodes last for n scans, n a power of two: 1 unless P_n would be the same point as P_k, or one beside it. An
/// idle node that led to itself would never end.
///
/// 1. Follow: from the start and from the seeds, take the action that is best before the present V, and go where it
///    leads, until all lead to nodes that are there. The points are closed under the greedy policy, as they must be:
///    a fixed cloud gives a wrong gain.
/// 2. Evaluate: solve the equations above for all nodes. L is the limit of a contraction. c: discounted the same;
///    average (b = 1), every walk ends in a cycle that has a mean, and where misses branch, by lazy sweeps
///    (mix .5: a periodic optimum makes plain ones oscillate). Parts that stay worse than others are dropped.
/// 3. V is the least of the plans. Again until no action changes.
/// 4. Then the plans made along the policy's cycle may all be above V by one and the same amount: another plan saves
///    that once, on the way to the cycle, and as nothing is lost by beginning it a turn later the greedy actions put it
///    off for ever. Where it is so, the actions are once those of the plans that attain V, which do begin it, and 1. to
///    3. go on from there. With a discount a delay costs something, but little.
///
/// The result is the cost of a policy that can be carried out, so an upper bound of the optimum at the price. Where no
/// plan of an improved policy has a finite cost, the last policy stays.
/// Average cost: V is relative, 0 on average over nothing in particular; the mean is in the PricedValue.
/// One arm's points serve all prices, and the last V starts the next price.
/// Source   Sondik (1978), Hansen (1998), Pineau et al. (2003) for beliefs; covariances, P_d and several sensors: ours.
class PricedArm {
 public:
  /// `discount` 1 means average cost. Throws std::domain_error where looks with every sensor in turn have no finite
  /// cost, which `validate_costs` refuses.
  PricedArm(const Arm& arm, double discount, const PricedArmSettings& settings = {});

  /// A predicted covariance from which the value is to be good as well: plans are followed from there too.
  void add_seed(const Matrix& predicted) { seeds_.push_back(find_or_add(pack_state(predicted))); }

  PricedValue solve(double price);

  /// Of the last price.
  const ValueSet& value() const { return value_; }
  const Arm& arm() const { return arm_; }

 private:
  struct Node {
    bool active = false;  // has an action: all have, but while they are followed
    int sensor = -1;      // -1 idle, for the point's pause
    int detected = 0;
    int missed = 0;
  };

  /// Which action a node has: the best before V, or that of the plan that attains V there.
  enum class Rule { kGreedy, kPlanned };

  double p_detect(const Node& node) const;
  const PlanPoints::LookMap& look_of(std::size_t k) const;
  double scans(std::size_t k) const;
  double next_discount(std::size_t k) const;
  int find_or_add(const Packed& p);
  int node_at(const Packed& p);
  void restart(double same_point);
  void seed();
  double action_cost(const PlanPoints::Point& point, int sensor, double idle, double price) const;
  bool choose(std::size_t k, double price, Rule rule);
  std::size_t follow(double price, Rule rule);
  void keep_only(const std::vector<char>& reached);
  bool evaluate(double price);
  Packed backed_up_weight(std::size_t k) const;
  bool solve_weights();
  void immediate();
  bool deterministic() const;
  void solve_constants_by_cycles(double price);
  void solve_constants_by_sweeps(double price);
  void publish(double price);
  bool postpones(double price) const;
  double gain_of_all_looks() const;
  PricedValue improve(double price);

  Arm arm_;
  double discount_;
  PricedArmSettings settings_;
  PlanPoints points_;
  double finest_;    // same_point where the points are not too many
  int most_sweeps_;  // of the weights
  std::vector<int> seeds_;
  bool too_many_ = false;                // points were asked for
  bool full_ = false;                    // so it was in the last improvement
  std::vector<Node> nodes_;              // one a point
  Eigen::MatrixXd weights_;              // m x points
  Eigen::VectorXd cost_, work_;          // c = cost + price work
  Eigen::VectorXd cost_now_, work_now_;  // without the successors' constants
  std::vector<char> kept_;               // active, and of a part of the graph with the least mean
  double price_ = 0.0;                   // of the last solution
  PricedValue mean_;
  Eigen::VectorXd published_cost_, published_work_;
  std::vector<int> published_sensor_;  // with which each plan begins; -1 idle
  ValueSet value_;
};

}  // namespace dwell::restless
