#include "bandit/restless/bound.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "bandit/restless/concave_mesh.hpp"
#include "bandit/restless/mechanical_word.hpp"
#include "bandit/restless/scalar_mesh.hpp"
#include "bandit/restless/whittle.hpp"

namespace dwell::restless {
namespace {

constexpr int kMeshPoints = 2000;
/// Idle scans to which the mesh reaches, apart from misses.
constexpr int kMeshIdle = 300;
/// Variances at which an index is checked, and how far beyond what is large for the arm.
constexpr int kCheckedStates = 30;
constexpr double kFar = 10.0;
/// In all, so that a discount near 1 takes no longer than some tenths of a second an arm.
constexpr double kCheckedScans = 2e7;
/// A certificate that close to the best policy known is not made better, relative.
constexpr double kTight = 5e-5;

bool always_detects(const Arm& arm) {
  return std::all_of(arm.sensors.begin(), arm.sensors.end(), [](const Sensor& s) { return s.p_detect == 1.0; });
}

ScalarArm sharpest(const Arm& arm) {
  ScalarArm best = *scalar_arm(arm, arm.sensors.front());
  for (const Sensor& sensor : arm.sensors) {
    const ScalarArm other = *scalar_arm(arm, sensor);
    if (other.r < best.r) best = other;
  }
  return best;
}

/// Looks from p0 wherever the index is above the price: optimal at the price, with the threshold by bisection.
PricedValue discounted_threshold_value(const ScalarArm& arm, double p0, double discount, double price) {
  const int scans = 1 + static_cast<int>(std::ceil(std::log(1e-17) / std::log(discount)));
  double low = 1e-12 * std::max(p0, arm.q);
  double high = std::max({p0, arm.q, arm.r});
  for (int doubling = 0; doubling < 200 && whittle_index(arm, high, discount) < price; ++doubling) high *= 2.0;
  for (int halving = 0; halving < 100 && high - low > 1e-15 * high; ++halving) {
    const double middle = 0.5 * (low + high);
    (whittle_index(arm, middle, discount) < price ? low : high) = middle;
  }
  PricedValue value;
  double power = 1.0;
  double p = p0;
  for (int t = 0; t < scans; ++t, power *= discount) {
    const bool look = !arm.blind() && p >= high;
    const double after = look ? arm.after_look(p) : p;
    value.cost += power * arm.weight * after;
    if (look) value.usage += power * arm.dwell;
    p = arm.predict(after);
  }
  return value;
}

double mesh_top(const Arm& arm) {
  double p = arm.p0(0, 0);
  const double f2 = arm.f(0, 0) * arm.f(0, 0);
  const double far = 1e6 * std::max(p, arm.q(0, 0));
  for (int t = 0; t < kMeshIdle && p < far; ++t) p = std::max(p, f2 * p + arm.q(0, 0));
  return p;
}

}  // namespace

std::optional<IndexabilityReport> check_indexability(const Arm& arm, std::optional<double> discount) {
  if (arm.states() != 1 || !(arm.q(0, 0) > 0.0)) return std::nullopt;
  std::optional<IndexabilityReport> merged;
  for (const Sensor& sensor : arm.sensors) {
    const ScalarArm scalar = *scalar_arm(arm, sensor);
    if (scalar.blind() || scalar.p_detect < 1.0) continue;
    const double scans = discount ? std::log(1e-17) / std::log(*discount) : 0.0;
    const int states = std::clamp(static_cast<int>(kCheckedScans / std::max(1.0, scans)), 5, kCheckedStates);
    const double high = kFar * std::max({arm.p0(0, 0), scalar.q, scalar.r});
    const IndexabilityReport one = check_indexability(scalar, scalar.q, high, states, discount);
    if (!merged) merged.emplace();
    merged->indexable = merged->indexable && one.indexable;
    merged->monotone = merged->monotone && one.monotone;
    merged->offenders.insert(merged->offenders.end(), one.offenders.begin(), one.offenders.end());
  }
  return merged;
}

Analysis analyse(const Problem& problem, const AnalysisSettings& settings) {
  const std::size_t count = problem.arms.size();
  const double discount = problem.discount_or_one();
  const bool scalar = has_scalar_arms(problem);
  const bool exact = scalar && std::all_of(problem.arms.begin(), problem.arms.end(), always_detects);
  const bool values = settings.values || !scalar;
  std::vector<PricedArm> sets;
  for (const Arm& arm : problem.arms) {
    if (values) sets.emplace_back(arm, discount);
  }
  std::vector<std::unique_ptr<ScalarMesh>> meshes(count);
  for (std::size_t i = 0; i < count && scalar && !exact; ++i) {
    const Arm& arm = problem.arms[i];
    meshes[i] = std::make_unique<ScalarMesh>(arm, discount, mesh_top(arm), kMeshPoints);
  }
  const auto solve = [&](std::size_t i, double price) -> PricedValue {
    if (settings.stop && settings.stop()) throw Stopped{};
    const Arm& arm = problem.arms[i];
    if (!scalar) return sets[i].solve(price);
    if (!exact) return meshes[i]->solve(price);
    const ScalarArm best = sharpest(arm);
    if (problem.discount) return discounted_threshold_value(best, arm.p0(0, 0), discount, price);
    const RatedCost rated = best_rate(best, price);
    return {rated.cost, rated.rate * arm.dwell};
  };
  const Relaxation relaxation = maximise_over_price(count, relaxed_capacity(problem), price_scale(problem), solve);
  Analysis analysis;
  const auto thresholds_are_best = [&](const Arm& arm) {
    const auto report = check_indexability(arm, problem.discount);
    return !report || (report->indexable && report->monotone);
  };
  BoundKind kind = BoundKind::kReference;
  if (scalar) kind = exact && relaxation.solved ? BoundKind::kExact : BoundKind::kCertified;
  const auto word_is_found = [&](const Arm& arm) { return best_rate(sharpest(arm), relaxation.price).found; };
  if (exact && !problem.discount && !std::all_of(problem.arms.begin(), problem.arms.end(), word_is_found)) {
    kind = BoundKind::kReference;
  }
  if (exact && problem.discount && !std::all_of(problem.arms.begin(), problem.arms.end(), thresholds_are_best)) {
    kind = BoundKind::kReference;
  }
  analysis.bound = {relaxation.value, kind, relaxation.price, std::nullopt};
  analysis.priced.price = relaxation.price;
  if (!values) return analysis;
  double reference = -relaxation.price * relaxed_capacity(problem);
  for (PricedArm& set : sets) {
    if (settings.stop && settings.stop()) throw Stopped{};
    analysis.priced_costs.push_back(set.solve(relaxation.price).total(relaxation.price));
    reference += analysis.priced_costs.back();
    analysis.priced.values.push_back(set.value());
  }
  analysis.bound.reference = reference;
  return analysis;
}

Bound certify(const Problem& problem, const Analysis& analysis, const std::function<bool()>& stop) {
  const auto two_states = [](const Arm& arm) { return arm.states() == 2; };
  if (!std::all_of(problem.arms.begin(), problem.arms.end(), two_states)) return analysis.bound;
  const double price = analysis.priced.price;
  double value = -price * relaxed_capacity(problem);
  for (std::size_t i = 0; i < problem.arms.size(); ++i) {
    if (stop && stop()) throw Stopped{};
    CertificateSettings settings;
    settings.enough = analysis.priced_costs[i] * (1.0 - kTight);
    value += certify(problem.arms[i], problem.discount_or_one(), price, analysis.priced.values[i], settings).value;
  }
  return {value, BoundKind::kCertified, price, analysis.bound.reference};
}

double advantage(const Problem& problem, const Priced& priced, std::size_t arm, std::size_t sensor) {
  const Arm& of = problem.arms[arm];
  const double discount = problem.discount_or_one();
  const double idle = idle_cost(of, priced.values[arm], discount, of.p0);
  return idle - look_cost(of, sensor, priced.values[arm], discount, priced.price, of.p0, idle);
}

}  // namespace dwell::restless
