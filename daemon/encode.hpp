#pragma once

#include "daemon/engine.hpp"
#include "dwell/v1/control.pb.h"
#include "dwell/v1/stream.pb.h"

namespace dwell {

/// Sum over the living tracks of weight x position variance, m^2.
double weighted_cost(std::span<const Track> tracks);

/// Engine state into wire messages. Each clears its message first and keeps its memory.

void encode(const Track& track, v1::Track& message);
void encode(const ScanReport& report, std::span<const Track> tracks, v1::ScanReport& message);
/// Plot `plot` of look `look` of the report.
void encode(const ScanReport& report, const LookReport& look, std::size_t plot, const Sensor& sensor,
            v1::Plot& message);
/// False for a sensor that is not calibrated.
bool encode_calibration(const Engine& engine, std::size_t sensor, v1::RadarCalibration& message);
void encode_radar(const Engine& engine, std::size_t sensor, v1::RadarState& message);

}  // namespace dwell
