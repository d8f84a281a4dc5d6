#pragma once

#include <memory>

#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

std::unique_ptr<Policy> make_policy(const PolicySettings& settings);

}  // namespace dwell
