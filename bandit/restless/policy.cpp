#include "bandit/restless/policy.hpp"

#include <algorithm>
#include <functional>
#include <limits>

#include "bandit/restless/index_table.hpp"
#include "bandit/restless/joint_search.hpp"

namespace dwell::restless {
namespace {

bool taken(const std::vector<Look>& looks, std::size_t arm) {
  return std::any_of(looks.begin(), looks.end(), [&](const Look& look) { return look.arm == arm; });
}

/// The best pair by an index of the arm alone, then the best of another arm.
class IndexRule final : public Policy {
 public:
  using Index = std::function<double(std::size_t arm, std::size_t sensor, const Matrix& predicted)>;
  IndexRule(const Problem& problem, Index index) : problem_(problem), index_(std::move(index)) {}

  void choose(const std::vector<Matrix>& predicted, double capacity, std::vector<Look>& looks) override {
    looks.clear();
    values_.resize(predicted.size());
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      values_[i].clear();
      for (std::size_t s = 0; s < problem_.arms[i].sensors.size(); ++s) {
        values_[i].push_back(index_(i, s, predicted[i]));
      }
    }
    for (int made = 0; made < problem_.looks_per_scan; ++made) {
      double best = -std::numeric_limits<double>::infinity();
      Look choice;
      for (std::size_t i = 0; i < values_.size(); ++i) {
        if (taken(looks, i)) continue;
        for (std::size_t s = 0; s < values_[i].size(); ++s) {
          if (values_[i][s] <= best) continue;
          best = values_[i][s];
          choice = {i, s};
        }
      }
      if (problem_.arms[choice.arm].dwell > capacity) return;
      capacity -= problem_.arms[choice.arm].dwell;
      looks.push_back(choice);
    }
  }

 private:
  const Problem& problem_;
  Index index_;
  std::vector<std::vector<double>> values_;
};

/// The best by the search; the second given the first.
class SearchRule final : public Policy {
 public:
  SearchRule(const Problem& problem, std::vector<Closure> closures, double price, int depth)
      : problem_(problem), search_(problem, std::move(closures), price, depth) {}

  void choose(const std::vector<Matrix>& predicted, double capacity, std::vector<Look>& looks) override {
    looks.clear();
    for (int made = 0; made < problem_.looks_per_scan; ++made) {
      search_.gains(predicted, looks, gains_);
      double best = -std::numeric_limits<double>::infinity();
      Look choice;
      for (std::size_t i = 0; i < gains_.size(); ++i) {
        if (taken(looks, i)) continue;
        for (std::size_t s = 0; s < gains_[i].size(); ++s) {
          if (gains_[i][s] <= best) continue;
          best = gains_[i][s];
          choice = {i, s};
        }
      }
      if (problem_.arms[choice.arm].dwell > capacity) return;
      capacity -= problem_.arms[choice.arm].dwell;
      looks.push_back(choice);
    }
  }

 private:
  const Problem& problem_;
  JointSearch search_;
  std::vector<std::vector<double>> gains_;
};

/// Arms and sensors in turn.
class TurnRule final : public Policy {
 public:
  TurnRule(const Problem& problem, RoundRobinSettings::Order order, std::optional<std::size_t> sensor)
      : problem_(problem), order_(order), fixed_(sensor) {}

  void choose(const std::vector<Matrix>& predicted, double capacity, std::vector<Look>& looks) override {
    looks.clear();
    const std::size_t arms = predicted.size();
    for (int made = 0; made < problem_.looks_per_scan; ++made) {
      Look look = next(arms);
      if (taken(looks, look.arm) || problem_.arms[look.arm].dwell > capacity) return;
      capacity -= problem_.arms[look.arm].dwell;
      looks.push_back(look);
      advance(arms);
    }
  }

  void reset() override { arm_ = sensor_ = 0; }

 private:
  Look next(std::size_t arms) const {
    const std::size_t sensors = problem_.arms[arm_ % arms].sensors.size();
    const std::size_t sensor = fixed_ ? std::min(*fixed_, sensors - 1) : sensor_ % sensors;
    return {arm_ % arms, sensor};
  }
  void advance(std::size_t arms) {
    const std::size_t sensors = problem_.arms[arm_].sensors.size();
    using Order = RoundRobinSettings::Order;
    const Order order = fixed_ ? Order::kArmFastest : order_;
    if (order == Order::kSensorFastest) {
      if (++sensor_ < sensors) return;
      sensor_ = 0;
      arm_ = (arm_ + 1) % arms;
    } else {
      arm_ = (arm_ + 1) % arms;
      if (order == Order::kLocked || arm_ == 0) ++sensor_;
    }
  }

  const Problem& problem_;
  RoundRobinSettings::Order order_;
  std::optional<std::size_t> fixed_;
  std::size_t arm_ = 0;
  std::size_t sensor_ = 0;
};

struct Make {
  const Problem& problem;
  const Priced& priced;

  std::unique_ptr<Policy> index(IndexRule::Index function) const {
    return std::make_unique<IndexRule>(problem, std::move(function));
  }

  std::unique_ptr<Policy> operator()(const RoundRobinSettings& s) const {
    return std::make_unique<TurnRule>(problem, s.order, std::nullopt);
  }
  std::unique_ptr<Policy> operator()(const FixedSettings& s) const {
    return std::make_unique<TurnRule>(problem, RoundRobinSettings::Order::kArmFastest,
                                      static_cast<std::size_t>(s.sensor - 1));
  }
  /// The arm of largest cost without a look; of its sensors the one that leaves the least.
  std::unique_ptr<Policy> operator()(const LargestVarianceSettings&) const {
    return index([&p = problem](std::size_t i, std::size_t s, const Matrix& predicted) {
      const Arm& arm = p.arms[i];
      const double cost = scan_cost(arm, predicted);
      double best = 0.0;
      for (const Sensor& sensor : arm.sensors) best = std::max(best, cost - expected_scan_cost(arm, sensor, predicted));
      const double gain = cost - expected_scan_cost(arm, arm.sensors[s], predicted);
      return best > 0.0 ? cost * gain / best : cost;
    });
  }
  std::unique_ptr<Policy> operator()(const MyopicSettings& settings) const {
    auto arms = problem.arms;
    for (Arm& arm : arms) {
      if (settings.cost == MyopicSettings::Cost::kFull) arm.cost.setIdentity();
    }
    return index([arms = std::move(arms)](std::size_t i, std::size_t s, const Matrix& predicted) {
      const Arm& arm = arms[i];
      return (scan_cost(arm, predicted) - expected_scan_cost(arm, arm.sensors[s], predicted)) / arm.dwell;
    });
  }
  std::unique_ptr<Policy> operator()(const LookaheadSettings& settings) const {
    return std::make_unique<SearchRule>(problem, std::vector<Closure>(problem.arms.size()), 0.0, settings.depth);
  }
  std::unique_ptr<Policy> operator()(const OrbitSettings& settings) const {
    return index([&p = problem, settings](std::size_t i, std::size_t s, const Matrix& predicted) {
      return orbit_index(p.arms[i], s, predicted, settings);
    });
  }
  std::unique_ptr<Policy> operator()(const WhittleSettings&) const {
    std::vector<std::vector<IndexTable>> tables;
    for (const Arm& arm : problem.arms) {
      auto& of_arm = tables.emplace_back();
      for (std::size_t s = 0; s < arm.sensors.size(); ++s) of_arm.emplace_back(arm, s, problem.discount);
    }
    return index([tables = std::move(tables)](std::size_t i, std::size_t s, const Matrix& predicted) {
      return tables[i][s](predicted(0, 0));
    });
  }
  std::unique_ptr<Policy> operator()(const IndexSettings& settings) const {
    std::vector<Closure> closures;
    for (const ValueSet& value : priced.values) closures.push_back({&value});
    const bool every_scan_has_its_looks =
        std::all_of(problem.arms.begin(), problem.arms.end(), [](const Arm& arm) { return arm.dwell <= 1.0; });
    const int depth = every_scan_has_its_looks ? settings.depth : 1;
    return std::make_unique<SearchRule>(problem, std::move(closures), priced.price, depth);
  }
};

}  // namespace

std::unique_ptr<Policy> make_policy(const PolicySettings& settings, const Problem& problem, const Priced& priced) {
  return std::visit(Make{problem, priced}, settings);
}

bool has_scalar_arms(const Problem& problem) {
  return std::all_of(problem.arms.begin(), problem.arms.end(), [](const Arm& arm) { return arm.states() == 1; });
}

bool needs_prices(const PolicySettings& settings) { return std::holds_alternative<IndexSettings>(settings); }

}  // namespace dwell::restless
