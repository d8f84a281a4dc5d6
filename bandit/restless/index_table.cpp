#include "bandit/restless/index_table.hpp"

#include <algorithm>
#include <cmath>

#include "bandit/restless/scalar_arm.hpp"
#include "bandit/restless/scalar_mesh.hpp"
#include "bandit/restless/whittle.hpp"

namespace dwell::restless {
namespace {

constexpr int kExactPoints = 2000;
constexpr int kMeshPoints = 1000;
constexpr int kPrices = 60;
constexpr int kMeshPointsOfOneValue = 4000;

Arm with_one_sensor(const Arm& arm, std::size_t sensor) {
  Arm one = arm;
  one.sensors = {arm.sensors[sensor]};
  return one;
}

bool nothing_to_gain(const ScalarArm& arm) { return arm.blind() || arm.weight == 0.0; }

/// No index is above this: what idling for ever from p costs over one look, over a horizon of 1000 scans.
double highest_price(const ScalarArm& scalar, double p, double discount) {
  double cost = 0.0;
  double power = 1.0;
  for (int t = 0; t < 1000 && power > 1e-6; ++t, power *= discount, p = scalar.predict(p)) cost += power * p;
  return scalar.weight * cost / scalar.dwell;
}

}  // namespace

double whittle_of(const Arm& arm, std::size_t sensor, std::optional<double> discount, double p) {
  const ScalarArm scalar = *scalar_arm(arm, arm.sensors[sensor]);
  if (nothing_to_gain(scalar)) return 0.0;
  if (scalar.p_detect == 1.0) return whittle_index(scalar, p, discount);
  ScalarMesh mesh(with_one_sensor(arm, sensor), discount.value_or(1.0), p, kMeshPointsOfOneValue);
  return calibrated_index(mesh, 0, p, highest_price(scalar, p, discount.value_or(1.0)));
}

IndexTable::IndexTable(const Arm& arm, std::size_t sensor, std::optional<double> discount) {
  const ScalarArm scalar = *scalar_arm(arm, arm.sensors[sensor]);
  if (nothing_to_gain(scalar)) return;
  const double low = std::max(arm.p0(0, 0) > 0.0 ? std::min(scalar.q, arm.p0(0, 0)) : scalar.q, 1e-9 * arm.p0(0, 0));
  double high = arm.p0(0, 0);
  for (int t = 0; t < 200 && high < 1000.0 * std::max(arm.p0(0, 0), low); ++t)
    high = std::max(high, scalar.predict(high));
  high = std::max(high, 10.0 * low);
  if (scalar.p_detect == 1.0) {
    for (int i = 0; i < kExactPoints; ++i) {
      log_p_.push_back(std::log(low) + (std::log(high) - std::log(low)) * i / (kExactPoints - 1));
      index_.push_back(whittle_index(scalar, std::exp(log_p_.back()), discount));
    }
    return;
  }
  ScalarMesh mesh(with_one_sensor(arm, sensor), discount.value_or(1.0), high, kMeshPoints);
  // The one-step gain p^2 / (p + r) is below the index: from there on prices have thresholds in the range.
  const double first = scalar.p_detect * scalar.weight / scalar.dwell * low * low / (low + scalar.r);
  const double last = highest_price(scalar, high, discount.value_or(1.0));
  for (int i = 0; i < kPrices; ++i) {
    const double price = first * std::pow(last / first, static_cast<double>(i) / (kPrices - 1));
    mesh.solve(price);
    if (mesh.look_gain(0, high) < 0.0) break;
    double below = low;
    double above = high;
    for (int halving = 0; halving < 50; ++halving) {
      const double p = std::sqrt(below * above);
      (mesh.look_gain(0, p) < 0.0 ? below : above) = p;
    }
    if (!log_p_.empty() && std::log(above) <= log_p_.back()) continue;
    log_p_.push_back(std::log(above));
    index_.push_back(price);
  }
}

double IndexTable::operator()(double p) const {
  if (index_.size() < 2 || p == 0.0) return 0.0;
  const double x = std::log(p);
  const auto above = std::upper_bound(log_p_.begin(), log_p_.end(), x);
  auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, above - log_p_.begin()));
  i = std::min(i, log_p_.size() - 1);
  const double share = (x - log_p_[i - 1]) / (log_p_[i] - log_p_[i - 1]);
  return index_[i - 1] + share * (index_[i] - index_[i - 1]);
}

}  // namespace dwell::restless
