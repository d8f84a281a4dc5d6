#include "bandit/index.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "bandit/restless/covariance.hpp"
#include "tests/bandit/scene.hpp"

namespace dwell::testing {
namespace {

/// A sensor of position with the given axes, tracks of constant velocity that differ in their covariances.
Scene two_axes_scene() {
  Scene scene;
  const auto sensor = [&](double large, double small, double p_detect) {
    const Matrix2 r = Vector2(large, small).asDiagonal();
    scene.add_sensor(std::make_shared<LinearSensor>(position_selector(), r, p_detect));
  };
  sensor(100.0, 3.0, 1.0);
  sensor(20.0, 800.0, 0.9);
  RandomStream stream(11);
  for (std::uint32_t number = 1; number <= 5; ++number) {
    StateMatrix p = StateMatrix::Zero();
    for (int i = 0; i < kStateSize; ++i) p(i, i) = std::exp(stream.uniform(0.0, 4.0));
    scene.add_track(number, make_estimate({State::Zero(), p}, Eigen::VectorXd::Ones(1)));
  }
  scene.bank = plain_bank(1);
  return scene;
}

/// Decisions until the first that the index makes itself.
int decisions_to_answer(Index& index, Scene& scene, Decision& decision) {
  for (int made = 1; made <= 50; ++made) {
    index.decide(scene.situation(), decision);
    if (!decision.fell_back) return made;
    EXPECT_EQ(decision.answered_by, "orbit");
    EXPECT_FALSE(decision.relaxed);
  }
  return 0;
}

/// Asked for in the first decision, when the orbit index gives the first price, and used kDelay decisions later.
TEST(Index, AnswersItselfAFixedNumberOfDecisionsAfterItAsked) {
  Scene scene = two_axes_scene();
  Index index(IndexSettings{});
  Decision decision;
  EXPECT_EQ(decisions_to_answer(index, scene, decision), 2 + Index::kDelay);
  ASSERT_TRUE(decision.relaxed);
  EXPECT_GT(decision.relaxed->price, 0.0);
  EXPECT_GT(decision.relaxed->reference, 0.0);
}

TEST(Index, ScoresAreTheSumOfTheirParts) {
  for (const int depth : {1, 2}) {
    Scene scene = random_scene(5, 2);
    Index index(IndexSettings{depth});
    Decision decision;
    ASSERT_GT(decisions_to_answer(index, scene, decision), 0);
    for (const Candidate& candidate : decision.candidates) {
      ASSERT_TRUE(candidate.parts);
      const double sum = candidate.parts->gain_now + candidate.parts->value_later - candidate.parts->price;
      EXPECT_NEAR(candidate.score, sum, 1e-9 * (std::abs(candidate.parts->gain_now) + candidate.parts->price));
    }
  }
}

/// Without a builder nothing that is due is there: orbits answer, and every set is noted as late.
TEST(Index, GoesOnByOrbitsWhileItsSetsAreLate) {
  Scene scene = two_axes_scene();
  ValueTable table(ValueTable::OnDue::kGoOn);
  Situation situation = scene.situation();
  situation.value_table = &table;
  Index index(IndexSettings{});
  Decision decision;
  for (int scan = 0; scan < 3 * Index::kDelay; ++scan) {
    index.decide(situation, decision);
    EXPECT_TRUE(decision.fell_back);
  }
  EXPECT_FALSE(table.take_late().empty());
  EXPECT_TRUE(table.take_late().empty());
}

/// What was late in one run is late in its repetition: the same decisions. A builder that is too slow, without a
/// thread.
TEST(Index, DecidesTheSameWhereTheSameSetsAreLate) {
  constexpr int kScans = 200;
  Scene scene = two_axes_scene();
  Situation situation = scene.situation();
  ValueTable slow(ValueTable::OnDue::kGoOn);
  ValueTable repeated;
  Index first(IndexSettings{});
  Index second(IndexSettings{});
  Decision decision;
  Decision again;
  int late_scans = 0;
  int answered = 0;
  for (int scan = 0; scan < kScans; ++scan) {
    situation.value_table = &slow;
    first.decide(situation, decision);
    if (scan % 3 == 0 && slow.waiting() > 0) slow.build_next();
    const std::vector<std::uint64_t> late = slow.take_late();
    if (!late.empty()) ++late_scans;
    if (!decision.fell_back) ++answered;
    situation.value_table = &repeated;
    repeated.expect_late(late);
    second.decide(situation, again);
    EXPECT_EQ(again.chosen, decision.chosen) << scan;
    EXPECT_EQ(again.candidates[0].score, decision.candidates[0].score) << scan;
  }
  EXPECT_GT(late_scans, 0);
  EXPECT_GT(answered, 0);
}

TEST(ValueBucket, PlacesAreInterpolatedBetweenTheCornersOfTheirCell) {
  BucketPlace place;
  place.q = -3.75;
  place.price = 4.5;
  place.cell.q = -4;
  place.cell.price = 4;
  EXPECT_EQ(corner_weights(place), (std::array{0.375, 0.125, 0.375, 0.125}));
  EXPECT_EQ(corner_of(place.cell, 3).q, -3);
  EXPECT_EQ(corner_of(place.cell, 3).price, 5);
}

/// Average cost of looks with one sensor, or both in turn, every so many scans: the best.
double best_periodic_total(const restless::Arm& arm, double price) {
  double best = std::numeric_limits<double>::infinity();
  const auto follow = [&](int wait, std::size_t first, std::size_t step) {
    constexpr int kSettled = 12, kCounted = 4;  // turns
    restless::Matrix p = arm.p0;
    double cost = 0.0;
    for (int turn = 0; turn < kSettled + kCounted; ++turn) {
      if (turn == kSettled) cost = 0.0;
      for (int scan = 1; scan < wait; ++scan) {
        cost += restless::scan_cost(arm, p);
        p = restless::predict(arm, p);
      }
      const std::size_t sensor = (first + step * static_cast<std::size_t>(turn)) % arm.sensors.size();
      p = restless::look_update(arm.sensors[sensor], p).covariance;
      cost += restless::scan_cost(arm, p) + price;
      p = restless::predict(arm, p);
    }
    best = std::min(best, cost / (kCounted * wait));
  };
  for (int wait = 1; wait <= 100; ++wait) {
    for (std::size_t first = 0; first < arm.sensors.size(); ++first) {
      for (const std::size_t step : {0, 1}) follow(wait, first, step);
    }
  }
  return best;
}

/// Also where waits are long. The sets merge covariances within 3 % and keep at most 500: what that costs them.
TEST(ValueBucket, SetsAreAsGoodAsPeriodicLooks) {
  for (const int q : {-12, -8, 0}) {
    for (const int price : {2, 8, 14}) {
      for (const bool other : {false, true}) {
        BucketKey key;
        key.q = static_cast<std::int8_t>(q);
        key.price = static_cast<std::int8_t>(price);
        key.flat = -2;
        if (other) {
          key.size = 1;
          key.other_flat = -2;
          key.angle = 1;
        }
        const PricedBucket set = solve_bucket(key);
        const double total = set.cost + set.price * set.rate;
        EXPECT_LE(total, 1.03 * best_periodic_total(arm_of(key), price_of(key))) << q << ' ' << price << ' ' << other;
      }
    }
  }
}

TEST(ValueBucket, KeysAreNumbers) {
  BucketKey key;
  EXPECT_NE(key.packed(), 0U);
  for (const int q : {-100, -1, 0, 1, 101}) {
    for (const int price : {-100, 0, 101}) {
      key = {static_cast<std::int8_t>(q), static_cast<std::int8_t>(price), -7, BucketKey::kAlone, -3, 2};
      EXPECT_EQ(BucketKey::unpacked(key.packed()), key);
    }
  }
}

TEST(ValueTable, GivesEveryThreadTheSameSet) {
  ValueTable table;
  BucketKey key;
  key.price = 3;
  SharedBucket seen;
  std::thread reader([&] { seen = table.due(key); });
  const SharedBucket mine = table.due(key);
  reader.join();
  EXPECT_EQ(seen, mine);
  EXPECT_EQ(table.due(key), mine);
}

TEST(ValueTable, WhatIsNotBuiltIsLate) {
  ValueTable table(ValueTable::OnDue::kGoOn);
  BucketKey key;
  key.price = 3;
  table.ask(key);
  table.ask(key);
  EXPECT_EQ(table.due(key), nullptr);
  EXPECT_EQ(table.take_late(), std::vector{key.packed()});
  EXPECT_TRUE(table.build_next());
  EXPECT_EQ(table.due(key), nullptr);  // in this scan, whoever asks
  table.begin_scan();
  EXPECT_NE(table.due(key), nullptr);
  EXPECT_TRUE(table.take_late().empty());
  table.stop();
  EXPECT_FALSE(table.build_next());  // asked for twice, built once
}

}  // namespace
}  // namespace dwell::testing
