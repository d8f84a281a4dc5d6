#include "tracker/footprint.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"

namespace dwell {
namespace {

RadarFigures narrow() {
  RadarFigures figures;
  figures.dwell_range_m = 2000.0;
  figures.dwell_azimuth_rad = 0.02;
  return figures;
}

Gaussian belief(double sigma_x_m, double sigma_y_m) {
  return {make_state({0.0, 5e4}, {0.0, 0.0}),
          State(sigma_x_m * sigma_x_m, 1.0, sigma_y_m * sigma_y_m, 1.0).asDiagonal()};
}

// North of the radar x is across and y along the beam: P = erf(h / (sqrt 2 s)) on each axis, the half width across
// being .02 rad x 50 km = 1000 m.
TEST(Footprint, ProbabilityOfACentredBeliefIsTheProductOfErrorFunctions) {
  const RangeBearingRadar radar(narrow());
  const Gaussian centred = belief(800.0, 3000.0);
  const double expected = std::erf(1000.0 / 800.0 / std::sqrt(2.0)) * std::erf(2000.0 / 3000.0 / std::sqrt(2.0));
  EXPECT_NEAR(footprint_probability(radar, centred, centred.mean), expected, 1e-12);
}

TEST(Footprint, HalfOfABeliefAtTheEdgeIsInside) {
  const RangeBearingRadar radar(narrow());
  const Gaussian at_edge = belief(10.0, 10.0);
  const State pointing = make_state({0.0, 5e4 - 2000.0}, {0.0, 0.0});
  EXPECT_NEAR(footprint_probability(radar, at_edge, pointing), 0.5, 1e-12);
}

TEST(Footprint, SensorWithoutABeamSeesEverywhere) {
  const LinearSensor sensor(MeasurementJacobian::Identity(), Matrix2::Identity(), 0.5);
  EXPECT_EQ(footprint_probability(sensor, belief(1e6, 1e6), State::Zero()), 1.0);
}

}  // namespace
}  // namespace dwell
