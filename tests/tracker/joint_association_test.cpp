#include "tracker/joint_association.hpp"

#include <gtest/gtest.h>

#include "radar/random.hpp"
#include "tests/tracker/matrices.hpp"

namespace dwell {
namespace {

/// The sum over assignments of rivals s, s + 1, .. to plots that are free, by enumeration rival by rival.
double enumerate(const std::vector<double>& ratio, std::size_t rivals, std::size_t plots, std::size_t s,
                 std::vector<bool>& taken) {
  if (s == rivals) return 1.0;
  double sum = enumerate(ratio, rivals, plots, s + 1, taken);
  for (std::size_t i = 0; i < plots; ++i) {
    if (taken[i]) continue;
    taken[i] = true;
    sum += ratio[s * plots + i] * enumerate(ratio, rivals, plots, s + 1, taken);
    taken[i] = false;
  }
  return sum;
}

// Sums of positive terms: the rounding is that of some hundred additions and products.
TEST(JointAssociation, EqualsEnumeration) {
  RandomStream stream(1);
  JointAssociation joint;
  for (std::size_t rivals = 0; rivals <= 4; ++rivals) {
    for (std::size_t plots = 0; plots <= 6; ++plots) {
      std::vector<double> ratio(rivals * plots);
      for (double& r : ratio) r = stream.uniform() < 0.3 ? 0.0 : std::exp(stream.uniform(-10.0, 10.0));
      std::vector<double> factor(plots);
      joint.solve(ratio, rivals, factor);
      std::vector<bool> taken(plots, false);
      const double all = enumerate(ratio, rivals, plots, 0, taken);
      for (std::size_t i = 0; i < plots; ++i) {
        taken[i] = true;
        const double free = enumerate(ratio, rivals, plots, 0, taken);
        taken[i] = false;
        EXPECT_NEAR(factor[i], free / all, 1e-13 * (free / all)) << rivals << " rivals, plot " << i << " of " << plots;
      }
    }
  }
}

// One rival with ratios a and b: Z = 1 + a + b, and 1 + b with the first plot mine.
TEST(JointAssociation, OneRivalByHand) {
  JointAssociation joint;
  std::vector<double> factor(2);
  joint.solve(std::vector<double>{3.0, 0.5}, 1, factor);
  EXPECT_DOUBLE_EQ(factor[0], 1.5 / 4.5);
  EXPECT_DOUBLE_EQ(factor[1], 4.0 / 4.5);
}

TEST(JointAssociation, WhatNobodyElseCanTakeIsAllMine) {
  JointAssociation joint;
  std::vector<double> factor(3);
  joint.solve(std::vector<double>{0.0, 2.0, 0.0, 0.0, 5.0, 0.0}, 2, factor);
  EXPECT_EQ(factor[0], 1.0);
  EXPECT_DOUBLE_EQ(factor[1], 1.0 / 8.0);
  EXPECT_EQ(factor[2], 1.0);
}

}  // namespace
}  // namespace dwell
