#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bandit/restless/orbit_index.hpp"
#include "bandit/restless/value_set.hpp"

namespace dwell::restless {

/// What the index policies need of the relaxation: the price of a unit of dwell and each arm's value at it.
struct Priced {
  double price = 0.0;
  std::vector<ValueSet> values;
};

struct RoundRobinSettings {
  enum class Order {
    kSensorFastest,  ///< the sensor changes every scan, the arm after all its sensors
    kArmFastest,     ///< the arm changes every scan, the sensor after all arms
    kLocked,         ///< both change every scan
  };
  Order order = Order::kSensorFastest;
};
struct FixedSettings {
  int sensor = 1;  ///< from 1; an arm that has fewer sensors takes its last
};
struct LargestVarianceSettings {};
struct MyopicSettings {
  enum class Cost {
    kOwn,   ///< the arm's own
    kFull,  ///< the trace of the whole covariance
  };
  Cost cost = Cost::kOwn;
};
struct LookaheadSettings {
  int depth = 2;
};
struct WhittleSettings {};
struct IndexSettings {
  /// Scans looked ahead over. 1 where a dwell is above 1: the search takes every scan to have its looks, and many then
  /// have none.
  int depth = 2;
};

using PolicySettings = std::variant<RoundRobinSettings, FixedSettings, LargestVarianceSettings, MyopicSettings,
                                    LookaheadSettings, OrbitSettings, WhittleSettings, IndexSettings>;

/// Chooses the looks of a scan: at most looks_per_scan, each at another arm.
class Policy {
 public:
  virtual ~Policy() = default;
  /// `predicted` one an arm; `capacity` is what the bucket holds. Looks are made as long as capacity lasts; where the
  /// best costs more than there is, the bucket is left to fill.
  virtual void choose(const std::vector<Matrix>& predicted, double capacity, std::vector<Look>& looks) = 0;
  /// Forgets what it chose before.
  virtual void reset() {}
};

/// `problem` and `priced` outlive the policy. `whittle` requires arms of one state.
std::unique_ptr<Policy> make_policy(const PolicySettings& settings, const Problem& problem, const Priced& priced);

/// Whether `whittle` can run on the problem.
bool has_scalar_arms(const Problem& problem);
/// Whether the policy needs Priced.
bool needs_prices(const PolicySettings& settings);

}  // namespace dwell::restless
