#pragma once

#include <vector>

#include "bandit/restless/priced_arm.hpp"

namespace dwell::restless {

/// One arm of one state at a price, by dynamic programming on a grid: any sensors, any P_d.
///
/// Variances spread evenly in log p; V between two of them is taken linear in p, beyond the last constant. V is concave
/// and nondecreasing, so both are from below: what is solved here is a **lower bound** of the true value. Value
/// iteration from V = 0; with an average cost the least of T V - V over the grid, which is a bound at every step, from
/// lazy steps (mix .5). Ends where a step changes V by 1e-12 of itself, or the spread of T V - V is 1e-10 of it.
/// Discounted values are those of one step from p0, which may be below the process noise: the grid is not.
///
/// Interpolation costs about (log spacing)^2 / 8 of the curvature: 1e-6 with 2000 points over four decades.
class ScalarMesh {
 public:
  /// From the process noise up to `high`, or farther, to where misses in a row have a probability below 1e-12.
  /// Requires a one-state arm, q > 0; `discount` 1: average cost.
  ScalarMesh(const Arm& arm, double discount, double high, int points);

  /// Starts from the V of the last price.
  PricedValue solve(double price);

  /// Idle cost less the cost of a look, at predicted variance p, at the last price.
  double look_gain(std::size_t sensor, double p) const;
  double price() const { return price_; }

 private:
  struct Place {
    int below = 0;
    double above_share = 0.0;
  };
  Place place(double p) const;
  double at(const std::vector<double>& v, const Place& place) const;
  PricedValue value_at_start() const;
  double look_cost(std::size_t sensor, double p, double idle) const;

  Arm arm_;
  double discount_;
  double price_ = 0.0;
  double low_log_, step_log_;
  std::vector<double> p_;
  std::vector<Place> idle_;
  std::vector<std::vector<Place>> seen_;        // [sensor][point]
  std::vector<std::vector<double>> seen_cost_;  // of the scan
  std::vector<double> v_, work_;
};

/// Whittle's index of a scalar arm with P_d < 1: the price at which the mesh's look is worth its cost.
///
/// Relative accuracy 1e-5 (the mesh's). Requires an index below `high_price`, else that.
double calibrated_index(ScalarMesh& mesh, std::size_t sensor, double p, double high_price);

}  // namespace dwell::restless
