#pragma once

#include <array>
#include <optional>

#include "daemon/calibration_loop.hpp"
#include "tests/scale.hpp"
#include "tests/scenarios/monte_carlo.hpp"

namespace dwell::testing {

/// A run with its calibration, that waits for its solves; calls `after` after every scan.
template <class After>
void run_calibrated(const EngineConfig& config, std::uint64_t scans, After&& after) {
  Engine engine(config);
  CalibrationLoop loop(engine);
  while (engine.last().scan < scans) {
    (void)loop.before_scan();
    engine.scan();
    loop.after_scan();
    after(engine);
  }
}

/// Of the tracks' positions, by the number of the track; empty of one that is lost.
inline std::array<std::optional<double>, 3> squared_errors(const Engine& engine) {
  std::array<std::optional<double>, 3> errors{};
  std::size_t place = 0;
  for (const TruthReport& truth : engine.last().truth) {
    while (engine.tracks()[place].id != truth.track) ++place;
    errors.at(truth.track.number - 1) =
        (position(truth.state) - position(engine.tracks()[place].combined.mean)).squaredNorm();
  }
  return errors;
}

}  // namespace dwell::testing
