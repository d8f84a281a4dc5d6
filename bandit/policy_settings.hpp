#pragma once

#include <variant>

// What may be set of each policy, apart from the policies: who knows the settings alone, as the config, is not built
// anew when a policy changes.
namespace dwell {

struct SaImmSettings {
  enum class Cost {
    kPosition,  ///< W selects x and y
    kXOnly,     ///< W selects x, as Table I of Evans et al.
    kFull,      ///< W = I, as (6) of Evans et al.: adds m^2 and (m/s)^2
    kNone,      ///< W = 0: the mode term alone
  };
  Cost cost = Cost::kPosition;
  double beta = 0.0;
  int nodes = 5;  ///< quadrature nodes on a ray: see ExpectedCost for the error
};

struct RoundRobinSettings {
  enum class Order {
    kRadarFastest,  ///< the sensor changes every scan, the track after all sensors: rr9 of PAPERS scenario 2
    kTrackFastest,  ///< the track changes every scan, the sensor after all tracks: rr9t
    kLocked,        ///< both change every scan: rrlock
  };
  Order order = Order::kRadarFastest;
};

struct FixedSettings {
  int sensor = 1;  ///< number of the sensor, from 1
};

struct LargestVarianceSettings {};

struct BhattacharyyaSettings {};

struct RandomSettings {
  enum class Probabilities {
    kOptimised,  ///< of a small bound of the expected cost
    kUniform,
  };
  Probabilities q = Probabilities::kOptimised;
  int horizon = 4;  ///< scans that the bound is summed over, the present one among them; 1 .. 8
};

struct WindowSettings {
  int d = 1;  ///< scans that are looked ahead, the present one among them; 1 .. 8
};

struct ThresholdSettings {
  double f = 1.0;   ///< >= 1
  int horizon = 4;  ///< scans that are looked ahead, the present one among them; 1 .. 8
};

struct RelaxedDpSettings {
  double alpha = 1.01;  ///< >= 1
  int horizon = 2;      ///< scans that are looked ahead, the present one among them; 1 .. 8
};

struct BeamSettings {
  int width = 10;   ///< >= 1
  int horizon = 4;  ///< scans that are looked ahead, the present one among them; 1 .. 8
};

struct OptimumSettings {
  int horizon = 3;  ///< scans that are looked ahead, the present one among them; 1 .. 8
};

struct LookAheadSettings {
  int depth = 2;  ///< scans that are looked ahead, the present one among them; 1 .. 3
};

struct OrbitSettings {
  double discount = 0.98;
  int steps = 150;  ///< scans of an orbit: what is left out weighs .98^150 = 5 %
};

struct IndexSettings {
  int depth = 2;  ///< 1: the advantage at the price; 2: two scans ahead, closed by the priced values
};

struct GittinsHmmSettings {
  double discount = 0.9;  ///< a look; (0, 1): what counts is what the next ten looks show
};

/// Every policy's settings; the default first.
using PolicySettings =
    std::variant<SaImmSettings, RoundRobinSettings, FixedSettings, LargestVarianceSettings, BhattacharyyaSettings,
                 RandomSettings, WindowSettings, ThresholdSettings, RelaxedDpSettings, BeamSettings, OptimumSettings,
                 LookAheadSettings, OrbitSettings, IndexSettings, GittinsHmmSettings>;

}  // namespace dwell
