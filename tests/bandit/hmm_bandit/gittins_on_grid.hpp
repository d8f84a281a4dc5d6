#pragma once

#include "bandit/hmm_bandit/arm.hpp"

namespace dwell::hmm_bandit {

/// The Gittins index from above, by a method apart from gittins_index.
///
/// The belief on a regular grid of the simplex (`divisions` an edge), successors interpolated linearly in Freudenthal's
/// triangulation, which overestimates a convex V; the finite chain's index is exact, by the largest remaining index
/// with elimination of states. Points: (divisions + n - 1) choose (n - 1), and the belief itself.
///
/// Cost     O(points^3).
///
/// Source   Varaiya, Walrand, Buyukkoc (1985); Sonin (2008); Lovejoy (1991) for the bound.
double gittins_index_on_grid(const Arm& arm, const Eigen::VectorXd& belief, double discount, int divisions);

}  // namespace dwell::hmm_bandit
