#pragma once

#include <vector>

#include "bandit/restless/value_set.hpp"

namespace dwell::restless {

/// Looks ahead over the looks at all arms for `depth` scans, closed by a value for each arm.
///
///   value(P_1.., d) = min over looks of the scan  E [ sum_i cost_i + price dwell + b value(next, d - 1) ]
///
/// with V_i at the end (the arms are then independent) or, without, nothing. Detections and misses are both followed. A
/// scan's looks (looks_per_scan, each at another arm) are committed one after another, each where it gains most; of the
/// last scan that is the exact optimum, as gains of different arms add up there.
///
/// Every scan of the search has looks_per_scan looks, whatever their dwell: what the bucket holds is not followed.
///
/// Cost     pairs^(depth - 1) x arms sums a look to be made, twice that exponent where looks miss, times looks_per_scan
///          squared; each covariance is worked out once. No pair is left out: a hundred arms take depth 2, ten depth 3.
struct Closure {
  const ValueSet* value = nullptr;  ///< of the arm; none: costs end with the last scan
};

class JointSearch {
 public:
  /// `closures` one an arm. `price` is charged for dwell in every scan of the search.
  JointSearch(const Problem& problem, std::vector<Closure> closures, double price, int depth);

  /// Gain of a first look: value without any look in this scan minus value with it, other first looks being
  /// `committed`. `predicted` one an arm. The gains are for every arm and sensor: gains[arm][sensor].
  void gains(const std::vector<Matrix>& predicted, const std::vector<Look>& committed,
             std::vector<std::vector<double>>& gains);

 private:
  /// A covariance that an arm may have, and what follows from it; shared by all joint states it is part of.
  struct Node {
    Matrix p;
    int arm = 0;
    double cost = 0.0;              // of the scan without a look
    std::vector<double> look_gain;  // last scan: idle minus look, over sensors
    double best_gain = 0.0;         // the largest of them
    double last = 0.0;              // last scan: idle cost with the closure
    bool has_last = false;
    int idle = -1;  // nodes after no look (or a miss) and after each sensor's detection
    std::vector<int> detected;
    std::vector<double> seen_cost;  // of the scan with a detection
  };
  using Joint = std::vector<int>;

  int add(int arm, const Matrix& p);
  void prepare_last(int node);
  int idle(int node);
  int detected(int node, std::size_t sensor);
  double value(const Joint& joint, int depth);
  double last_value(const Joint& joint);
  double value_with(const Joint& joint, const std::vector<Look>& looks, int depth);
  double expand(const Joint& joint, const std::vector<Look>& looks, std::size_t next, Joint& after, int depth);

  const Problem& problem_;
  std::vector<Closure> closures_;
  double price_;
  int depth_;
  double discount_;
  std::vector<Node> nodes_;
};

}  // namespace dwell::restless
