#include "tracker/measurement.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/tracker/matrices.hpp"
#include "tracker/tracker.hpp"

namespace dwell {
namespace {

using matrices::kEpsilon;
using matrices::near;

constexpr double kPi = std::numbers::pi;

RangeBearingRadar radar_at(const Vector2& position_m) {
  RadarFigures figures;
  figures.position_m = position_m;
  figures.snr_reference = 100.0;  // 0.5 m and 0.044 deg at 100 km
  return RangeBearingRadar(figures);
}

LinearSensor linear_sensor() {
  MeasurementJacobian c;
  c << 1, 0, 0, 0.1, 0, 1, 0.1, 0;  // Liu, Hwang (2011), (25)
  return {c, Matrix2::Identity(), 1.0};
}

ImmEstimate estimate_round(const Vector2& place_m, RandomStream& stream) {
  ImmEstimate estimate;
  for (int j = 0; j < 3; ++j) {
    estimate.modes.push_back(matrices::random_gaussian(stream));
    estimate.modes.back().mean =
        make_state(place_m, {200.0, -100.0}) + State(80.0, 5.0, 80.0, 5.0).cwiseProduct(matrices::normal_state(stream));
  }
  estimate.probability = matrices::random_probability(stream, 3);
  return estimate;
}

std::vector<PredictedMeasurement> predicted_by(const Sensor& sensor, UpdateForm form, const ImmEstimate& estimate) {
  std::vector<PredictedMeasurement> predicted;
  EXPECT_EQ(predict_measurements(sensor, form, estimate, predicted), Numerics::kOk);
  return predicted;
}

// Central differences of z(x), bearings the short way round, with a step of 1e-5 of the range: the truncation
// is (1e-5)^2 / 3 of the derivative, the rounding eps / 1e-5 of it; due south included.
TEST(EkfForm, LinearisesEachModeAtItsMean) {
  RandomStream stream(1);
  const RangeBearingRadar radar = radar_at({1e4, -2e4});
  for (int degree = -180; degree <= 180; degree += 15) {
    const double range_m = 50e3;
    const Vector2 place = to_cartesian({1e4, -2e4}, {range_m, degree * kDegree});
    const ImmEstimate estimate = estimate_round(place, stream);
    const auto predicted = predicted_by(radar, UpdateForm::kEkf, estimate);
    for (std::size_t j = 0; j < predicted.size(); ++j) {
      const State& mean = estimate.modes[j].mean;
      EXPECT_EQ(predicted[j].z, radar.measure(mean));
      const double step = 1e-5 * range_m;
      for (int component = 0; component < kStateSize; ++component) {
        const State d = step * State::Unit(component);
        const Vector2 slope =
            innovation(radar, UpdateForm::kEkf, radar.measure(mean + d), radar.measure(mean - d)) / (2.0 * step);
        EXPECT_NEAR(predicted[j].h(0, component), slope[0], 1e-9) << degree;
        EXPECT_NEAR(predicted[j].h(1, component), slope[1], 1e-9 / range_m) << degree;
      }
    }
  }
}

TEST(EveryForm, TakesTheNoiseAtTheWeightedMeanForEveryMode) {
  RandomStream stream(2);
  const RangeBearingRadar radar = radar_at({0.0, 0.0});
  ImmEstimate estimate = estimate_round({3e4, 4e4}, stream);
  estimate.modes[2].mean += make_state({2e3, 3e3}, {0.0, 0.0});
  const Matrix2 r = radar.noise(combined_mean(estimate));
  for (const PredictedMeasurement& mode : predicted_by(radar, UpdateForm::kEkf, estimate)) EXPECT_EQ(mode.r, r);
  const auto converted = predicted_by(radar, UpdateForm::kConverted, estimate);
  for (const PredictedMeasurement& mode : converted) EXPECT_EQ(mode.r, converted[0].r);
}

// Evans et al. (2005), V, the equation under Table I, with theta from the x axis: theta = 90 deg - azimuth.
TEST(ConvertedForm, NoiseIsEvansPrintedMatrix) {
  RandomStream stream(3);
  const Vector2 origin(120e3, 120e3);
  const RangeBearingRadar radar = radar_at(origin);
  for (const double range_m : {100.0, 1e4, 2e5}) {
    for (int degree = -180; degree <= 180; degree += 15) {
      const double theta = (90.0 - degree) * kDegree;
      const Vector2 place = origin + range_m * Vector2(std::cos(theta), std::sin(theta));
      ImmEstimate estimate =
          make_estimate({make_state(place, {0.0, 0.0}), StateMatrix::Identity()}, Eigen::Vector2d(0.5, 0.5));
      const double d2s = std::pow(range_m * radar.azimuth_sigma_rad(range_m), 2);
      const double s2 = std::pow(radar.range_sigma_m(range_m), 2);
      const double s = std::sin(theta);
      const double c = std::cos(theta);
      Matrix2 printed;
      printed << d2s * s * s + s2 * c * c, (s2 - d2s) * s * c,  //
          (s2 - d2s) * s * c, d2s * c * c + s2 * s * s;
      // The direction of 100 m from an origin of 1e5 m is good to 1e3 eps, and noise of SNR to four times
      // that.
      const auto predicted = predicted_by(radar, UpdateForm::kConverted, estimate);
      EXPECT_TRUE(near(predicted[0].r, printed, 8e3 * kEpsilon * std::max(d2s, s2)))
          << range_m << " m, " << degree << " deg";
      EXPECT_EQ(predicted[0].h, position_selector());
      EXPECT_EQ(predicted[0].z, position(estimate.modes[0].mean));
    }
  }
}

// Due east the range is along x, due north along y: the twin that shows which of sin^2 and cos^2 stands
// where.
TEST(ConvertedForm, RangeNoiseLiesAlongTheLineOfSight) {
  const RangeBearingRadar radar = radar_at({0.0, 0.0});
  const double along = std::pow(radar.range_sigma_m(1e5), 2);
  const double across = std::pow(1e5 * radar.azimuth_sigma_rad(1e5), 2);
  const auto noise_at = [&](const Vector2& place) {
    const Gaussian belief{make_state(place, {0.0, 0.0}), StateMatrix::Identity()};
    return predicted_by(radar, UpdateForm::kConverted, make_estimate(belief, Eigen::VectorXd::Ones(1)))[0].r;
  };
  const double rounding = 16.0 * kEpsilon * across;
  EXPECT_TRUE(near(noise_at({1e5, 0.0}), Matrix2(Vector2(along, across).asDiagonal()), rounding));
  EXPECT_TRUE(near(noise_at({0.0, 1e5}), Matrix2(Vector2(across, along).asDiagonal()), rounding));
  EXPECT_TRUE(near(noise_at({0.0, -1e5}), Matrix2(Vector2(across, along).asDiagonal()), rounding));
}

TEST(ConvertedForm, TurnsPlotsIntoPlaces) {
  const RangeBearingRadar radar = radar_at({1000.0, 2000.0});
  const Vector2 z(5e3, 90.0 * kDegree);
  EXPECT_TRUE(near(measurement_of(radar, UpdateForm::kConverted, z), Vector2(6000.0, 2000.0), 1e-11));
  EXPECT_EQ(measurement_of(radar, UpdateForm::kEkf, z), z);
}

TEST(Innovation, WrapsBearingsInTheEkfFormOnly) {
  const RangeBearingRadar radar = radar_at({0.0, 0.0});
  const Vector2 z(100.0, -kPi + 0.01);
  const Vector2 predicted(90.0, kPi - 0.01);
  EXPECT_TRUE(near(innovation(radar, UpdateForm::kEkf, z, predicted), Vector2(10.0, 0.02), 4.0 * kEpsilon));
  EXPECT_EQ(innovation(radar, UpdateForm::kConverted, z, predicted), Vector2(z - predicted));
}

TEST(LinearSensor, IgnoresTheForm) {
  RandomStream stream(4);
  const LinearSensor sensor = linear_sensor();
  const ImmEstimate estimate = estimate_round({3e4, -2e4}, stream);
  const auto ekf = predicted_by(sensor, UpdateForm::kEkf, estimate);
  const auto converted = predicted_by(sensor, UpdateForm::kConverted, estimate);
  const Vector2 z(3e4, 150.0);
  EXPECT_EQ(measurement_of(sensor, UpdateForm::kConverted, z), z);
  for (std::size_t j = 0; j < ekf.size(); ++j) {
    EXPECT_EQ(ekf[j].z, converted[j].z);
    EXPECT_EQ(ekf[j].h, converted[j].h);
    EXPECT_EQ(ekf[j].r, converted[j].r);
    EXPECT_EQ(ekf[j].s, converted[j].s);
    EXPECT_EQ(innovation(sensor, UpdateForm::kEkf, z, ekf[j].z), Vector2(z - ekf[j].z));
    EXPECT_EQ(innovation(sensor, UpdateForm::kConverted, z, ekf[j].z), Vector2(z - ekf[j].z));
  }
}

// Moments of h over a Gaussian that is wide in azimuth: 30 km away, 1000 m across. Degree 3 leaves the fourth moments
// of the curvature: the mean range is off by s^2 / 2R = 16.7 m, which the cubature form finds to (s / R)^2 of it, 1e-3,
// and the EKF form not at all. Against 10^6 draws: the standard error of their mean is sigma / 1000.
TEST(CubatureForm, HasTheMeanOfThePolarMeasurement) {
  const RangeBearingRadar radar = radar_at({0.0, 0.0});
  const Gaussian belief{make_state({0.0, 30e3}, {0.0, 0.0}), State(1e6, 1.0, 100.0, 1.0).asDiagonal()};
  const ImmEstimate estimate = make_estimate(belief, Eigen::VectorXd::Ones(1));
  RandomStream stream(6);
  constexpr int kDraws = 1000000;
  Vector2 sum = Vector2::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const State x = belief.mean + State(1000.0 * stream.normal(), 0.0, 10.0 * stream.normal(), 0.0);
    sum += radar.residual(radar.measure(x), radar.measure(belief.mean));
  }
  const auto cubature = predicted_by(radar, UpdateForm::kCubature, estimate)[0];
  const double mean = sum[0] / kDraws;
  const double sigma = std::hypot(10.0, 23.6);  // the range's, the curvature's share sqrt(2) 16.7
  EXPECT_NEAR(cubature.z[0] - 30e3, mean, 5.0 * sigma / 1000.0 + 0.02 * mean);
  EXPECT_NEAR(predicted_by(radar, UpdateForm::kEkf, estimate)[0].z[0] - 30e3, 0.0, 1e-9);
  EXPECT_GT(mean, 15.0);
}

// Of a linear sensor the moments are exact: z, H, R and S of the EKF form but for rounding through the root of P.
TEST(CubatureForm, OfALinearSensorIsTheEkfForm) {
  RandomStream stream(7);
  const LinearSensor sensor = linear_sensor();
  const ImmEstimate estimate = estimate_round({3e4, -2e4}, stream);
  const auto ekf = predicted_by(sensor, UpdateForm::kEkf, estimate);
  const auto cubature = predicted_by(sensor, UpdateForm::kCubature, estimate);
  for (std::size_t j = 0; j < ekf.size(); ++j) {
    const double scale = ekf[j].s.diagonal().maxCoeff();
    EXPECT_TRUE(near(cubature[j].z, ekf[j].z, 1e-9));
    EXPECT_TRUE(near(cubature[j].h, ekf[j].h, 1e-9));
    EXPECT_TRUE(near(cubature[j].r, ekf[j].r, 1e-10 * scale));
    EXPECT_TRUE(near(cubature[j].s, ekf[j].s, 1e-10 * scale));
  }
}

TEST(PredictMeasurements, ReportsAModeThatIsNotPositiveDefinite) {
  RandomStream stream(5);
  ImmEstimate estimate = estimate_round({3e4, 0.0}, stream);
  estimate.modes[1].covariance = -1e6 * StateMatrix::Identity();
  std::vector<PredictedMeasurement> predicted;
  for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted, UpdateForm::kCubature}) {
    EXPECT_EQ(predict_measurements(radar_at({0.0, 0.0}), form, estimate, predicted), Numerics::kNotPositiveDefinite);
  }
}

// Over the radar a bearing means nothing. What is predicted there is finite, in either form.
TEST(PredictMeasurements, OverTheRadarIsFinite) {
  const RangeBearingRadar radar = radar_at({7e3, -3e3});
  for (const double distance_m : {0.0, 1e-300, 1e-9, 0.3, 1.0}) {
    const Gaussian belief{make_state({7e3 + distance_m, -3e3}, {300.0, 0.0}), StateMatrix::Identity()};
    const ImmEstimate estimate = make_estimate(belief, Eigen::Vector2d(0.5, 0.5));
    for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted, UpdateForm::kCubature}) {
      for (const PredictedMeasurement& mode : predicted_by(radar, form, estimate)) {
        EXPECT_TRUE(mode.z.allFinite() && mode.h.allFinite() && mode.r.allFinite() && mode.s.allFinite())
            << distance_m << " m";
      }
    }
  }
}

TEST(MixtureSquaredDistance, OfOneModeIsItsOwn) {
  RandomStream stream(6);
  for (int i = 0; i < 100; ++i) {
    const ImmEstimate estimate = make_estimate(matrices::random_gaussian(stream), Eigen::VectorXd::Ones(1));
    const auto predicted = predicted_by(linear_sensor(), UpdateForm::kEkf, estimate);
    const Vector2 nu(100.0 * stream.normal(), 100.0 * stream.normal());
    const double expected = predicted[0].squared_distance(nu);
    // Two ways of solving with S, whose condition is under 1e4 here.
    EXPECT_NEAR(mixture_squared_distance(predicted, estimate.probability, std::vector<Vector2>{nu}), expected,
                1e-11 * expected);
  }
}

// Innovations (2, 0) and (-2, 0), S = I and 3 I, even weights: mean 0. Weights 3/4 and 1/4: mean (1, 0),
// S = 3/4 (I + diag(1, 0)) + 1/4 (3 I + diag(9, 0)) = diag(4.5, 1.5), squared distance 1 / 4.5.
TEST(MixtureSquaredDistance, MatchesMomentsByHand) {
  std::vector<PredictedMeasurement> predicted(2);
  predicted[0].r = Matrix2::Identity();
  predicted[1].r = 3.0 * Matrix2::Identity();
  for (PredictedMeasurement& mode : predicted) ASSERT_EQ(factorise(StateMatrix::Zero(), mode), Numerics::kOk);
  const std::vector<Vector2> innovations{{2.0, 0.0}, {-2.0, 0.0}};
  EXPECT_EQ(mixture_squared_distance(predicted, Eigen::Vector2d(0.5, 0.5), innovations), 0.0);
  EXPECT_DOUBLE_EQ(mixture_squared_distance(predicted, Eigen::Vector2d(0.75, 0.25), innovations), 1.0 / 4.5);
}

struct Flight {
  double rotation_rad;
  UpdateForm form;
};

Vector2 rotate(const Vector2& v, double angle_rad) {  // clockwise, as azimuths grow
  const double s = std::sin(angle_rad);
  const double c = std::cos(angle_rad);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x()};
}

State rotate(const State& x, double angle_rad) {
  return make_state(rotate(position(x), angle_rad), rotate(velocity(x), angle_rad));
}

/// A target that crosses the azimuth `rotation` from left to right, 30 km from the radar, and manoeuvres on
/// the way: the track's combined estimate at every scan. Plots carry the same errors whatever the rotation.
std::vector<Gaussian> fly_past(const Flight& flight) {
  RandomStream stream(7);
  const RangeBearingRadar radar = radar_at({0.0, 0.0});
  const ModeBank bank = named_bank("cruise_and_turn").value();
  TrackerSettings settings;
  settings.update = flight.form;
  Tracker tracker(discretise(bank, 1.0).value(), bank.initial_probability, settings);
  State truth = make_state({-5e3, 30e3}, {250.0, 0.0});
  const State first_guess = truth + State(50.0, -20.0, -80.0, 10.0);
  const Gaussian belief{rotate(first_guess, flight.rotation_rad), State(1e4, 400.0, 1e4, 400.0).asDiagonal()};
  Track track = tracker.start(TrackId{1}, "one", belief);
  std::vector<Gaussian> estimates;
  for (int k = 1; k <= 40; ++k) {
    const bool turning = k > 15 && k < 25;
    truth = turning ? State(transition(CoordinatedTurn{0.1}, 1.0) * truth)
                    : State(transition(ConstantVelocity{}, 1.0) * truth);
    tracker.predict(track);
    const Vector2 exact = radar.measure(truth);
    const Matrix2 root = radar.noise(truth).llt().matrixL();
    const Vector2 z = exact + root * Vector2(stream.normal(), stream.normal());
    const TimePoint time = kStreamStart + from_seconds(k);
    const Plot plot{time, RadarId{1}, {z[0], wrap_angle(z[1] + flight.rotation_rad)}, std::nullopt};
    const LookOutcome outcome = tracker.look(track, radar, {RadarId{1}, TrackId{1}, time, State::Zero()}, {&plot, 1});
    EXPECT_TRUE(outcome.used_plot) << "scan " << k << ", rotation " << flight.rotation_rad;
    estimates.push_back(track.combined);
  }
  return estimates;
}

// The bank is the same in every direction, so that the whole tracker turns with the plane. A crossing of the
// cut due south (rotation 180 deg) is nothing else than one due north. Rotating costs eps of 30 km, 7e-12 m,
// and the filter returns it at most a hundredfold: 1e-9 of positions and velocities, relative to kilometres
// and hundreds of m/s.
TEST(Tracking, IsInvariantUnderRotationAcrossTheCut) {
  // Not the cubature form, whose points lie along the columns of a triangular root.
  for (const UpdateForm form : {UpdateForm::kEkf, UpdateForm::kConverted}) {
    const std::vector<Gaussian> north = fly_past({0.0, form});
    for (const double rotation : {kPi, kPi - 0.05, kPi + 0.05, -kPi / 2.0, 1.0}) {
      const std::vector<Gaussian> turned = fly_past({rotation, form});
      ASSERT_EQ(turned.size(), north.size());
      for (std::size_t k = 0; k < north.size(); ++k) {
        const State back = rotate(turned[k].mean, -rotation);
        EXPECT_TRUE(near(position(back), position(north[k].mean), 1e-9 * 30e3)) << k << ", rotation " << rotation;
        EXPECT_TRUE(near(velocity(back), velocity(north[k].mean), 1e-9 * 250.0)) << k << ", rotation " << rotation;
        const double variance = north[k].covariance.trace();
        EXPECT_NEAR(turned[k].covariance.trace(), variance, 1e-9 * variance);
      }
    }
  }
}

}  // namespace
}  // namespace dwell
