#include "bandit/track_path.hpp"

#include <gtest/gtest.h>

#include "radar/range_bearing_radar.hpp"
#include "tests/bandit/scene.hpp"

namespace dwell::testing {
namespace {

// 50 km north of a radar whose footprint is 1000 m to either side. One mode in ten is 3 km east of the others, outside
// the footprint of a look between them; of the position variance, .9 (s + 300^2) + .1 (s + 2700^2) with s = 2 x 30^2,
// a look takes away no more than the first part. The moment-matched belief, 900 m wide, has .73 inside.
TEST(TrackPath, ALookIsOfUseInTheModesThatItsFootprintHolds) {
  RadarFigures figures;
  figures.dwell_azimuth_rad = 0.02;
  Scene scene;
  scene.add_sensor(std::make_shared<RangeBearingRadar>(figures));
  ImmEstimate estimate = make_estimate({}, Eigen::Vector2d(0.9, 0.1));
  estimate.modes[0] = {make_state({0.0, 50e3}, {0.0, 0.0}), State(900.0, 1.0, 900.0, 1.0).asDiagonal()};
  estimate.modes[1] = {make_state({3000.0, 50e3}, {0.0, 0.0}), State(900.0, 1.0, 900.0, 1.0).asDiagonal()};
  scene.add_track(1, estimate);
  TrackPath path;
  const Situation situation = scene.situation();
  path.lay(situation, 0, 1);
  StateMatrix seen;
  const double inside = 0.9 * (1800.0 + 300.0 * 300.0);
  const double outside = 0.1 * (1800.0 + 2700.0 * 2700.0);
  // The edges of the footprint are over 20 standard deviations from either mode.
  EXPECT_NEAR(path.look(0, 0, scene.tracks[0].combined.covariance, seen), inside / (inside + outside), 1e-12);
}

}  // namespace
}  // namespace dwell::testing
