#include "bandit/restless/whittle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bandit/restless/smooth_step.hpp"
#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

constexpr int kFirstHorizon = 4000;
constexpr int kDoublings = 6;
constexpr double kSettled = 1e-9;
/// Stands in for the average where a period is longer than any horizon.
constexpr double kNearlyAverage = 1.0 - 1e-5;
/// W(1) - W(0) is 1 / period at least where the orbits are out of phase; below this they are taken to be in phase.
constexpr double kInPhase = 1e-6;

struct Differences {
  double cost = 0.0;  // F(0) - F(1), without the weight
  double work = 0.0;  // W(1) - W(0), without the dwell
};

/// 1 below 1/4, 0 from 1 on.
double cutoff(double u) { return smooth_step((1.0 - u) / 0.75); }

/// The two orbits side by side; weight(t) multiplies scan t.
template <class Weight>
Differences differences(const ScalarArm& arm, double p, int scans, Weight weight) {
  Differences sum;
  double idle_first = p;
  double look_first = p;
  bool idle_looks = false;
  bool look_looks = true;
  for (int t = 0; t < scans; ++t) {
    const double m0 = idle_looks ? arm.after_look(idle_first) : idle_first;
    const double m1 = look_looks ? arm.after_look(look_first) : look_first;
    const double w = weight(t);
    sum.cost += w * (m0 - m1);
    sum.work += w * (static_cast<double>(look_looks) - static_cast<double>(idle_looks));
    idle_first = arm.predict(m0);
    look_first = arm.predict(m1);
    idle_looks = idle_first >= p;
    look_looks = look_first >= p;
  }
  return sum;
}

Differences discounted(const ScalarArm& arm, double p, double discount) {
  const int scans = 1 + static_cast<int>(std::ceil(std::log(1e-17) / std::log(discount)));
  double power = 1.0 / discount;
  return differences(arm, p, scans, [&](int) { return power *= discount; });
}

Differences averaged(const ScalarArm& arm, double p, int horizon) {
  return differences(arm, p, horizon, [&](int t) { return cutoff(static_cast<double>(t) / horizon); });
}

/// Index of unit weight and dwell; empty at an exceptional state.
std::optional<double> ratio(const Differences& d) {
  if (d.work < kInPhase) return std::nullopt;
  return d.cost / d.work;
}

std::optional<double> unit_index(const ScalarArm& arm, double p, std::optional<double> discount) {
  // With a discount the difference in work is at least 1 - b: it never vanishes.
  if (discount) {
    const Differences d = discounted(arm, p, *discount);
    return d.cost / d.work;
  }
  std::optional<double> index = ratio(averaged(arm, p, kFirstHorizon));
  int horizon = kFirstHorizon;
  for (int doubling = 0; doubling < kDoublings; ++doubling) {
    horizon *= 2;
    const std::optional<double> next = ratio(averaged(arm, p, horizon));
    const bool settled = index && next && std::abs(*next - *index) <= kSettled * std::abs(*next);
    index = next;
    if (settled) break;
  }
  return index;
}

}  // namespace

double whittle_index(const ScalarArm& arm, double p, std::optional<double> discount) {
  DWELL_ASSERT(p > 0.0 && arm.p_detect == 1.0);
  if (arm.blind()) return 0.0;
  std::optional<double> index = unit_index(arm, p, discount);
  for (double step = 1e-7; !index && step < 1e-3; step *= 2.0) {
    const auto below = unit_index(arm, p * (1.0 - step), discount);
    const auto above = unit_index(arm, p * (1.0 + step), discount);
    if (below && above) index = 0.5 * (*below + *above);
  }
  if (!index) {
    const Differences d = discounted(arm, p, kNearlyAverage);
    index = d.cost / d.work;
  }
  return arm.weight / arm.dwell * *index;
}

IndexabilityReport check_indexability(const ScalarArm& arm, double low, double high, int states,
                                      std::optional<double> discount) {
  IndexabilityReport report;
  const double tolerance = discount ? 1e-9 : 1e-6;
  double last = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < states; ++i) {
    const double p = low * std::pow(high / low, static_cast<double>(i) / std::max(1, states - 1));
    const Differences d = discount ? discounted(arm, p, *discount) : averaged(arm, p, kFirstHorizon);
    const double index = whittle_index(arm, p, discount);
    const bool positive = discount ? d.work > 0.0 : d.work > -kInPhase;
    const bool rising = index >= last - tolerance * std::abs(last);
    report.indexable = report.indexable && positive;
    report.monotone = report.monotone && rising;
    if (!positive || !rising) report.offenders.push_back(p);
    last = std::max(last, index);
  }
  return report;
}

}  // namespace dwell::restless
