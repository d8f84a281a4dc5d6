#pragma once

#include <memory>
#include <variant>

#include "bandit/beam.hpp"
#include "bandit/bhattacharyya.hpp"
#include "bandit/fixed.hpp"
#include "bandit/index.hpp"
#include "bandit/largest_variance.hpp"
#include "bandit/look_ahead.hpp"
#include "bandit/optimum.hpp"
#include "bandit/orbit.hpp"
#include "bandit/policy.hpp"
#include "bandit/random_choice.hpp"
#include "bandit/relaxed_dp.hpp"
#include "bandit/round_robin.hpp"
#include "bandit/sa_imm.hpp"
#include "bandit/threshold.hpp"
#include "bandit/window.hpp"

namespace dwell {

/// Every policy's settings; the default first.
using PolicySettings =
    std::variant<SaImmSettings, RoundRobinSettings, FixedSettings, LargestVarianceSettings, BhattacharyyaSettings,
                 RandomSettings, WindowSettings, ThresholdSettings, RelaxedDpSettings, BeamSettings, OptimumSettings,
                 LookAheadSettings, OrbitSettings, IndexSettings>;

std::unique_ptr<Policy> make_policy(const PolicySettings& settings);

}  // namespace dwell
