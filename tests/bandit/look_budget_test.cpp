#include "bandit/look_budget.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "radar/random.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

using Span = BudgetSettings::Span;
using Spread = BudgetSettings::Spread;

/// Scans, from 1, in which a sensor looks that always looks when it may.
std::vector<int> looks_of_the_greedy(const BudgetSettings& settings, int scans) {
  LookBudget budget(settings);
  std::vector<int> looks;
  for (int scan = 1; scan <= scans; ++scan) {
    budget.next_scan();
    if (!budget.allows()) continue;
    budget.take();
    looks.push_back(scan);
  }
  return looks;
}

TEST(LookBudget, WithoutALimitAllowsEverything) {
  LookBudget budget;
  EXPECT_FALSE(budget.limited());
  for (int scan = 0; scan < 10; ++scan) {
    budget.next_scan();
    EXPECT_TRUE(budget.allows());
    EXPECT_TRUE(budget.allows(15, 0x7fff));
    budget.take();
  }
}

TEST(LookBudget, SpreadEvenlyTheGreedyLooksAtEverySixthScan) {
  std::vector<int> every_sixth;
  for (int scan = 1; scan <= 120; scan += 6) every_sixth.push_back(scan);
  EXPECT_EQ(looks_of_the_greedy({10, 60, Span::kHorizon, Spread::kEven}, 120), every_sixth);
  EXPECT_EQ(looks_of_the_greedy({10, 60, Span::kWindow, Spread::kEven}, 120), every_sixth);
}

TEST(LookBudget, LeftFreeTheGreedyLooksAtOnce) {
  EXPECT_EQ(looks_of_the_greedy({3, 10, Span::kHorizon, Spread::kFree}, 20), (std::vector{1, 2, 3, 11, 12, 13}));
  EXPECT_EQ(looks_of_the_greedy({3, 10, Span::kWindow, Spread::kFree}, 20), (std::vector{1, 2, 3, 11, 12, 13}));
}

/// 3 looks in 10 scans: the second is due when 3 k > 10, the third when 3 k > 20.
TEST(LookBudget, UnevenSharesAreRoundedUp) {
  EXPECT_EQ(looks_of_the_greedy({3, 10, Span::kHorizon, Spread::kEven}, 20), (std::vector{1, 4, 7, 11, 14, 17}));
}

TEST(LookBudget, WhatWasNotTakenStaysDue) {
  LookBudget budget({2, 10, Span::kHorizon, Spread::kEven});
  for (int scan = 1; scan <= 5; ++scan) budget.next_scan();
  EXPECT_TRUE(budget.allows());  // due since scan 1
  budget.take();
  EXPECT_FALSE(budget.allows());
  EXPECT_EQ(budget.left(), 1);
  budget.next_scan();  // scan 6: the second is due
  EXPECT_TRUE(budget.allows());
  budget.take();
  EXPECT_EQ(budget.left(), 0);
  for (int scan = 7; scan <= 10; ++scan) {
    budget.next_scan();
    EXPECT_FALSE(budget.allows());
  }
  budget.next_scan();  // another horizon
  EXPECT_EQ(budget.left(), 2);
  EXPECT_TRUE(budget.allows());
}

class RandomBudget : public ::testing::TestWithParam<int> {
 protected:
  RandomBudget() : stream_(static_cast<std::uint64_t>(GetParam())) {
    settings_.scans = 2 + static_cast<int>(stream_.uniform(0.0, 20.0));
    settings_.looks = 1 + static_cast<int>(stream_.uniform(0.0, settings_.scans - 1.0));
    settings_.span = GetParam() % 2 == 0 ? Span::kWindow : Span::kHorizon;
    settings_.spread = GetParam() / 2 % 2 == 0 ? Spread::kEven : Spread::kFree;
  }

  RandomStream stream_;
  BudgetSettings settings_;
};

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBudget, ::testing::Range(0, 40));

/// By definition, counted anew from the scans of the looks.
TEST_P(RandomBudget, IsNeverExceededAndNeverHoldsBackWhatIsLeft) {
  LookBudget budget(settings_);
  std::vector<int> looks;
  for (int scan = 1; scan <= 300; ++scan) {
    budget.next_scan();
    const int first = settings_.span == Span::kWindow ? scan - settings_.scans + 1
                                                      : (scan - 1) / settings_.scans * settings_.scans + 1;
    const auto taken = std::count_if(looks.begin(), looks.end(), [&](int look) { return look >= first; });
    ASSERT_EQ(budget.left(), settings_.looks - taken);
    if (taken == settings_.looks) {
      EXPECT_FALSE(budget.allows());
    }
    if (taken < settings_.looks && settings_.spread == Spread::kFree) {
      EXPECT_TRUE(budget.allows());
    }
    if (settings_.span == Span::kHorizon && settings_.spread == Spread::kEven) {
      EXPECT_EQ(budget.allows(), taken * settings_.scans < settings_.looks * (scan - first + 1));
    }
    if (!budget.allows() || stream_.uniform() < 0.4) continue;
    budget.take();
    looks.push_back(scan);
  }
}

TEST_P(RandomBudget, PlansWhatWillBeAllowed) {
  LookBudget now(settings_);
  for (int scan = 0; scan < 100; ++scan) {
    now.next_scan();
    LookBudget then = now;
    LookBudget::Plan plan = 0;
    for (int ahead = 0; ahead < LookBudget::kPlannedScans; ++ahead) {
      if (ahead > 0) then.next_scan();
      ASSERT_EQ(now.allows(ahead, plan), then.allows()) << "scan " << scan << ", ahead " << ahead;
      if (!then.allows() || stream_.uniform() < 0.5) continue;
      then.take();
      plan = static_cast<LookBudget::Plan>(plan | (1U << ahead));
    }
    if (now.allows() && stream_.uniform() < 0.5) now.take();
  }
}

}  // namespace
}  // namespace dwell::testing
