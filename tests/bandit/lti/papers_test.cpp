// Every figure of the papers' examples, as reproduced independently under the conventions of bandit/lti/README.md.
// The figures have 15 digits; the sums lose three or four of sixteen to the order of the operations.

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "bandit/lti/catalogue.hpp"
#include "bandit/lti/search_tree.hpp"
#include "tests/bandit/lti/problems.hpp"

namespace dwell::lti {
namespace {

constexpr double kDigits = 1e-12;

#define EXPECT_COST(solution, figure) EXPECT_NEAR((solution).cost, figure, kDigits*(figure))

TEST(Chung, OneSensorAlone) {
  EXPECT_COST(fixed(chung(), {1}), 0.935735092095736);
  EXPECT_COST(fixed(chung(), {2}), 0.751210466486798);
}

TEST(Chung, ThePrintedSchedule) {
  EXPECT_COST(evaluate(chung(), schedule_of("11121112111211121112")), 0.68545231281807);
}

TEST(Chung, TheWindow) {
  EXPECT_COST(window(chung(), {1}), 0.582617159292125);
  const Solution four = window(chung(), {4});
  EXPECT_COST(four, 0.578845065317272);
  EXPECT_EQ(digits_of(four.schedule), "12122122122122122122");
}

TEST(Chung, TheOptimum) {
  const Solution best = optimum(chung());
  EXPECT_COST(best, 0.578845065317272);
  EXPECT_EQ(digits_of(best.schedule), "12122122122122122122");
}

TEST(Chung, ThresholdingFindsTheOptimumAtASmallFactor) { EXPECT_COST(threshold(chung(), {1.05}), 0.578845065317272); }

// The printed 42 % of a window of one over sensor 2 comes out with sensors 1 and 2 swapped and P[0] = 0: 42.0.
TEST(Chung, TheImprovementPrintedNeedsSwappedLabels) {
  Problem problem = chung();
  problem.initial.setZero();
  std::swap(problem.sensors[0], problem.sensors[1]);
  const double alone = fixed(problem, {2}).cost;
  EXPECT_NEAR(1.0 - window(problem, {1}).cost / alone, 0.420, 0.0005);
}

// Figure 5: the gain of the printed schedule over sensor 2 falls as the noise of the link grows.
TEST(Chung, CommunicationNoiseTakesTheGainOfSwitchingAway) {
  double last = 1.0;
  for (const double noise : {0.0, 1e-4, 1e-3, 3e-3, 1e-2}) {
    const Problem problem = chung(noise);
    const double gain = 1.0 - evaluate(problem, schedule_of("11121112111211121112")).cost / fixed(problem, {2}).cost;
    EXPECT_LT(gain, last);
    last = gain;
  }
  EXPECT_LT(last, 0.5 * 0.0875);  // half of what it was without noise, 1 - 0.6855 / 0.7512
}

TEST(Gupta, SensorOneAlone) { EXPECT_COST(fixed(gupta(), {1}), 101.656893043575); }

TEST(Gupta, TheWindow) {
  EXPECT_COST(window(gupta(), {1}), 70.6712684547109);
  EXPECT_COST(window(gupta(), {3}), 70.5657678216804);
}

TEST(Gupta, Thresholding) {
  EXPECT_COST(threshold(gupta(), {1.001}), 70.5657678216804);
  EXPECT_COST(threshold(gupta(), {1.005}), 70.5643540213715);
}

TEST(Gupta, TheOptimum) {
  const Solution best = optimum(gupta());
  EXPECT_COST(best, 70.5643540213715);
  EXPECT_EQ(digits_of(best.schedule), "131313213212312");
}

TEST(Gupta, TheOptimalProbabilitiesAndTheirBound) {
  const Solution random = random_choice(gupta(), {}, RandomStream(7).fork("schedule"));
  ASSERT_EQ(random.probabilities.size(), 3U);
  // Five digits are given.
  EXPECT_NEAR(random.probabilities[0], 0.45065, 5e-6);
  EXPECT_NEAR(random.probabilities[1], 0.32392, 5e-6);
  EXPECT_NEAR(random.probabilities[2], 0.22543, 5e-6);
  ASSERT_TRUE(random.bound.has_value());
  EXPECT_NEAR(*random.bound, 2.5090032515, 1e-10);
}

/// Mean cost of a step under a word repeated for ever.
double average_cost(const Problem& problem, const std::string& word) {
  Riccati riccati(problem);
  std::vector<double> covariance = riccati.initial();
  double last = 0.0;
  for (int turn = 0;; ++turn) {
    double sum = 0.0;
    for (const int sensor : schedule_of(word)) {
      riccati.step(covariance.data(), sensor, covariance.data());
      sum += trace_weight(problem) * riccati.trace(covariance.data()) / static_cast<double>(word.size());
    }
    // A word of one sensor is forgotten slowest, by half in 15 steps: what is left is about what last changed.
    if (turn > 10 && std::abs(sum - last) < 1e-13 * sum) return sum;
    last = sum;
  }
}

TEST(Gupta, TheBestPeriodicScheduleOfPeriodUpToNine) {
  const Problem problem = gupta();
  double least = 1e300;
  std::string best;
  for (std::size_t period = 1; period <= 9; ++period) {
    std::string word(period, '1');
    for (;;) {
      // Of all rotations the first in order stands for them.
      std::string rotation = word;
      bool first = true;
      for (std::size_t shift = 1; shift < period && first; ++shift) {
        std::rotate(rotation.begin(), rotation.begin() + 1, rotation.end());
        first = word <= rotation;
      }
      if (const double cost = first ? average_cost(problem, word) : least; cost < least * (1.0 - 1e-10)) {
        least = cost;
        best = word;
      }
      const std::size_t place = word.find_last_not_of('3');
      if (place == std::string::npos) break;
      ++word[place];
      std::fill(word.begin() + static_cast<std::ptrdiff_t>(place) + 1, word.end(), '1');
    }
  }
  EXPECT_EQ(best, "12313");
  EXPECT_NEAR(least, 2.1942689126, 1e-10);
}

struct Relaxed {
  double r;
  std::size_t sets;
  int second_sensor;
  double trace_50;
  double trace_14;
};

class Alriksson : public ::testing::TestWithParam<Relaxed> {};

INSTANTIATE_TEST_SUITE_P(Papers, Alriksson,
                         ::testing::Values(Relaxed{10.0, 3, 32, 32.8766460016921, 32.8102821687186},
                                           Relaxed{50.0, 4, 36, 39.3436694032755, 39.111771625112},
                                           Relaxed{110.0, 5, 39, 43.8557219109654, 43.6001268519911}));

TEST_P(Alriksson, RelaxedDynamicProgramming) {
  const Solution solution = relaxed_dp(alriksson(GetParam().r, 50), {1.01});
  EXPECT_NEAR(solution.final_trace, GetParam().trace_50, kDigits * GetParam().trace_50);
  ASSERT_EQ(solution.set_sizes.size(), 50U);
  EXPECT_EQ(solution.set_sizes.back(), GetParam().sets);
  EXPECT_EQ(std::count(solution.schedule.begin(), solution.schedule.end(), 2), GetParam().second_sensor);
}

TEST_P(Alriksson, TheExactOptimumOfFourteenSteps) {
  const Problem problem = alriksson(GetParam().r, 14);
  const double least = enumerated_minimum(problem).final_trace;
  EXPECT_NEAR(least, GetParam().trace_14, kDigits * least);
  EXPECT_NEAR(optimum(problem).final_trace, least, kDigits * least);
}

TEST_P(Alriksson, TheGuaranteeOverFiftySteps) {
  const Problem problem = alriksson(GetParam().r, 50);
  const double best = optimum(problem).final_trace;
  EXPECT_LE(GetParam().trace_50, 1.01 * 1.01 * best);
  EXPECT_GE(GetParam().trace_50, best);
}

// "Sensor 2 is not used at all for a value of r > 104": of 10^4.
TEST(AlrikssonText, AVeryNoisySensorIsNotUsed) {
  EXPECT_EQ(relaxed_dp(alriksson(2e4, 50), {1.01}).schedule, std::vector<int>(50, 1));
  const std::vector<int> used = relaxed_dp(alriksson(105.0, 50), {1.01}).schedule;
  EXPECT_GT(std::count(used.begin(), used.end(), 2), 0);
}

}  // namespace
}  // namespace dwell::lti
