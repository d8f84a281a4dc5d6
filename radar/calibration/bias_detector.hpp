#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "radar/calibration/expected_plot.hpp"
#include "radar/calibration/window.hpp"
#include "radar/sensor.hpp"

namespace dwell {

/// One look as BiasDetector needs it.
struct BiasLook {
  std::uint64_t scan;
  std::uint32_t track;
  std::size_t radar;
  MeasurementJacobian h;
  Eigen::Matrix<double, kStateSize, 2> gain;  ///< sum_j mu_j K_j of the update; zero where the plot was not used
  Vector2 sigma;                              ///< of the radar's noise: m, rad
};

/// Watches for a step of one radar's bias in the plots of all.
///
/// A radar that goes wrong takes its tracks with it: its own innovations shrink as the tracks follow, those of the
/// others grow, and if it is the best one it is the others that seem wrong. The course of all innovations tells. A bias
/// b of radar r from some scan on moves a track's mean by m and the innovations by d,
///
///   d = [look of r] b - H m,     m <- F m from look to look,    m <- m + K d at each
///
/// K the gains as they were. For each radar and b = +-2 and +-5 sigma of its noise in one component that is a
/// cumulative sum of log likelihood ratios
///
///   g <- g + min(PlotDensity::log_shift_ratio(d), kMostOfAPlot),   g < 0: from here on anew, g = 0 and m = 0
///
/// flagged when some g > kFlag + log 2 R: of two steps, and every radar's plots add to it, not its own alone. K is that
/// of the modes' average, F that of the first mode.
/// Shapes   R radars, 8 R sums; a shift for each and each track. Allocates where a track is new.
/// Source   Willsky, Jones (1976), IEEE Trans. AC 21, 108, for the signatures; Page (1954), Biometrika 41, 100.
class BiasDetector {
 public:
  BiasDetector(std::size_t radars, std::size_t tracks);

  /// A look with a plot. `evidence`: empty of a look that says nothing of biases, but moves the track. The radar found
  /// wrong; all is then begun anew.
  std::optional<std::size_t> add(const MotionPrior& motion, const BiasLook& look, const PlotDensity* evidence);
  void restart(std::uint64_t scan);

 private:
  struct Hypothesis {
    std::size_t radar;
    Vector2 direction;  // in sigmas
    double sum = 0.0;
    std::uint64_t since = 0;  // shifts of tracks that were last looked at before are zero
  };
  struct TrackShifts {
    std::uint32_t track;
    std::uint64_t scan;    // of the last look
    std::vector<State> m;  // of each hypothesis
  };

  TrackShifts& shifts_of(const BiasLook& look, std::size_t longest_gap);

  std::vector<Hypothesis> hypotheses_;
  std::vector<TrackShifts> tracks_;
  double flag_;
};

}  // namespace dwell
