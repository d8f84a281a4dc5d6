#pragma once

#include "bandit/restless/covariance.hpp"

namespace dwell::restless {

struct OrbitSettings {
  double discount = 0.98;
  int steps = 150;
};

/// An index for any number of states and sensors that needs no table.
///
///   index(P, s) = [F(idle first) - F(look with s first)] / max(.05, W(look first) - W(idle first)) / dwell
///
/// F is the discounted cost and W the discounted number of looks along one orbit each, in which after the first scan
/// the arm is looked at with its best sensor (the one that leaves the least cost) whenever its cost without a look is
/// at least that of P. P_d < 1: the expected covariance P_d M + (1 - P_d) P takes the place of M. For scalar arms with
/// P_d = 1 and enough steps it is Whittle's discounted index.
///
/// Where the floor .05 is what is divided by, both orbits look about as often and the number means nothing: neither as
/// a price nor for ranking, but that it is the larger the more the look saves.
///
/// Cost     2 x steps x sensors covariance updates.
///
/// Source   the first-passage form of Nino-Mora's marginal productivity index; a level in place of the scalar state.
double orbit_index(const Arm& arm, std::size_t sensor, const Matrix& predicted, const OrbitSettings& settings = {});

}  // namespace dwell::restless
