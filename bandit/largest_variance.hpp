#pragma once

#include "bandit/expected_cost.hpp"
#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// The track of largest predicted position variance (times its weight), by the sensor that is expected to reduce it
/// most.
///
///   score = weight tr(P_xy) x (reduction by this sensor / reduction by the track's best sensor)
class LargestVariance final : public Policy {
 public:
  explicit LargestVariance(const LargestVarianceSettings& settings);

  std::string_view name() const override { return "largest_variance"; }

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;

  ExpectedCost expected_variance_;
};

}  // namespace dwell
