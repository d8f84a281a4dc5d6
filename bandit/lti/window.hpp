#pragma once

#include "bandit/lti/solution.hpp"

namespace dwell::lti {

struct WindowSettings {
  int d = 1;  ///< steps that are looked ahead, >= 1
};

/// Sliding window: in every step k the best schedule of the next min(d, N - k) steps, of which the first choice is
/// taken. The window's objective is the problem's, counted from here: the sum over the window and the cost of its
/// looks, or the trace at its end. With d >= N it is the optimum. A longer window is not always better.
///
/// d = 1 is the one-step rule, argmin_u m tr P[k+1](u) + cost(u). It spends a budget at once where nothing spreads it,
/// and never pays for a look that is worth its cost only later.
///
/// Source  Chung et al. (2004), III-B; Gupta et al. (2004), algorithm 1; Evans et al. (2005), IV-A, "Linear Quadratic
///         Sensor Selection".
Solution window(const Problem& problem, const WindowSettings& settings);

}  // namespace dwell::lti
