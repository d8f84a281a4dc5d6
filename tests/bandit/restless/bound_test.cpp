#include "bandit/restless/bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "bandit/restless/covariance.hpp"
#include "bandit/restless/mechanical_word.hpp"
#include "bandit/restless/priced_arm.hpp"
#include "bandit/restless/scalar_arm.hpp"
#include "bandit/restless/scalar_mesh.hpp"
#include "bandit/restless/simulate.hpp"
#include "radar/random.hpp"
#include "tests/bandit/restless/instances.hpp"

namespace dwell::restless::testing {
namespace {

/// Scan t of `length` has a look where bit t of `looks` is set; again and again. By the Riccati recursion: thirty turns
/// and more forget the start to rounding.
PricedValue repeated(const Arm& arm, unsigned looks, int length) {
  constexpr int kTurns = 40;
  PricedValue mean;
  Matrix p = arm.p0;
  for (int turn = 0; turn < kTurns; ++turn) {
    mean = {};
    for (int t = 0; t < length; ++t) {
      const bool look = ((looks >> t) & 1u) != 0;
      const Matrix after = look ? look_update(arm.sensors.front(), p).covariance : p;
      mean.cost += scan_cost(arm, after) / length;
      mean.usage += look ? arm.dwell / length : 0.0;
      p = predict(arm, after);
    }
  }
  return mean;
}

/// Values of an independent program, given to 10 digits; both maximise over the price to 1e-9.
TEST(LagrangianBound, EqualsTheReferenceValues) {
  EXPECT_NEAR(analyse(s2a()).bound.value, 1.9348726036, 2e-9);
  EXPECT_NEAR(analyse(s4a()).bound.value, 6.241416352, 1e-8);
  EXPECT_NEAR(analyse(s4b()).bound.value, 7.7213190326, 1e-8);
}

/// The long run does not know where it started.
TEST(LagrangianBound, OfTheAverageCostIsTheSameFromEveryStart) {
  for (const double p0 : {0.0, 1e-9, 1e-6, 1e6}) {
    Problem problem = s2a();
    for (Arm& arm : problem.arms) arm.p0(0, 0) = p0;
    const Bound bound = analyse(problem, {.values = false}).bound;
    EXPECT_EQ(bound.kind, BoundKind::kExact);
    EXPECT_NEAR(bound.value, 1.9348726036, 2e-9) << "p0 " << p0;
  }
}

TEST(LagrangianBound, OfArmsThatCostNothingIsNothing) {
  Problem problem = s2a();
  for (Arm& arm : problem.arms) arm.weight = 0.0;
  const Bound bound = analyse(problem, {.values = false}).bound;
  EXPECT_EQ(bound.kind, BoundKind::kExact);
  EXPECT_EQ(bound.value, 0.0);
}

/// The first scan of an arm that starts well known, far below the process noise, costs next to nothing. Four standard
/// errors: a true bound fails once in 30 000.
TEST(CertifiedBound, IsBelowWhatIsAchievedFromAnyStart) {
  RandomStream random(5);
  for (int trial = 0; trial < 6; ++trial) {
    Problem problem;
    problem.discount = random.uniform(0.3, 0.8);
    for (int i = 0; i < 2; ++i) {
      const double q = std::exp(random.uniform(0.0, 3.0));
      problem.arms.push_back(scalar_arm_of(random.uniform(0.3, 1.0), q, std::exp(random.uniform(-1.0, 2.0)), 1.0,
                                           random.uniform(0.5, 0.95)));
      problem.arms.back().p0(0, 0) = q * std::pow(10.0, random.uniform(-6.0, -1.0));
    }
    if (trial == 0) problem.arms.back().p0(0, 0) = 0.0;
    const Analysis analysis = analyse(problem, {.values = false});
    EXPECT_EQ(analysis.bound.kind, BoundKind::kCertified);
    const auto policy = make_policy(MyopicSettings{}, problem, analysis.priced);
    constexpr int kRuns = 2000;
    double sum = 0.0, squares = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      SimulationSettings settings;
      settings.random = RandomStream(7).fork(static_cast<std::uint64_t>(run));
      const double cost = simulate(problem, *policy, settings).cost;
      sum += cost;
      squares += cost * cost;
    }
    const double mean = sum / kRuns;
    const double error = std::sqrt((squares / kRuns - mean * mean) / kRuns);
    EXPECT_LE(analysis.bound.value, mean + 4.0 * error) << "trial " << trial;
  }
}

/// A sensor that sees nothing changes nothing, whether the others miss or not.
TEST(LagrangianBound, HasNoUseForABlindSensor) {
  for (const double p_detect : {1.0, 0.8}) {
    for (const bool discounted : {false, true}) {
      Problem without = s2a();
      if (discounted) without.discount = 0.9;
      for (Arm& arm : without.arms) arm.sensors[0].p_detect = p_detect;
      Problem with = without;
      for (Arm& arm : with.arms) arm.sensors.push_back(blind_sensor(p_detect));
      std::swap(with.arms[0].sensors[0], with.arms[0].sensors[1]);
      const Bound one = analyse(without, {.values = false}).bound;
      const Bound other = analyse(with, {.values = false}).bound;
      EXPECT_EQ(one.kind, other.kind);
      EXPECT_NEAR(one.value, other.value, 1e-9 * one.value);  // the relaxation's
    }
  }
}

/// Pauses of hundreds of scans: process noise far below the variance that they end at. From above, and not by more than
/// second order in what counts as one point, 1e-3, and in a pause, 2.1e-3 at most.
TEST(PricedArm, HasPlansForArmsThatCanWaitForLong) {
  Problem problem = scalars({1, 1}, {1, 0.01}, {1, 1});
  problem.arms[0].weight = 100.0;
  const Bound bound = analyse(problem).bound;
  EXPECT_EQ(bound.kind, BoundKind::kExact);
  EXPECT_GE(*bound.reference, bound.value * (1.0 - 1e-9));
  EXPECT_LE(*bound.reference, bound.value * (1.0 + 1e-4));
}

/// Weights of 1 to 1e4: waits of up to 1400 scans. The tolerance as above.
TEST(PricedArm, HasPlansWhateverTheWeights) {
  for (const double weight : {1.0, 1e2, 1e4}) {
    Problem problem = scalars({1, 1}, {1, 0.01}, {0.5, 5});
    problem.arms[0].weight = weight;
    const Bound bound = analyse(problem).bound;
    EXPECT_GE(*bound.reference, bound.value * (1.0 - 1e-9)) << "weight " << weight;
    EXPECT_LE(*bound.reference, bound.value * (1.0 + 1e-4)) << "weight " << weight;
  }
}

/// Of position and velocity: no worse than any word of up to eight scans, repeated. What one look more or less costs
/// differs from price to price, and so does the policy that the last price leaves, or looks in every scan where the
/// search begins. Tangents lose second order in 1e-3: 1e-6.
TEST(PricedArm, IsNoWorseThanPeriodicLooks) {
  constexpr int kLongest = 8;
  const Arm arm = constant_velocity_arm(6.0, 2.8, 3.8);
  std::vector<PricedValue> words;
  for (int length = 1; length <= kLongest; ++length) {
    for (unsigned looks = 1; looks < 1u << length; looks += 2) {  // the first scan has one: others are the same turned
      words.push_back(repeated(arm, looks, length));
    }
  }
  PricedArm from_last(arm, 1.0);
  for (double price = 20.0; price < 1500.0; price *= 1.03) {
    double best = std::numeric_limits<double>::infinity();
    for (const PricedValue& word : words) best = std::min(best, word.total(price));
    PricedArm from_all_looks(arm, 1.0);
    EXPECT_LE(from_last.solve(price).total(price), best * (1.0 + 1e-6)) << "price " << price;
    EXPECT_LE(from_all_looks.solve(price).total(price), best * (1.0 + 1e-6)) << "price " << price;
  }
}

/// The best wait of a random walk is about sqrt(2 price / q), here 1400 scans and 4500, and words have 2048 at most.
TEST(MechanicalWord, SaysWhereTheBestOneIsBeyondThoseTried) {
  const ScalarArm walk{1.0, 0.01, 5.0, 1.0, 1.0, 1.0};
  const RatedCost found = best_rate(walk, 1e4);
  EXPECT_TRUE(found.found);
  for (const double other : {0.999, 1.001}) {
    const int wait = static_cast<int>(std::lround(other / found.rate));
    EXPECT_LT(found.cost + 1e4 * found.rate, mechanical_cost(walk, 1, wait) + 1e4 / wait);
  }
  EXPECT_FALSE(best_rate(walk, 1e5).found);
}

/// The gains that are right where every look detects diverge here: 16 times as much noise as a look has, and one look
/// in three misses.
TEST(PricedArm, HasAFiniteCostWherePreciseLooksMiss) {
  for (const double p_detect : {0.5, 0.6, 0.7}) {
    Arm arm = constant_velocity_arm(8.0, 0.5);
    arm.sensors.front().p_detect = p_detect;
    PricedArm set(arm, 1.0);
    const PricedValue often = set.solve(1.0);
    EXPECT_GT(often.usage, 0.9);
    const PricedValue seldom = set.solve(1e4);
    EXPECT_LT(seldom.usage, 0.5);
    EXPECT_LT(seldom.total(1e4), often.total(1e4));
  }
}

/// A discount near 1: the constants of a plan are sums of thousands of scans. Against the threshold rules' sums.
TEST(PricedArm, EqualsTheThresholdRulesNearDiscountOne) {
  Problem problem = s2a();
  problem.discount = 0.9999;
  const Bound bound = analyse(problem).bound;
  EXPECT_EQ(bound.kind, BoundKind::kExact);
  EXPECT_NEAR(*bound.reference, bound.value, 1e-5 * bound.value);
}

TEST(LagrangianBound, DiscountedEqualsTheReferenceValue) {
  Problem problem = s2b();
  problem.discount = 0.95;
  const Bound bound = analyse(problem).bound;
  EXPECT_EQ(bound.kind, BoundKind::kExact);
  EXPECT_NEAR(bound.value, 59.647920523, 1e-6);
  EXPECT_NEAR(bound.price, 4.021656, 1e-5);
}

/// An always-looked-at arm has the predicted variance p = f^2 p r / (p + r) + q; f = q = r = 1: the golden ratio, and
/// after the look p - q.
TEST(MechanicalWord, OfRateOneIsTheRiccatiFixedPoint) {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  EXPECT_NEAR(mechanical_cost({1, 1, 1, 1, 1, 1}, 1, 1), golden - 1.0, 1e-14);
}

TEST(MechanicalWord, CostIsConvexInTheRate) {
  const ScalarArm arm{0.95, 0.3, 4, 1, 1, 1};
  for (int m = 1; m < 20; ++m) {
    EXPECT_LE(mechanical_cost(arm, m, 20),
              0.5 * (mechanical_cost(arm, m - 1, 20) + mechanical_cost(arm, m + 1, 20)) + 1e-12);
  }
}

/// Two methods: the words' rate and the alpha-matrices' controller. Tangents lose second order in 1e-3: 1e-6.
TEST(PricedArm, EqualsTheMechanicalWordsOnScalarArms) {
  const struct {
    double f, q, r, price;
  } cases[] = {{1, 1, 1, 1}, {1, 0.5, 4, 10}, {0.9, 1, 1, 1}, {1, 0.05, 4, 2.6}, {0.3, 3, 0.5, 0.1}};
  for (const auto& c : cases) {
    const RatedCost words = best_rate({c.f, c.q, c.r, 1, 1, 1}, c.price);
    PricedArm arm(scalar_arm_of(c.f, c.q, c.r), 1.0);
    const double total = words.cost + c.price * words.rate;
    EXPECT_NEAR(arm.solve(c.price).total(c.price), total, 1e-6 * total) << c.f << " " << c.q << " " << c.r;
  }
}

/// Mesh from below, controller from above. They close to the mesh's 1e-5 of the value.
TEST(PricedArm, AndTheMeshBracketTheValueWhereLooksMiss) {
  for (const double p_detect : {0.9, 0.6}) {
    const Arm arm = scalar_arm_of(1.0, 0.5, 4.0, 1.0, p_detect);
    for (const double discount : {0.95, 1.0}) {
      ScalarMesh mesh(arm, discount, 500.0, 1000);
      PricedArm set(arm, discount);
      const double below = mesh.solve(6.0).total(6.0);
      const double above = set.solve(6.0).total(6.0);
      EXPECT_LE(below, above * (1.0 + 1e-9));
      EXPECT_NEAR(below, above, 2e-4 * above) << "P_d " << p_detect << " b " << discount;
    }
  }
}

/// Concave, and monotone in P: properties of a minimum of <L, P> + c with L positive semidefinite. Random pairs.
TEST(PricedArm, ValueIsConcaveAndMonotone) {
  PricedArm arm(constant_velocity_arm(1, 25), 1.0);
  arm.solve(60.0);
  RandomStream random(2);
  const auto draw = [&] {
    Matrix root(2, 2);
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) root(i, j) = 4.0 * random.normal();
    }
    return Matrix(root * root.transpose());
  };
  for (int pair = 0; pair < 1000; ++pair) {
    const Matrix a = draw();
    const Matrix b = draw();
    const double scale = std::abs(arm.value().value(a)) + std::abs(arm.value().value(b));
    EXPECT_GE(arm.value().value(Matrix(0.5 * (a + b))),
              0.5 * (arm.value().value(a) + arm.value().value(b)) - 1e-9 * scale);
    EXPECT_GE(arm.value().value(Matrix(a + b)), arm.value().value(a) - 1e-9 * scale);
  }
}

/// The relaxation's value is that of policies that can be carried out, and the best two-target schedule attains it: the
/// prototypes' 29.0987, certified to be within 0.008 % of the optimum.
TEST(Reference, OfTwoPositionVelocityTargets) {
  const Bound bound = analyse(c2()).bound;
  EXPECT_EQ(bound.kind, BoundKind::kReference);
  EXPECT_NEAR(bound.value, 29.0987, 1e-4);
}

}  // namespace
}  // namespace dwell::restless::testing
