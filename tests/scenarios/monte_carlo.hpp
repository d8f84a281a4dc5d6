#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "daemon/config/config_reader.hpp"
#include "daemon/engine.hpp"

namespace dwell::testing {

/// A scenario of daemon/scenarios under one policy (as `dwellctl policy set` takes it).
inline EngineConfig scenario(const std::string& name, const PolicySettings& policy) {
  EngineConfig config =
      read_config_file(std::string(DWELL_SOURCE_DIR) + "/daemon/scenarios/" + name + ".textproto").engine;
  config.policy = policy;
  return config;
}

/// Mean over runs and its standard error.
struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0;
};

inline Estimate estimate(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / count;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean) / (count - 1.0);
  return {mean, std::sqrt(variance / count)};
}

}  // namespace dwell::testing
