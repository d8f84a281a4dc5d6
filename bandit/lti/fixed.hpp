#pragma once

#include "bandit/lti/solution.hpp"

namespace dwell::lti {

struct FixedSettings {
  int sensor = 1;  ///< 1 .. m
};

/// One sensor in every step. Where it has no look left: idle if that is allowed, else the first sensor that has one.
Solution fixed(const Problem& problem, const FixedSettings& settings);

/// The sensors in turn, from the first; one without a look left is passed over, and where none has any: idle.
Solution round_robin(const Problem& problem);

}  // namespace dwell::lti
