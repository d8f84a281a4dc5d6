#include "tracker/joint_association.hpp"

#include <map>
#include <span>
#include <utility>
#include <vector>

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

// --- pruned events

/// The best weight of every (tracks that have a plot, plots that are had), and which plot the track itself has in it.
struct Best {
  double weight = 0.0;
  std::size_t mine = 0;  // plot + 1; 0: none
};
using Dealt = std::map<std::pair<std::vector<bool>, std::vector<bool>>, Best>;

/// Row 0 of `ratio` is the track itself.
void deal(const std::vector<double>& ratio, std::size_t plots, std::size_t track, std::vector<bool>& tracks,
          std::vector<bool>& taken, const Best& so_far, Dealt& dealt) {
  if (track == tracks.size()) {
    Best& best = dealt[{tracks, taken}];
    if (so_far.weight > best.weight) best = so_far;
    return;
  }
  deal(ratio, plots, track + 1, tracks, taken, so_far, dealt);
  for (std::size_t i = 0; i < plots; ++i) {
    if (taken[i]) continue;
    taken[i] = tracks[track] = true;
    const Best next{so_far.weight * ratio[track * plots + i], track == 0 ? i + 1 : so_far.mine};
    deal(ratio, plots, track + 1, tracks, taken, next, dealt);
    taken[i] = tracks[track] = false;
  }
}

TEST(PrunedEvents, EqualEnumeration) {
  RandomStream stream(2);
  JointAssociation joint;
  for (std::size_t rivals = 0; rivals <= 3; ++rivals) {
    for (std::size_t plots = 1; plots <= 5; ++plots) {
      std::vector<double> ratio((rivals + 1) * plots);
      for (double& r : ratio) r = stream.uniform() < 0.3 ? 0.0 : std::exp(stream.uniform(-5.0, 5.0));
      std::vector<double> factor(plots);
      const std::span<const double> rows(ratio);
      joint.solve_pruned(rows.first(plots), rows.subspan(plots), rivals, factor);
      std::vector<bool> tracks(rivals + 1), taken(plots);
      Dealt dealt;
      deal(ratio, plots, 0, tracks, taken, {1.0, 0}, dealt);
      std::vector<double> sum(plots + 1, 0.0);
      for (const auto& [who, best] : dealt) sum[best.mine] += best.weight;
      for (std::size_t i = 0; i < plots; ++i) {
        const double expected = ratio[i] > 0.0 ? sum[i + 1] / (ratio[i] * sum[0]) : 1.0;
        EXPECT_NEAR(factor[i], expected, 1e-12 * expected) << rivals << " rivals, plot " << i << " of " << plots;
      }
    }
  }
}

// Mine a, b and the rival's c, d. Of the two ways to have both plots a d is likelier than b c: plot 1 is mine by a + a
// d, plot 2 by b alone, none by 1 + c + d.
TEST(PrunedEvents, TwoTracksByHand) {
  JointAssociation joint;
  std::vector<double> factor(2);
  joint.solve_pruned(std::vector<double>{4.0, 3.0}, std::vector<double>{2.0, 5.0}, 1, factor);
  EXPECT_DOUBLE_EQ(factor[0], (1.0 + 5.0) / 8.0);
  EXPECT_DOUBLE_EQ(factor[1], 1.0 / 8.0);
}

// Eight tracks that may each have any of twelve plots have some hundred million events: all of them are kept.
TEST(PrunedEvents, TooManyAreNotPruned) {
  JointAssociation joint;
  const std::vector<double> own(12, 0.5);
  const std::vector<double> ratio(7 * 12, 0.5);
  std::vector<double> pruned(12), all(12);
  joint.solve_pruned(own, ratio, 7, pruned);
  joint.solve(ratio, 7, all);
  EXPECT_EQ(pruned, all);
}

}  // namespace
}  // namespace dwell
