#pragma once

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

struct ThresholdSettings {
  double f = 1.0;  ///< >= 1
};

/// Thresholding: of every level the nodes stay whose objective so far is at most f times the least.
/// With f = 1 that is the one-step rule and its ties.
/// Source  Chung et al. (2004), III-C; Gupta et al. (2004), algorithm 2.
Solution threshold(const Problem& problem, const ThresholdSettings& settings);

}  // namespace dwell::lti
