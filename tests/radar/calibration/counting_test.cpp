#include "radar/calibration/counting.hpp"

#include <gtest/gtest.h>

namespace dwell::testing {
namespace {

TEST(DetectionCount, IsTheConfiguredFigureBeforeTheFirstLook) {
  EXPECT_DOUBLE_EQ(DetectionCount().scale(), 1.0);
  // Beta with mean .9 and the weight of 2 looks.
  EXPECT_DOUBLE_EQ(DetectionCount().standard_error(0.9), std::sqrt(0.9 * 0.1 / (2.0 + 1.0)));
}

TEST(DetectionCount, IsTheBetaPosteriorMeanWithForgetting) {
  // Three looks at P_d .5, seen, missed, seen; a = .5 w + sum g^. d, a + b = w + sum g^., w = 2.
  DetectionCount count;
  for (const bool seen : {true, false, true}) count.add(seen, 0.5);
  const double g = DetectionCount::kForgetting;
  const double a = 1.0 + g * g + 1.0;
  const double looks = 2.0 + g * g + g + 1.0;
  EXPECT_NEAR(0.5 * count.scale(), a / looks, 1e-15);
}

TEST(ClutterCount, IsTheGammaPosteriorMeanWithForgetting) {
  ClutterCount count;
  EXPECT_DOUBLE_EQ(count.density(3e-3), 3e-3);
  EXPECT_DOUBLE_EQ(count.standard_error(3e-3), 0.0);
  // Two looks of 1000; the prior: 2 looks of 1000 with 3 plots each.
  count.add(7, 1000.0);
  count.add(4, 1000.0);
  const double g = DetectionCount::kForgetting;
  const double plots = 2.0 * 3.0 + g * 7.0 + 4.0;
  const double volume = 2.0 * 1000.0 + g * 1000.0 + 1000.0;
  EXPECT_NEAR(count.density(3e-3), plots / volume, 1e-15);
  EXPECT_NEAR(count.standard_error(3e-3), std::sqrt(plots + 0.5) / volume, 1e-15);
}

TEST(ClutterCount, ARadarWithoutFalsePlotsStaysOne) {
  ClutterCount count;
  for (int look = 0; look < 10; ++look) count.add(0, 1000.0);
  EXPECT_EQ(count.density(0.0), 0.0);
  EXPECT_GT(count.standard_error(0.0), 0.0);
}

}  // namespace
}  // namespace dwell::testing
