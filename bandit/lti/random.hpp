#pragma once

#include "bandit/lti/solution.hpp"
#include "radar/random.hpp"

namespace dwell::lti {

struct RandomSettings {
  enum class Probabilities {
    kOptimised,  ///< of the least bound of the expected steady trace, where there is one; else uniform
    kUniform,
  };
  Probabilities q = Probabilities::kOptimised;
};

/// Each step's sensor is drawn from fixed probabilities, one uniform number a step. Of a sensor without looks left the
/// probability goes to the others in proportion; where they have none, evenly; where no sensor is left, idle.
/// `bound` is that of AveragedRiccati for these probabilities, in the objective's unit: of m tr P, or of tr P where
/// that of the last step is the objective. It does not know budgets or the cost of looks. Source  Gupta et al. (2004),
/// algorithm 3.
Solution random_choice(const Problem& problem, const RandomSettings& settings, RandomStream stream);

}  // namespace dwell::lti
