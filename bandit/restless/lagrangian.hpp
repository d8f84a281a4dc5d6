#pragma once

#include <functional>
#include <vector>

#include "bandit/restless/priced_arm.hpp"

namespace dwell::restless {

/// The Lagrangian relaxation: looks_per_scan on average in place of in every scan, at a price for a unit of dwell.
///
///   B = max_price  sum_i J_i(price) - price x capacity            J_i(price) = least cost_i + price usage_i
///
/// capacity = looks_per_scan, over (1 - b) with a discount. With J_i or anything below it, the value at any price is a
/// lower bound of every policy, adaptive ones too.
///
/// Maximised by cutting planes: each solution (cost_i, usage_i) of an arm is a line above J_i at all prices; the next
/// price is where the sum of the least lines peaks. Done when no arm's solution is below its lines by more than 1e-9 of
/// B. Where the price is 0 the capacity does not bind. The search starts from a price that is doubled until the usage
/// is below the capacity.
struct Relaxation {
  double value = 0.0;
  double price = 0.0;
  bool solved = false;            ///< else this price is not the best: the value is below B
  std::vector<PricedValue> arms;  ///< at that price
};

/// `solve(i, price)` is the best of arm i at that price.
using SolveArm = std::function<PricedValue(std::size_t arm, double price)>;
Relaxation maximise_over_price(std::size_t arms, double capacity, double first_price, const SolveArm& solve);

/// The capacity of the constraint that the relaxation replaces.
double relaxed_capacity(const Problem& problem);

/// A price of the right order: the largest one-step gain of a look, per dwell, at the start, where looks in every scan
/// settle, or a scan after that. Above 0.
double price_scale(const Problem& problem);

}  // namespace dwell::restless
