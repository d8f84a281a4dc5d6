#include "bandit/restless/lagrangian.hpp"

#include <algorithm>
#include <cmath>

#include "bandit/restless/covariance.hpp"
#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

constexpr int kMostCuts = 60;
constexpr double kSolved = 1e-9;
/// Of the first price: beyond that no double is left.
constexpr int kMostDoublings = 900;

/// The least line of an arm at a price; of equal ones that with the least usage.
PricedValue least_line(const std::vector<PricedValue>& lines, double price) {
  return *std::min_element(lines.begin(), lines.end(), [&](const PricedValue& a, const PricedValue& b) {
    const double of_a = a.total(price);
    const double of_b = b.total(price);
    return of_a < of_b || (of_a == of_b && a.usage < b.usage);
  });
}

struct Model {
  std::vector<std::vector<PricedValue>> lines;
  double capacity;

  double usage(double price) const {
    double sum = 0.0;
    for (const auto& of_arm : lines) sum += least_line(of_arm, price).usage;
    return sum;
  }
  double value(double price) const {
    double sum = -price * capacity;
    for (const auto& of_arm : lines) sum += least_line(of_arm, price).total(price);
    return sum;
  }
  /// Where the model peaks: usage falls with the price.
  double peak(double high) const {
    double low = 0.0;
    if (usage(low) <= capacity) return low;
    for (int halving = 0; halving < 100; ++halving) {
      const double middle = 0.5 * (low + high);
      (usage(middle) > capacity ? low : high) = middle;
    }
    return high;
  }
};

}  // namespace

Relaxation maximise_over_price(std::size_t arms, double capacity, double first_price, const SolveArm& solve) {
  Model model{std::vector<std::vector<PricedValue>>(arms), capacity};
  const auto solve_all = [&](double price) {
    Relaxation at{-price * capacity, price, false, {}};
    for (std::size_t i = 0; i < arms; ++i) {
      at.arms.push_back(solve(i, price));
      model.lines[i].push_back(at.arms.back());
      at.value += at.arms.back().total(price);
    }
    return at;
  };
  const auto usage_of = [](const Relaxation& at) {
    double sum = 0.0;
    for (const PricedValue& arm : at.arms) sum += arm.usage;
    return sum;
  };
  DWELL_ASSERT(first_price > 0.0);
  double high = first_price;
  Relaxation best = solve_all(high);
  for (int doubling = 0; usage_of(best) > capacity && doubling < kMostDoublings; ++doubling) {
    best = solve_all(high *= 2.0);
  }
  if (usage_of(best) > capacity) return best;
  for (int cut = 0; cut < kMostCuts; ++cut) {
    const double price = model.peak(high);
    const double promised = model.value(price);
    const Relaxation at = solve_all(price);
    if (at.value > best.value || at.price == best.price) best = at;
    if (at.value >= promised - kSolved * std::abs(promised)) {
      best = at;
      best.solved = true;
      break;
    }
  }
  return best;
}

double relaxed_capacity(const Problem& problem) {
  const double looks = problem.looks_per_scan;
  return problem.discount ? looks / (1.0 - *problem.discount) : looks;
}

double price_scale(const Problem& problem) {
  double scale = 0.0;
  for (const Arm& arm : problem.arms) {
    const Matrix settled = all_looks(arm).covariance;
    for (const Matrix& p : {arm.p0, settled, predict(arm, settled)}) {
      for (const Sensor& sensor : arm.sensors) {
        scale = std::max(scale, (scan_cost(arm, p) - expected_scan_cost(arm, sensor, p)) / arm.dwell);
      }
    }
  }
  return scale > 0.0 ? scale : 1.0;
}

}  // namespace dwell::restless
