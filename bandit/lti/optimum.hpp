#pragma once

#include <span>
#include <vector>

#include "bandit/lti/search_tree.hpp"

namespace dwell::lti {

/// The best schedule of the problem's objective over the next `steps` steps from a root of the tree.
///
/// Trees of at most kSmallTree leaves are enumerated; of schedules that tie (kTie) the first is returned. Larger ones:
///
/// *Sum.* Level by level. A node is dropped
/// - where its cost and a lower bound of the rest exceed what a schedule at hand costs. Two bounds: TimeSharing, and by
///   the monotone Riccati map: from the same covariance, the covariance under any schedule is never below the one
///   under the looks of all sensors in every step. By induction: a step is monotone in P, and monotone (decreasing) in
///   the information of the look, of which all sensors together give the most; a limit on looks, an idle step or noise
///   in the communication (each block with its own) takes information away. Each step costs no less than the
///   cheapest use besides;
/// - where another node of its level has taken no more looks of any limited sensor, has cost no more, and is nowhere
///   above it in the Loewner order: whatever follows, it stays so. Of two that tie the first in order stays.
/// The schedule at hand is the best of the same search with kGuideWidth nodes a level, those of the least bounds.
///
/// *Final trace.* What counts is the end: the search goes from the last step backwards, over suffixes. A suffix of s
/// looks costs no less than from the covariance under all sensors for N - s steps (as above, and since suffixes are
/// monotone too), and no more than from where a schedule at hand is after N - s steps. Both meet as s grows, as far as
/// the filter forgets. A suffix that cannot win more than kTie is dropped.
///
/// Errors   std::length_error where even so too many schedules remain.
/// Cost     exponential in `steps` at the worst.
std::vector<int> best_schedule(SearchTree& tree, const Level& root, int steps);

inline constexpr double kSmallTree = 1000.0;
inline constexpr std::size_t kGuideWidth = 32;

/// The best schedule of the problem.
/// Source  Chung et al. (2004), III-A; Evans et al. (2005), III-B.
Solution optimum(const Problem& problem);

}  // namespace dwell::lti
