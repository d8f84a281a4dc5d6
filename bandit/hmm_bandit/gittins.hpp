#pragma once

#include "bandit/hmm_bandit/arm.hpp"

namespace dwell::hmm_bandit {

/// The Gittins index of an arm at a belief: the reward a play that makes stopping and playing on worth the same.
///
///   gamma(pi) = max_{tau >= 1}  E sum_{t < tau} b^t reward'pi_t  /  E sum_{t < tau} b^t
///
/// By the retirement form  V_K(pi) = max{ K, reward'pi + b sum_y s V_K(pi+_y) },  gamma(pi0) = (1 - b) K with K the
/// value of playing at pi0. V_K is piecewise linear and convex: a set of vectors g + K k, backed up at points.
///
///   points   beliefs that plays may reach from pi0, the likeliest first (b^t P), merged at 1e-7
///   backup   for each y the vector that is largest on the unnormalised belief B_y A' pi;  g = reward + b sum_y (B_y
///   A')' g_y K        after each sweep exactly from the vector at pi0: K = g'pi0 / (1 - k'pi0)
///
/// Ends when a sweep changes no value at the points by 1e-14 of the largest, or K has not grown for 100. What results
/// is the value of a rule that can be carried out: gamma from below, and exact once the set no longer changes.
struct GittinsResult {
  double index = 0.0;
  int sweeps = 0;
  int points = 0;
  int vectors = 0;
};
GittinsResult gittins_index(const Arm& arm, const Eigen::VectorXd& belief, double discount, int most_points = 1500);

/// The same from above, by another method: the belief on a regular grid of the simplex (`divisions` an edge),
/// successors interpolated linearly in Freudenthal's triangulation, which overestimates a convex V; the finite chain's
/// index is exact, by the largest remaining index with elimination of states, O(points^3). Points: (divisions + n - 1)
/// choose (n - 1), and the belief itself. Use: the check of the first. Source   Varaiya, Walrand, Buyukkoc (1985);
/// Sonin (2008); Lovejoy (1991) for the bound.
double gittins_index_on_grid(const Arm& arm, const Eigen::VectorXd& belief, double discount, int divisions);

}  // namespace dwell::hmm_bandit
