#pragma once

#include <memory>
#include <string>
#include <vector>

#include "radar/sensor.hpp"
#include "tracker/measurement.hpp"

namespace dwell::testing {

/// What a policy may meet when it scores one look: a predicted estimate and the sensor that would look at it.
struct PredictedState {
  std::string origin;
  ImmEstimate estimate;
  std::shared_ptr<const Sensor> sensor;
  UpdateForm update = UpdateForm::kEkf;
};

/// The three radars of scenario 1 of Evans et al. (2005), V: (120, 120), (100, 50), (150, 100) km; beamwidths
/// 1, .2 and 1 deg; 50 dB at 100 km; 50 ns.
std::vector<std::shared_ptr<const Sensor>> evans_radars();

/// The two sensors of Liu, Hwang (2011): C1 = [1 0 0 .1; 0 1 .1 0], C2 = [.1 0 0 1; 0 .1 1 0], R = I.
std::vector<std::shared_ptr<const Sensor>> liu_hwang_sensors();

/// Predicted estimates of closed loops, each with every sensor of its scene; `runs` of each of the five:
/// - scenario 1 of Evans, banks as_printed and evans_practical, both update forms, sa_imm choosing: per run
///   the scans 26 .. 31, in and after the manoeuvre, and three at random;
/// - Liu and Hwang's two sensors and bank, truth from the bank's own chain: per run six of 110 scans at random.
std::vector<PredictedState> closed_loop_states(int runs, std::uint64_t seed);

/// Estimates drawn over wide ranges ("log": uniform in the logarithm):
/// - 2 or 3 modes in random order; probabilities log 1e-4 .. 1, then normalised;
/// - sensor: Liu and Hwang's two; x and y with sigmas 1 and log 1 .. 30 in any orientation; a radar of
///   .2 .. 2 deg at 5 .. 200 km, in both update forms; P_d 1 in a quarter of the draws, else .3 .. 1;
/// - each mode's position covariance has an orientation of its own and an aspect of log 1 .. 10; the first
///   mode's sigma is log .1 .. 10 of the sensor's, the others' such that |S| is log 1 .. 1e4 of the first's;
/// - velocity sigma = position sigma / (log 1 .. 10 s), correlation 0 .. .95;
/// - each mode's z lies on the first's in a quarter of the draws, else 0 .. 10 sigma off in a random direction,
///   half the time the first mode's sigma, half the time its own; velocities differ by up to twice the sigma.
std::vector<PredictedState> random_states(int count, std::uint64_t seed);

}  // namespace dwell::testing
