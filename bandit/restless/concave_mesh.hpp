#pragma once

#include <limits>
#include <vector>

#include "bandit/restless/value_set.hpp"

namespace dwell::restless {

/// Proof that one arm at a price costs at least so much, whatever is done with it.
///
/// The priced value V is concave and nondecreasing in P (ValueSet), so
///
///   P' - sum_k w_k P_k positive semidefinite, w >= 0, sum_k w_k = 1   =>   V(P') >= sum_k w_k V(P_k).
///
/// With one such w for what each action makes of each point, the points are a finite problem whose value is below V. Of
/// any numbers v at the points, T one step of that problem, d = min_k (T v - v)_k:
///
///   average cost     the least average cost a scan is at least d
///   discounted       V(P_k) >= v_k + d / (1 - b)
///
/// Every part can be checked by itself, without knowing how it was found.
struct Certificate {
  struct Share {
    int point;
    double weight;
  };
  using Mixture = std::vector<Share>;  // sum of weight x point, at or below a covariance

  double price = 0.0;
  std::vector<Matrix> points;               ///< predicted covariances; the first is p0
  std::vector<double> values;               ///< v
  std::vector<std::vector<Mixture>> below;  ///< [point][outcome]: 0 no look or a miss, 1 + s a detection by sensor s
  double value = 0.0;                       ///< what is proved: average cost a scan, or discounted from p0, looks paid
};

struct CertificateSettings {
  int points = 2000;    ///< at most
  int rounds = 60;      ///< of: v for the mixtures, points where the problem then lives, mixtures for the present v
  int directions = 96;  ///< rank-one matrices that span what is left of P' above the mixture
  double enough = std::numeric_limits<double>::infinity();  ///< a value that need not be made better
};

/// The mixtures are linear programs that maximise sum_k w_k v_k. The points start with zero, which is below everything,
/// and the orbits of periodic looks. Then, round by round, the finite problem is solved, the mixtures are made anew
/// that its best policy uses, and where one serves it worst, a walk from the true successor adds points. What a program
/// leaves below zero by its tolerance, 1e-9, is made good with a little of point zero: what is left above is positive
/// semidefinite to rounding.
///
/// `discount` 1: average cost. `guess` is any estimate of V, a PricedArm's for a good one.
/// Requires an arm of two states (more need more directions than are practical) that `validate_costs` passes.
/// Accuracy  0 to 0.3 % below the best policy known on position-velocity arms, 1.1 % on a heavy slow one; a point more
///           costs a millisecond or two.
/// Source    own; lower bounds from grids of beliefs by concavity: Lovejoy (1991), Operations Research 39.
Certificate certify(const Arm& arm, double discount, double price, const ValueSet& guess,
                    const CertificateSettings& settings = {});

}  // namespace dwell::restless
