#pragma once

#include <string>

#include "daemon/engine.hpp"

namespace dwell::bench {

/// `radars` radars on a circle of 60 km and `targets` cruising targets, followed with the default bank. Nothing
/// manoeuvres, so that no track is lost while the clock runs, however many share the one look.
inline EngineConfig scene(int radars, int targets) {
  EngineConfig config;
  for (int i = 0; i < radars; ++i) {
    RadarFigures figures;
    const double angle = 2.0 * std::numbers::pi * i / radars;
    figures.position_m = 60e3 * Vector2(std::sin(angle), std::cos(angle));
    figures.range_noise_floor_m = 15.0 * (i + 1);
    figures.azimuth_noise_floor_rad = 0.05 * (i + 1) * kDegree;
    figures.detection = FixedDetection{0.9};
    SensorConfig sensor;
    sensor.name = "radar" + std::to_string(i + 1);
    sensor.figures = figures;
    config.sensors.push_back(sensor);
  }
  RandomStream place(7);
  for (int i = 0; i < targets; ++i) {
    ScriptedMotion motion;
    motion.initial = {place.uniform(-3e4, 3e4), place.uniform(-50, 50), place.uniform(-3e4, 3e4),
                      place.uniform(-50, 50)};
    TargetConfig target;
    target.name = "target" + std::to_string(i + 1);
    target.motion = motion;
    target.track_start = CuedStart{State(1e4, 1e2, 1e4, 1e2).asDiagonal()};
    config.targets.push_back(target);
  }
  return config;
}

}  // namespace dwell::bench
