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
///   backup   for each y the vector that is largest on the unnormalised belief B_y A' pi;
///            g = reward + b sum_y (B_y A')' g_y,  k = b sum_y (B_y A')' k_y
///   K        after each sweep exactly from the vector at pi0: K = g'pi0 / (1 - k'pi0)
///
/// Converged where a sweep changes no value at the points by 1e-14 of the largest, or none by 1e-12 and K has not grown
/// for 100 sweeps, or K has not grown while b^sweeps fell to 1e-12: until then a far reward behind a loss may not have
/// been felt. Not converged where that takes more than 2e10 / points^2 or 1e6 sweeps.
///
/// What results is the value of a rule that can be carried out: gamma from below, and exact once the set no longer
/// changes and the points are all that matter.
struct GittinsResult {
  double index = 0.0;
  bool converged = false;  ///< else the index may be higher
  int sweeps = 0;
  int points = 0;
  int vectors = 0;
};
GittinsResult gittins_index(const Arm& arm, const Eigen::VectorXd& belief, double discount, int most_points = 1500);

}  // namespace dwell::hmm_bandit
