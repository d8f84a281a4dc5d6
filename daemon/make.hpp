#pragma once

#include <memory>
#include <string>

#include "daemon/engine_config.hpp"
#include "radar/random.hpp"

namespace dwell {

/// The parts of a scenario from their configs.
std::unique_ptr<Sensor> make_sensor(const SensorConfig& config);

/// One life of a target, named for its random streams "target/<name>/...", from `start` on.
std::unique_ptr<Trajectory> make_trajectory(const TargetConfig& config, TimePoint start, Duration scan_period,
                                            const RandomStream& root, const std::string& name);

}  // namespace dwell
