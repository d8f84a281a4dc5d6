#pragma once

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

using BeamPruning = search::BeamPruning<double>;

struct BeamSettings {
  int width = 10;  ///< >= 1
};

/// Beam search on the objective, and the one-step rule beside it: a beam alone may lose the path of the one-step rule,
/// so the better of the two is returned.
Solution beam(const Problem& problem, const BeamSettings& settings);

}  // namespace dwell::lti
