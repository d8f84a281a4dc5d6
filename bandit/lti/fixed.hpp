#pragma once

#include "bandit/lti/solution.hpp"

namespace dwell::lti {

struct FixedSettings {
  int sensor = 1;  ///< 1 .. m
};

/// One sensor in every step. When its looks are used up: idle where that is allowed, else the first sensor that has
/// looks left.
Solution fixed(const Problem& problem, const FixedSettings& settings);

}  // namespace dwell::lti
