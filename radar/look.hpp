#pragma once

#include <span>
#include <vector>

#include "radar/plot.hpp"
#include "radar/random.hpp"
#include "radar/sensor.hpp"

namespace dwell {

/// A target where it truly is.
struct TargetTruth {
  TargetId id;
  State state;
  std::optional<int> target_class = std::nullopt;  ///< from 0; empty: of none, and its plots declare none
};

/// Executes one look: every detection in the footprint, targets in order and then false alarms.
///
/// A target is seen when it is covered, its true measurement lies in the footprint h(pointing) +- half extent,
/// and a draw succeeds with P_d; its plot is h(x) + N(0, R(x)). False alarms are Poisson with the sensor's density,
/// uniform over the footprint, ranges limited to [0, largest range].
/// Where the sensor declares classes a target's plot has one by its emission, a false plot any, all as likely.
/// The draws depend on (sensor's stream, time, target) alone, so two policies that give the same look at the same
/// time get the same plots whatever they did before.
///
/// `stream` is the sensor's own; `plots` is cleared first, and keeps its capacity.
void simulate_look(const Sensor& sensor, const Dwell& dwell, std::span<const TargetTruth> targets,
                   const RandomStream& stream, std::vector<Plot>& plots);

/// Executes one surveillance look: every detection in the coverage, targets in order and then false alarms, drawn as
/// `simulate_look` draws them. Requires a sensor whose coverage has an end.
void simulate_survey(const Sensor& sensor, const Dwell& dwell, std::span<const TargetTruth> targets,
                     const RandomStream& stream, std::vector<Plot>& plots);

}  // namespace dwell
