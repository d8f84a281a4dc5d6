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
};

/// What is found out about a problem before any policy is run.
struct Analysis {
  Bound bound;
  Priced priced;
};

/// The bound and the priced values.
///
///   one state, P_d = 1     exact: mechanical words; discounted, threshold rules from p0 at the index's inverse
///   one state, P_d < 1     certified: ScalarMesh
///   more states            reference: PricedArm, an average of policies that can be carried out
///
/// Of a scalar arm with several sensors that always detect, only the one with the least noise matters.
Analysis analyse(const Problem& problem);

/// Advantage of a look at p0 at the price: idle cost less look cost.
double advantage(const Problem& problem, const Priced& priced, std::size_t arm, std::size_t sensor);

}  // namespace dwell::restless
