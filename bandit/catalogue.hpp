#pragma once

#include <memory>
#include <variant>

#include "bandit/bhattacharyya.hpp"
#include "bandit/fixed.hpp"
#include "bandit/largest_variance.hpp"
#include "bandit/policy.hpp"
#include "bandit/round_robin.hpp"
#include "bandit/sa_imm.hpp"

namespace dwell {

/// Every policy's settings; the default first.
using PolicySettings =
    std::variant<SaImmSettings, RoundRobinSettings, FixedSettings, LargestVarianceSettings, BhattacharyyaSettings>;

std::unique_ptr<Policy> make_policy(const PolicySettings& settings);

}  // namespace dwell
