#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scale.hpp"
#include "tests/statistics.hpp"
#include "tests/tracker/matrices.hpp"
#include "tests/tracker/position_sensor.hpp"
#include "tracker/measurement.hpp"
#include "tracker/particle/bootstrap_filter.hpp"
#include "tracker/particle/marginal_filter.hpp"

namespace dwell {
namespace {

using matrices::near;

const Gaussian kStart{{100.0, 20.0, -50.0, 5.0}, State(400.0, 25.0, 400.0, 25.0).asDiagonal()};
const PositionSensor kSensor{(Matrix2() << 100.0, 30.0, 30.0, 225.0).finished(), 1.0, 0.0};

DiscreteBank one_mode() {
  return {
      {transition(ConstantVelocity{}, 1.0)}, {white_noise(ConstantVelocity{}, 4.0, 1.0)}, Eigen::MatrixXd::Ones(1, 1)};
}

DiscreteBank two_modes() {
  return {{transition(ConstantVelocity{}, 1.0), transition(CoordinatedTurn{0.2}, 1.0)},
          {white_noise(ConstantVelocity{}, 1.0, 1.0), white_noise(ConstantVelocity{}, 9.0, 1.0)},
          (Eigen::Matrix2d() << 0.9, 0.1, 0.2, 0.8).finished()};
}

std::vector<Vector2> plots(int count) {
  RandomStream stream(7);
  std::vector<Vector2> z;
  State x = kStart.mean;
  const DiscreteBank bank = two_modes();
  for (int k = 0; k < count; ++k) {
    x = bank.f[k > 3 ? 1 : 0] * x;
    z.push_back(position(x) + 10.0 * Vector2(stream.normal(), stream.normal()));
  }
  return z;
}

Gaussian kalman_step(const DiscreteBank& bank, std::size_t mode, const Gaussian& before, const Vector2& z,
                     double& log_likelihood) {
  Gaussian belief{bank.f[mode] * before.mean,
                  symmetric_part(bank.f[mode] * before.covariance * bank.f[mode].transpose() + bank.q[mode])};
  PredictedMeasurement predicted;
  predicted.h = position_selector();
  predicted.r = kSensor.noise(belief.mean);
  EXPECT_EQ(factorise(belief.covariance, predicted), Numerics::kOk);
  const Vector2 nu = z - position(belief.mean);
  log_likelihood = predicted.log_likelihood(nu);
  return kalman_update(belief, predicted, nu);
}

// Of one mode there is one history, whatever the number of particles: the Kalman filter.
TEST(MarginalFilter, OfOneModeIsTheKalmanFilter) {
  MarginalFilter filter(one_mode(), kStart, Eigen::VectorXd::Ones(1), 10, RandomStream(1));
  Gaussian expected = kStart;
  for (const Vector2& z : plots(50)) {
    double unused = 0.0;
    expected = kalman_step(one_mode(), 0, expected, z, unused);
    filter.predict();
    ASSERT_EQ(filter.update(kSensor, z), Numerics::kOk);
    EXPECT_EQ(filter.histories().size(), 1U);
    const Gaussian mode = filter.estimate().modes[0];
    ASSERT_TRUE(near(mode.mean, expected.mean, 1e-12 * expected.mean.norm()));
    ASSERT_TRUE(near(mode.covariance, expected.covariance, 1e-12 * expected.covariance.norm()));
  }
}

// 6 scans of two modes are 2 x 2^6 histories: with as many particles nothing is resampled, and the filter is the sum
// over all of them.
TEST(MarginalFilter, IsTheSumOverAllHistoriesWhileThereIsRoom) {
  const DiscreteBank bank = two_modes();
  const Eigen::Vector2d first(0.7, 0.3);
  std::vector<WeightedGaussian> histories{{0, first[0], kStart}, {1, first[1], kStart}};
  MarginalFilter filter(bank, kStart, first, 128, RandomStream(1));
  for (const Vector2& z : plots(6)) {
    std::vector<WeightedGaussian> longer;
    double sum = 0.0;
    for (const WeightedGaussian& history : histories) {
      for (int j = 0; j < 2; ++j) {
        double log_likelihood = 0.0;
        const Gaussian belief = kalman_step(bank, static_cast<std::size_t>(j), history.belief, z, log_likelihood);
        longer.push_back({j, history.weight * bank.transition(history.mode, j) * std::exp(log_likelihood), belief});
        sum += longer.back().weight;
      }
    }
    for (WeightedGaussian& history : longer) history.weight /= sum;
    histories = longer;
    filter.predict();
    ASSERT_EQ(filter.update(kSensor, z), Numerics::kOk);
  }
  const ImmEstimate expected = moments_by_mode(histories, 2);
  const ImmEstimate actual = filter.estimate();
  EXPECT_TRUE(near(actual.probability, expected.probability, 1e-12));
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_TRUE(near(actual.modes[j].mean, expected.modes[j].mean, 1e-9));
    EXPECT_TRUE(near(actual.modes[j].covariance, expected.modes[j].covariance, 1e-9));
  }
  EXPECT_EQ(filter.histories().size(), 128U);
}

TEST(MarginalFilter, KeepsNoMoreThanItsParticles) {
  MarginalFilter filter(two_modes(), kStart, Eigen::Vector2d(0.5, 0.5), 5, RandomStream(3));
  for (const Vector2& z : plots(50)) {
    filter.predict();
    EXPECT_LE(filter.histories().size(), 10U);
    ASSERT_EQ(filter.update(kSensor, z), Numerics::kOk);
    EXPECT_NEAR(filter.estimate().probability.sum(), 1.0, 1e-12);
  }
}

// Both against the sum over all histories: the mean error of independent filters, in its own standard errors. Student's
// t of 49 degrees is over 5.6 once in a million; the bias, of the order of one in the number of particles, is far
// below.
template <class Filter>
void expect_unbiased(int particles) {
  const Eigen::Vector2d first(0.7, 0.3);
  const auto z = plots(6);
  MarginalFilter exact(two_modes(), kStart, first, 128, RandomStream(1));
  for (const Vector2& plot : z) {
    exact.predict();
    ASSERT_EQ(exact.update(kSensor, plot), Numerics::kOk);
  }
  constexpr int kRuns = 50;
  Eigen::Matrix<double, 5, kRuns> errors;
  for (int run = 0; run < kRuns; ++run) {
    Filter filter(two_modes(), kStart, first, particles, RandomStream(static_cast<std::uint64_t>(run)));
    for (const Vector2& plot : z) {
      filter.predict();
      ASSERT_EQ(filter.update(kSensor, plot), Numerics::kOk);
    }
    errors.col(run) << combined_mean(filter.estimate()) - combined_mean(exact.estimate()),
        filter.estimate().probability[0] - exact.estimate().probability[0];
  }
  for (Eigen::Index i = 0; i < errors.rows(); ++i) {
    const double mean = errors.row(i).mean();
    const double variance = (errors.row(i).array() - mean).square().sum() / (kRuns - 1);
    EXPECT_LT(std::abs(mean), 5.6 * std::sqrt(variance / kRuns) + 1e-12) << i;
  }
}

TEST(MarginalFilter, IsUnbiased) { expect_unbiased<MarginalFilter>(20); }
TEST(BootstrapFilter, IsUnbiased) { expect_unbiased<BootstrapFilter>(scaled(20'000)); }

TEST(BootstrapFilter, SameStreamSameParticles) {
  BootstrapFilter one(two_modes(), kStart, Eigen::Vector2d(0.5, 0.5), 100, RandomStream(3));
  BootstrapFilter same(two_modes(), kStart, Eigen::Vector2d(0.5, 0.5), 100, RandomStream(3));
  BootstrapFilter other(two_modes(), kStart, Eigen::Vector2d(0.5, 0.5), 100, RandomStream(4));
  for (const Vector2& z : plots(20)) {
    for (BootstrapFilter* filter : {&one, &same, &other}) {
      filter->predict();
      ASSERT_EQ(filter->update(kSensor, z), Numerics::kOk);
    }
  }
  EXPECT_EQ(combined_mean(one.estimate()), combined_mean(same.estimate()));
  EXPECT_NE(combined_mean(one.estimate()), combined_mean(other.estimate()));
}

// A plot that is not finite is refused, and the belief stays as it was.
template <class Filter>
void expect_contained() {
  Filter filter(two_modes(), kStart, Eigen::Vector2d(0.5, 0.5), 100, RandomStream(3));
  filter.predict();
  const State before = combined_mean(filter.estimate());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(filter.update(kSensor, {nan, 0.0}), Numerics::kOk);
  EXPECT_NE(filter.update(kSensor, {std::numeric_limits<double>::infinity(), 0.0}), Numerics::kOk);
  EXPECT_EQ(combined_mean(filter.estimate()), before);
}

TEST(MarginalFilter, RefusesPlotsThatAreNotFinite) { expect_contained<MarginalFilter>(); }
TEST(BootstrapFilter, RefusesPlotsThatAreNotFinite) { expect_contained<BootstrapFilter>(); }

// Each stands for floor or ceil of count w.
TEST(Resampling, SystematicCountsAreTheWeights) {
  RandomStream stream(1);
  const std::vector<double> weight{0.05, 0.35, 0.0, 0.6};
  Survivors out;
  std::vector<double> mean(4, 0.0);
  const int trials = scaled(20'000);
  for (int trial = 0; trial < trials; ++trial) {
    resample_systematically(weight, 10, stream, out);
    std::vector<int> counts(4, 0);
    for (const std::size_t i : out.index) ++counts[i];
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_LE(std::abs(counts[i] - 10.0 * weight[i]), 1.0) << i;
      mean[i] += counts[i];
    }
  }
  EXPECT_TRUE(statistics::binomial_band(trials, 0.5).contains(mean[0])) << mean[0];
}

// Never more than asked; unbiased; what is heavier than the threshold stays as it is.
TEST(Resampling, OptimalKeepsTheHeavyAndIsUnbiased) {
  RandomStream stream(2);
  const std::vector<double> weight{0.4, 0.02, 0.3, 0.08, 0.1, 0.06, 0.04};
  // Three: the two heavy ones and, of the rest, .3, one with c = .3: the second is no more than that.
  // c = (.02 + .08 + .1 + .06 + .04 + .3) / 2 = .3, and .3 is not over it.
  Survivors out;
  std::vector<double> mean(7, 0.0);
  std::vector<int> kept(7, 0);
  const int trials = scaled(50'000);
  for (int trial = 0; trial < trials; ++trial) {
    resample_optimally(weight, 3, stream, out);
    ASSERT_LE(out.index.size(), 3U);
    for (std::size_t k = 0; k < out.index.size(); ++k) {
      mean[out.index[k]] += out.weight[k] / trials;
      ++kept[out.index[k]];
    }
  }
  EXPECT_EQ(kept[0], trials);
  EXPECT_NEAR(mean[0], 0.4, 1e-9);
  for (std::size_t i = 3; i < 7; ++i) {
    EXPECT_TRUE(statistics::binomial_band(trials, weight[i] / 0.3).contains(kept[i])) << i << ": " << kept[i];
    EXPECT_NEAR(mean[i], 0.3 * kept[i] / trials, 1e-9);
  }
}

TEST(Resampling, OptimalKeepsAllWhereThereIsRoom) {
  RandomStream stream(2);
  const std::vector<double> weight{0.5, 0.2, 0.3};
  Survivors out;
  resample_optimally(weight, 3, stream, out);
  EXPECT_EQ(out.weight, weight);
  EXPECT_EQ(out.index, (std::vector<std::size_t>{0, 1, 2}));
}

}  // namespace
}  // namespace dwell
