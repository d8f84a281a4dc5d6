#pragma once

#include <functional>
#include <optional>

#include "bandit/restless/lagrangian.hpp"
#include "bandit/restless/policy.hpp"
#include "bandit/restless/whittle.hpp"

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
  std::optional<double> reference;
};

/// What is found out about a problem before any policy is run.
struct Analysis {
  Bound bound;
  Priced priced;                     ///< without values where they were not asked for
  std::vector<double> priced_costs;  ///< of each arm at the price, looks paid: what PricedArm's policies cost
};

struct AnalysisSettings {
  /// Whether Priced, and with it the bound's reference, is wanted: PricedArm takes much longer than a scalar arm's
  /// bound. Arms of more states always have it.
  bool values = true;
  std::function<bool()> stop = {};  ///< asked between solutions of an arm; true: analyse throws Stopped
};
struct Stopped {};

/// The bound and the priced values.
///
///   one state, P_d = 1     exact: mechanical words; discounted, threshold rules from p0 at the index's inverse, a
///                          reference where check_indexability finds no such index, or waits are best beyond 2048 scans
///   one state, P_d < 1     certified: ScalarMesh
///   more states            reference: PricedArm, an average of policies that can be carried out; see `certify`
///
/// Certified in place of exact where the best price was not found. The relaxation knows the capacity on average alone:
/// looks whose dwell does not divide the capacity of a scan (.6 of 1, say) leave a part of it unused in practice, and
/// no policy comes near the bound, which is exact for the relaxation.
///
/// Of a scalar arm with several sensors that always detect, only the one with the least noise matters.
Analysis analyse(const Problem& problem, const AnalysisSettings& settings = {});

/// check_indexability of each sensor that sees the state of a scalar arm and always detects, merged, from the process
/// noise to ten times what is large for the arm: p0, q or r. Empty: the arm is not of that kind.
std::optional<IndexabilityReport> check_indexability(const Arm& arm, std::optional<double> discount);

/// A certified bound at the price of the analysis in place of a reference, where every arm has two states (certify of
/// one arm, some seconds an arm); else the analysis's own. `stop` as in AnalysisSettings, between the arms.
Bound certify(const Problem& problem, const Analysis& analysis, const std::function<bool()>& stop = {});

/// Advantage of a look at p0 at the price: idle cost less look cost.
double advantage(const Problem& problem, const Priced& priced, std::size_t arm, std::size_t sensor);

}  // namespace dwell::restless
