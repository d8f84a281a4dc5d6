#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "radar/range_bearing_radar.hpp"
#include "tests/scale.hpp"
#include "tests/tracker/catalogue.hpp"
#include "tests/tracker/matrices.hpp"
#include "tracker/measurement.hpp"

/// Covariances stay symmetric and positive definite over a million cycles of prediction and update: every
/// bank, every update form, intervals 1e-3 .. 100 s, targets 10 m .. 1000 km away in every direction, and
/// measurement variances of 1e-9 .. 1e9 times the predicted one.
///
/// How much finer a radar measures along than across, as a ratio of variances, is bounded here by 1e8; a
/// radar of 1 degree and 50 ns has 2e6 at 1000 km. At 1e12 the converted form loses definiteness in some of
/// 1e5 updates, because R itself, turned into x and y, is no longer representable; the EKF form does so at
/// 1e14, where P is not.
namespace dwell {
namespace {

/// What the cycles are drawn from, logarithmically uniform.
struct Extent {
  double shortest_s;
  double longest_s;
  double ratio;   // of the measurement's variances to the predicted ones, either way
  double aspect;  // of the two, either way
};
constexpr Extent kWide{1e-3, 100.0, 1e9, 1e8};
constexpr int kCyclesPerTrack = 1000;  // positions wander off with their own noise: start again before they matter

double log_uniform(RandomStream& stream, double low, double high) {
  return std::exp(stream.uniform(std::log(low), std::log(high)));
}

/// The bank over an interval shorter than a step of its noise: with that interval as the step.
ModeBank with_step(ModeBank bank, double step_s) {
  for (Mode& mode : bank.modes) {
    if (auto* noise = std::get_if<PiecewiseAcceleration>(&mode.noise)) noise->step_s = step_s;
    if (auto* noise = std::get_if<DiagonalNoise>(&mode.noise)) noise->step_s = step_s;
  }
  return bank;
}

/// The bank over 200 intervals, whole seconds above one.
std::vector<DiscreteBank> over_random_intervals(const ModeBank& bank, const Extent& extent, RandomStream& stream) {
  std::vector<DiscreteBank> banks;
  for (int i = 0; i < 200; ++i) {
    const double dt_s = log_uniform(stream, extent.shortest_s, extent.longest_s);
    banks.push_back(dt_s < 1.0 ? discretise(with_step(bank, dt_s), dt_s).value()
                               : discretise(bank, std::round(dt_s)).value());
  }
  return banks;
}

/// A radar somewhere round the belief whose variances are random multiples of the belief's own along and
/// across.
RangeBearingRadar random_radar(const Gaussian& belief, const Extent& extent, RandomStream& stream) {
  const double azimuth = stream.uniform(-std::numbers::pi, std::numbers::pi);
  const Vector2 along(std::sin(azimuth), std::cos(azimuth));
  const Vector2 across(along.y(), -along.x());
  const double range_m = log_uniform(stream, 10.0, 1e6);
  const double ratio = log_uniform(stream, 1.0 / extent.ratio, extent.ratio);
  const double aspect = log_uniform(stream, 1.0 / extent.aspect, extent.aspect);
  const Matrix2 p = position_block(belief.covariance);
  RadarFigures figures;
  figures.snr_reference = 1e60;  // the floors alone make the noise
  figures.position_m = position(belief.mean) - range_m * along;
  figures.range_noise_floor_m = std::sqrt(ratio * along.dot(p * along));
  figures.azimuth_noise_floor_rad = std::sqrt(ratio * aspect * across.dot(p * across)) / range_m;
  return RangeBearingRadar(figures);
}

Gaussian new_belief(RandomStream& stream) {
  return {State(1e4, 300.0, 1e4, 300.0).cwiseProduct(matrices::normal_state(stream)),
          matrices::random_covariance(stream, matrices::typical_sigma())};
}

/// Innovations of one plot in every mode: drawn from the first mode's prediction.
std::vector<Vector2> draw_innovations(const Sensor& sensor, UpdateForm form,
                                      const std::vector<PredictedMeasurement>& predicted, RandomStream& stream) {
  const Vector2 z = predicted[0].z + predicted[0].s_root.matrixL() * Vector2(stream.normal(), stream.normal());
  std::vector<Vector2> innovations;
  for (const PredictedMeasurement& mode : predicted) {
    innovations.push_back(innovation(sensor, form, z, mode.z));
  }
  return innovations;
}

/// A bank by its name, or "accelerations" or "turn_rate": a mode of every motion with such trailing states, with one of
/// constant velocity.
ModeBank bank_of(const std::string& name) {
  if (auto bank = named_bank(name)) return *bank;
  const TrailingKind kind = name == "turn_rate" ? TrailingKind::kTurnRate : TrailingKind::kAcceleration;
  ModeBank bank;
  bank.modes.push_back({"cv", ConstantVelocity{}, WhiteNoiseAcceleration{0.1}, std::nullopt});
  for (const auto& row : catalogue::every_trailing()) {
    if (trailing_kind(row.model) == kind) bank.modes.push_back({row.name, {}, NoProcessNoise{}, row.model});
  }
  const auto count = std::ssize(bank.modes);
  bank.transition = Eigen::MatrixXd::Constant(count, count, 0.05 / static_cast<double>(count));
  bank.transition.diagonal().array() += 0.95;
  bank.initial_probability = Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count));
  return bank;
}

std::vector<std::string> every_bank() {
  std::vector<std::string> names = catalogue::every_bank();
  names.insert(names.end(), {"accelerations", "turn_rate"});
  return names;
}

/// A turn whose rate is unknown by more than a quarter radian at the end of the interval is not what is linearised of
/// it: 5 s at a start of .05 rad/s.
double longest_of(const std::string& name, double otherwise_s) { return name == "turn_rate" ? 5.0 : otherwise_s; }

class PositiveDefinite : public testing::TestWithParam<std::tuple<std::string, UpdateForm>> {};

INSTANTIATE_TEST_SUITE_P(Every, PositiveDefinite,
                         testing::Combine(testing::ValuesIn(every_bank()),
                                          testing::ValuesIn(catalogue::every_update())),
                         [](const auto& row) {
                           const std::string form = catalogue::name_of(std::get<1>(row.param));
                           return std::get<0>(row.param) + "_" + form;
                         });

/// Runs so many cycles; the least pivot of all covariances.
double least_pivot_of(const ModeBank& named, UpdateForm form, const Extent& extent, int cycles) {
  RandomStream stream(17);
  const std::vector<DiscreteBank> banks = over_random_intervals(named, extent, stream);
  ImmEstimate estimate, predicted;
  std::vector<PredictedMeasurement> measurements;
  double least_pivot = 1.0;
  const auto check = [&](const ImmEstimate& checked) {
    for (const Gaussian& mode : checked.modes) {
      if (mode.covariance != mode.covariance.transpose()) return false;
      least_pivot = std::min(least_pivot, matrices::smallest_pivot(mode.covariance));
    }
    return least_pivot > 0.0;
  };
  for (int k = 0; k < cycles; ++k) {
    if (k % kCyclesPerTrack == 0) estimate = make_estimate(new_belief(stream), named.initial_probability);
    EXPECT_EQ(predict(banks[stream.bits() % banks.size()], estimate, predicted), Numerics::kOk) << k;
    if (!check(predicted)) return ADD_FAILURE() << "after prediction " << k, least_pivot;
    const RangeBearingRadar radar = random_radar(combine(predicted), extent, stream);
    EXPECT_EQ(predict_measurements(radar, form, predicted, measurements), Numerics::kOk) << k;
    const auto innovations = draw_innovations(radar, form, measurements, stream);
    EXPECT_EQ(update(measurements, innovations, predicted), Numerics::kOk) << k;
    if (!check(predicted)) return ADD_FAILURE() << "after update " << k, least_pivot;
    if (testing::Test::HasFailure()) return least_pivot;
    std::swap(estimate, predicted);
  }
  return least_pivot;
}

/// Cycles are dealt out to them.
const int kKinds = static_cast<int>(catalogue::every_update().size() * every_bank().size());

/// Trailing states take thirty times as long: a tenth of them.
int share_of(const std::string& name, int cycles) { return cycles / kKinds / (named_bank(name) ? 1 : 10); }

TEST_P(PositiveDefinite, OverAMillionCycles) {
  const auto& [name, form] = GetParam();
  Extent extent = kWide;
  extent.longest_s = longest_of(name, extent.longest_s);
  const int cycles = soaked(1'000'000, share_of(name, scaled(1'000'000)));
  RecordProperty("least_pivot", testing::PrintToString(least_pivot_of(bank_of(name), form, extent, cycles)));
}

// What a plot of variance r leaves of a mode's velocity, as a share of what it was (the predicted pivot), one axis, the
// position known to r and the velocity to v before:
//
//   rank one      Q = s^2 g g', g = [T^2/2 T]      (4 r / T^2 + v) / (s T)^2 where the noise outweighs both
//   white noise   Q = q [T^3/3 T^2/2; T^2/2 T]     at least 1/4 where it does
//
// Noise that enters once a step has rank one, and no floor. A radar's r is a multiple 1 / ratio of the variance of all
// modes together, which may be that of the quietest: (s_quiet T^2 / 2)^2. So the pivot of the loudest is as little as
// (s_quiet / s_loud)^2 / ratio, which a covariance in double precision holds down to some tens of 2.2e-16.
double ratio_that_doubles_hold(const ModeBank& bank) {
  constexpr double kRoundings = 16.0;  // of products of 4 x 4
  double quiet = std::numeric_limits<double>::infinity();
  double loud = 0.0;
  for (const Mode& mode : bank.modes) {
    if (const auto* noise = std::get_if<PiecewiseAcceleration>(&mode.noise)) {
      quiet = std::min(quiet, noise->sigma_mps2);
      loud = std::max(loud, noise->sigma_mps2);
    }
  }
  const double share = loud > 0.0 ? quiet / loud : 1.0;
  return share * share / (kRoundings * matrices::kEpsilon);
}

// Intervals of a microsecond to a quarter of an hour and plots a million times sharper or duller than the prediction,
// in standard deviations, or as much as doubles hold: symmetric to the last bit, and definite. That is 2.5e9 in
// variances for evans_practical, whose modes of rank-one noise differ by 1e5; at 1e12 it loses one in 5e5 cycles.
TEST_P(PositiveDefinite, AtTheEndsOfWhatARadarMayBe) {
  const auto& [name, form] = GetParam();
  const ModeBank bank = bank_of(name);
  const Extent extreme{1e-6, longest_of(name, 1e3), std::min(1e12, ratio_that_doubles_hold(bank)), 1.0};
  const int cycles = soaked(10'000'000 / kKinds, share_of(name, scaled(200'000)));
  RecordProperty("least_pivot", testing::PrintToString(least_pivot_of(bank, form, extreme, cycles)));
}

// The two pivots above.
TEST(PositiveDefinite, NoiseByStepsHasNoFloor) {
  constexpr double kSigma = 100.0;
  for (const double known : {1.0, 1e-4, 1e-8}) {
    const double r = known;
    const double v = known;
    const StateMatrix p = State(r, v, r, v).asDiagonal();
    const StateMatrix f = transition(ConstantVelocity{}, 1.0);
    const auto pivot = [&](const ProcessNoise& noise) {
      return matrices::smallest_pivot(f * p * f.transpose() + process_noise(ConstantVelocity{}, noise, 1.0));
    };
    const double s2 = kSigma * kSigma;
    const double rank_one = (r * (v + s2) + v * s2 / 4.0) / ((r + v + s2 / 4.0) * (v + s2));  // T = 1
    EXPECT_NEAR(pivot(PiecewiseAcceleration{kSigma}), rank_one, 1e-14 + 1e-6 * rank_one);
    EXPECT_LT(rank_one, 6.0 * known / s2);
    EXPECT_GT(pivot(WhiteNoiseAcceleration{s2}), 0.2499);
  }
}

// The twin: P - K H P, the short form, is not positive definite within the first thousand of the same cycles.
TEST(PositiveDefinite, ShortFormFailsTheSameCycles) {
  const ModeBank named = named_bank("cruise_and_turn").value();
  RandomStream stream(17);
  const std::vector<DiscreteBank> banks = over_random_intervals(named, kWide, stream);
  int lost = 0;
  for (int k = 0; k < kCyclesPerTrack; ++k) {
    const ImmEstimate start = make_estimate(new_belief(stream), named.initial_probability);
    ImmEstimate predicted;
    std::vector<PredictedMeasurement> measurements;
    ASSERT_EQ(predict(banks[stream.bits() % banks.size()], start, predicted), Numerics::kOk);
    const RangeBearingRadar radar = random_radar(combine(predicted), kWide, stream);
    ASSERT_EQ(predict_measurements(radar, UpdateForm::kEkf, predicted, measurements), Numerics::kOk);
    const StateMatrix& p = predicted.modes[0].covariance;
    const Gain gain = kalman_gain(p, measurements[0]);
    const StateMatrix short_form = symmetric_part(p - gain * measurements[0].h * p);
    lost += matrices::smallest_pivot(short_form) > 0.0 ? 0 : 1;
  }
  EXPECT_GT(lost, 0);
}

}  // namespace
}  // namespace dwell
