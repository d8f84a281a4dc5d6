#pragma once

#include "bandit/lti/solution.hpp"

namespace dwell::lti {

struct RelaxedDpSettings {
  double alpha = 1.01;  ///< >= 1
};

inline constexpr std::size_t kMaximumSet = 1000;  // whose children are compared in seconds

/// Relaxed dynamic programming on the final trace: within alpha^2 of the least tr P[N], whatever the problem's
/// objective. (It is the final trace that the guarantee is for.)
///
/// A set of covariances pi goes forward. Of every pi and sensor i a candidate: `up` and `lo`, the Riccati step of pi
/// with W and R_i multiplied by alpha and by 1 / alpha. In the order of tr up, a candidate is dropped if its up is
/// covered by the lo's kept so far (LoewnerCover, tolerance 1e-9 tr up), else its lo is kept. The answer is the kept
/// schedule with the least true tr P[N].
///
/// The guarantee: by induction, for every schedule s of k steps some mixture of kept pi is at most alpha P_s(k), and
/// every kept pi of schedule s is at least P_s(k) / alpha; so the least kept tr pi is at most alpha times the optimum,
/// and its true trace at most alpha times that. A candidate is covered only by what has used no more looks of any
/// limited sensor, so that whatever may follow the one may follow the other.
///
/// Where more than kMaximumSet covariances are kept in a step (many states and sensors, alpha near one) the exact
/// search for the final trace takes over, which is well within alpha^2; `set_sizes` then ends with that step.
///
/// Errors   std::length_error where that search too keeps too many schedules: take a larger alpha.
/// Source  Alriksson, Rantzer (2005), procedures 1 and 2, in the reading that keeps the guarantee: the overbars of the
///         text are lost; see README.md.
Solution relaxed_dp(const Problem& problem, const RelaxedDpSettings& settings);

}  // namespace dwell::lti
