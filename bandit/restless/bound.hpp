#pragma once

#include "bandit/restless/lagrangian.hpp"
#include "bandit/restless/policy.hpp"

namespace dwell::restless {

/// How much a bound is worth.
enum class BoundKind {
  kExact,      ///< the Lagrangian bound itself: no policy is below it
  kCertified,  ///< from below the Lagrangian bound: no policy is below it
  kReference,  ///< the value of the best priced policies known: no bound, a little high
};

struct Bound {
  double value = 0.0;  ///< average cost a scan, or discounted
  BoundKind kind = BoundKind::kReference;
  double price = 0.0;  ///< of a unit of dwell
  /// The value of the best priced policies known, by PricedArm: the Lagrangian bound is between `value` and this, so a
  /// bound that is far below it is loose.
  double reference = 0.0;
};

/// What is found out about a problem before any policy is run.
struct Analysis {
  Bound bound;
  Priced priced;
  std::vector<double> priced_costs;  ///< of each arm at the price, looks paid: what PricedArm's policies cost
};

/// The bound and the priced values.
///
///   one state, P_d = 1     exact: mechanical words; discounted, threshold rules from p0 at the index's inverse
///   one state, P_d < 1     certified: ScalarMesh
///   more states            reference: PricedArm, an average of policies that can be carried out; see `certify`
///
/// Of a scalar arm with several sensors that always detect, only the one with the least noise matters.
Analysis analyse(const Problem& problem);

/// A certified bound at the price of the analysis in place of a reference, where every arm has two states (certify of
/// one arm, some seconds an arm); else the analysis's own.
Bound certify(const Problem& problem, const Analysis& analysis);

/// Advantage of a look at p0 at the price: idle cost less look cost.
double advantage(const Problem& problem, const Priced& priced, std::size_t arm, std::size_t sensor);

}  // namespace dwell::restless
