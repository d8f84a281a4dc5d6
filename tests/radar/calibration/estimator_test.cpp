#include "radar/calibration/estimator.hpp"

#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "radar/calibration/joint.hpp"
#include "tests/radar/calibration/scene.hpp"
#include "tests/scale.hpp"
#include "tests/statistics.hpp"

namespace dwell::testing {
namespace {

using Kind = CorrectionKind;

/// Wrong in everything, and differently for each radar.
SceneOptions wrong_radars() {
  SceneOptions scene;
  scene.turn_every_s = 150;
  scene.truth[0] = {std::log(3.0), std::log(0.5), 30.0, 0.2 * kDegree, 0.0};
  scene.truth[1] = {std::log(0.5), std::log(3.0), -30.0, 0.0, 0.05};
  scene.truth[2] = {0.0, 0.0, 0.0, -0.2 * kDegree, -0.05};
  return scene;
}

struct Method {
  const char* name;
  CalibrationEstimate (*estimate)(const CalibrationWindow&, const MotionPrior&, std::span<const Correction>,
                                  const EstimatorSettings&);
};

/// What holds for both: maximum likelihood of innovations, and least squares over trajectories.
class CalibrationEstimator : public ::testing::TestWithParam<Method> {
 protected:
  CalibrationEstimate estimate(const CalibrationWindow& window, const EstimatorSettings& settings = {}) const {
    const std::vector<Correction> start(window.radar_position_m.size());
    return GetParam().estimate(window, one_mode(0.1), start, settings);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, CalibrationEstimator,
                         ::testing::Values(Method{"innovations", estimate_corrections},
                                           Method{"joint", estimate_jointly}),
                         [](const auto& test) { return std::string(test.param.name); });

// 15 standardised errors a run: chi-square with 15 degrees of freedom if estimate and covariance are right. Less the
// prior's part, which draws to zero and is negligible but for the common time bias, whose truth is zero here.
TEST_P(CalibrationEstimator, ErrorsAreAsLargeAsTheReportedCovarianceSays) {
  const int runs = scaled(10);
  double sum = 0.0;
  int within_two = 0;
  int within_three = 0;
  int parameters = 0;
  for (int run = 0; run < runs; ++run) {
    const SceneOptions scene = wrong_radars();
    const CalibrationEstimate result = estimate(simulate(scene, RandomStream(run + 1)));
    ASSERT_EQ(result.status, EstimatorStatus::kDone) << to_string(result.status);
    for (int radar = 0; radar < 3; ++radar) {
      const CorrectionVector error = to_vector(result.correction(radar)) - to_vector(scene.truth[radar]);
      for (int k = 0; k < kCorrectionSize; ++k) {
        if (static_cast<Kind>(k) == Kind::kTimeBias) continue;
        const double ratio = error[k] / result.standard_error(radar, static_cast<Kind>(k));
        sum += ratio * ratio;
        within_two += std::abs(ratio) <= 2.0;
        within_three += std::abs(ratio) <= 3.0;
        ++parameters;
      }
    }
  }
  std::printf("mean squared standardised error %.3f, within 2: %.3f, within 3: %.4f\n", sum / parameters,
              static_cast<double>(within_two) / parameters, static_cast<double>(within_three) / parameters);
  // The parameters of a run are correlated: the band is that of a third as many independent ones.
  const auto band = statistics::chi_square_band(parameters / 3.0);
  EXPECT_TRUE(statistics::Band({band.low * 3.0, band.high * 3.0}).contains(sum)) << sum / parameters;
}

TEST_P(CalibrationEstimator, BringsNisToTwo) {
  const CalibrationEstimate result = estimate(simulate(wrong_radars(), RandomStream(5)));
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  for (int radar = 0; radar < 3; ++radar) {
    std::printf("radar %d: %d plots, NIS %.2f -> %.2f\n", radar, result.plots[radar], result.nis_before[radar],
                result.nis_after[radar]);
    for (int k = 0; k < kCorrectionSize; ++k) {
      const auto kind = static_cast<Kind>(k);
      std::printf("   %.5f +- %.5f, prior share %.3f\n", to_vector(result.correction(radar))[k],
                  result.standard_error(radar, kind), result.prior_share(radar, kind));
    }
    // The sum of n NIS is chi-square with 2 n degrees of freedom, less those the estimate has used up.
    const auto band = statistics::chi_square_band(2.0 * result.plots[radar]);
    EXPECT_TRUE(band.contains(result.nis_after[radar] * result.plots[radar]));
    EXPECT_FALSE(band.contains(result.nis_before[radar] * result.plots[radar]));
  }
  std::printf("%d evaluations, gain %.1f\n", result.evaluations, result.log_likelihood_gain);
  EXPECT_LE(result.evaluations, 40);
  EXPECT_GT(result.log_likelihood_gain, 100.0);
}

TEST_P(CalibrationEstimator, OneRadarAloneCannotSeeItsAzimuthBias) {
  SceneOptions scene;
  scene.radars.resize(1);
  scene.truth.assign(1, {0.0, 0.0, 0.0, 0.2 * kDegree, 0.0});
  scene.targets = 1;
  const auto result = estimate(simulate(scene, RandomStream(4)));
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  EXPECT_TRUE(result.observable(0, Kind::kLogRangeScale));
  EXPECT_TRUE(result.observable(0, Kind::kLogAzimuthScale));
  // Turned about the radar, a track is as good as it was: nothing but the prior.
  EXPECT_GT(result.prior_share(0, Kind::kAzimuthBias), 0.95);
  EXPECT_GT(result.prior_share(0, Kind::kTimeBias), 0.95);
}

TEST_P(CalibrationEstimator, OfTimeBiasesOnlyTheDifferencesAreSeen) {
  EstimatorSettings settings;
  settings.prior.time_bias_s = 1.0;  // the differences are seen to .09 s
  const auto result = estimate(simulate(wrong_radars(), RandomStream(6)), settings);
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  Eigen::VectorXd common = Eigen::VectorXd::Zero(15);
  for (int radar = 0; radar < 3; ++radar) common[radar * kCorrectionSize + static_cast<int>(Kind::kTimeBias)] = 1.0;
  // Plots that are all late are of a target that is early, F(b) x for x: of the same motion but for F(b) Q F(b)' for Q.
  EXPECT_GT(result.prior_share(common), 0.95);
  for (int radar = 0; radar < 3; ++radar) {
    EXPECT_FALSE(result.observable(radar, Kind::kTimeBias));
    EXPECT_TRUE(result.difference_observable(radar, (radar + 1) % 3, Kind::kTimeBias));
  }
}

/// A straight target for 100 s: two radars see the same line at the same speed from where it is shifted and turned.
TEST_P(CalibrationEstimator, OneStraightTargetTellsNoBiases) {
  SceneOptions scene;
  scene.radars.resize(2);
  scene.truth.resize(2);
  scene.targets = 1;
  scene.scans = 100;
  scene.q = 0.0;
  const auto result = estimate(simulate(scene, RandomStream(10)));
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  for (int radar = 0; radar < 2; ++radar) {
    for (const Kind kind : {Kind::kRangeBias, Kind::kAzimuthBias, Kind::kTimeBias}) {
      std::printf("radar %d, parameter %d: prior share %.3f\n", radar, static_cast<int>(kind),
                  result.prior_share(radar, kind));
      EXPECT_FALSE(result.observable(radar, kind));
    }
  }
}

TEST_P(CalibrationEstimator, ARadarWithoutPlotsKeepsItsPrior) {
  CalibrationWindow window = simulate({}, RandomStream(7));
  std::erase_if(window.plots, [](const CalibrationPlot& plot) { return plot.radar == 2; });
  const auto result = estimate(window);
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  EXPECT_EQ(result.plots[2], 0);
  EXPECT_DOUBLE_EQ(result.nis_after[2], 0.0);
  for (int k = 0; k < kCorrectionSize; ++k) {
    EXPECT_NEAR(result.prior_share(2, static_cast<Kind>(k)), 1.0, 1e-9);
    EXPECT_NEAR(to_vector(result.correction(2))[k], 0.0, 1e-9);
  }
}

TEST_P(CalibrationEstimator, KnownTruthPinsTheBiasesToTheirMeans) {
  SceneOptions scene = wrong_radars();
  scene.q = 0.0;
  scene.turn_every_s = 0;
  CalibrationWindow window = simulate(scene, RandomStream(8));
  // Without process noise the truth is straight flight from the start; recomputed as `simulate` places it.
  for (CalibrationPlot& plot : window.plots) {
    const double angle = 2.0 * (plot.track % 100) + 0.3;
    const Vector2 out(std::sin(angle), std::cos(angle));
    const Vector2 v = 200.0 * Vector2(-out.y(), out.x());
    plot.truth = make_state(20e3 * out + static_cast<double>(plot.scan) * v, v);
  }
  EstimatorSettings settings;
  settings.prior.time_bias_s = 1.0;
  const auto result = estimate(window, settings);
  ASSERT_EQ(result.status, EstimatorStatus::kDone);
  for (int radar = 0; radar < 3; ++radar) {
    EXPECT_TRUE(result.observable(radar, Kind::kTimeBias));
    const double sigma = three_radars()[radar].range_noise_floor_m * std::exp(scene.truth[radar].log_range_scale);
    // The mean of n plots, and no better than that for the time bias beside it.
    EXPECT_GE(result.standard_error(radar, Kind::kRangeBias), 0.9 * sigma / std::sqrt(result.plots[radar]));
    for (int k = 0; k < kCorrectionSize; ++k) {
      const double error = to_vector(result.correction(radar))[k] - to_vector(scene.truth[radar])[k];
      EXPECT_LE(std::abs(error), 5.0 * result.standard_error(radar, static_cast<Kind>(k))) << radar << " " << k;
    }
  }
}

TEST_P(CalibrationEstimator, SaysWhyItHasNoResult) {
  const CalibrationWindow window = simulate({}, RandomStream(9));
  CalibrationWindow three = window;
  three.plots.resize(3);
  EXPECT_EQ(estimate(three).status, EstimatorStatus::kTooFewPlots);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CalibrationWindow poisoned = window;
    poisoned.plots[20].z[1] = bad;
    EXPECT_EQ(estimate(poisoned).status, EstimatorStatus::kNotFinite);
  }
  EstimatorSettings stopped;
  stopped.stop = [] { return true; };
  EXPECT_EQ(estimate(window, stopped).status, EstimatorStatus::kStopped);
  EstimatorSettings short_of_time;
  short_of_time.time_limit_s = 0.0;
  EXPECT_EQ(estimate(simulate(wrong_radars(), RandomStream(9)), short_of_time).status, EstimatorStatus::kTimeLimit);
  // The same plot a hundred times: singular without the prior, and with it no more than unobservable; or noise that is
  // not there, which is refused.
  CalibrationWindow same = window;
  same.plots.assign(100, window.plots[0]);
  const auto rank_deficient = estimate(same);
  if (rank_deficient.status != EstimatorStatus::kDone) {
    EXPECT_EQ(rank_deficient.status, EstimatorStatus::kNotPositive);
  } else {
    EXPECT_FALSE(rank_deficient.observable(0, Kind::kRangeBias));
  }
}

/// The same model by smoothed states and by innovations. What differs is that restricted likelihood weighs the noise
/// scales with nine biases taken out: at most 9 in the gradient by the scales, whose information is 2 x 100 plots or
/// more: 81 / 200 / 2 = .2 of the log likelihood; and how h is linearised. One unit is .4 standard errors in each
/// of 15.
TEST(CalibrationEstimator, BothMethodsAgree) {
  for (int seed = 1; seed <= 3; ++seed) {
    const CalibrationWindow window = simulate(wrong_radars(), RandomStream(static_cast<std::uint64_t>(seed)));
    const std::vector<Correction> start(3);
    const auto one = estimate_corrections(window, one_mode(0.1), start, {});
    const auto other = estimate_jointly(window, one_mode(0.1), start, {});
    ASSERT_EQ(one.status, EstimatorStatus::kDone);
    ASSERT_EQ(other.status, EstimatorStatus::kDone);
    const Eigen::VectorXd sigma = one.covariance.diagonal().cwiseSqrt();
    EXPECT_GE(other.log_likelihood_gain, one.log_likelihood_gain - 1.0);
    EXPECT_LE((other.covariance.diagonal().cwiseSqrt().cwiseQuotient(sigma).array() - 1.0).abs().maxCoeff(), 0.05);
  }
}

}  // namespace
}  // namespace dwell::testing
