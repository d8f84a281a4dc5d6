#include "bandit/restless/whittle.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "bandit/restless/index_table.hpp"
#include "bandit/restless/orbit_index.hpp"
#include "radar/random.hpp"
#include "tests/bandit/restless/instances.hpp"
#include "tests/scale.hpp"

namespace dwell::restless::testing {
namespace {

ScalarArm arm_of(double f, double q, double r, double weight = 1.0) { return {f, q, r, weight, 1.0, 1.0}; }

/// Values computed with 40 digits apart from this program. Discounted to 1e-9, average to 1e-6: the index's promise.
TEST(Whittle, EqualsTheReferenceValues) {
  const struct {
    double p, weight, f, q, r, discount, index;  // discount 0: average
  } cases[] = {{2, 1, 1, 1, 1, 0.9, 1.82187607368337},      {5, 1, 1, 0.5, 4, 0.95, 11.18750453440775},
               {1.5, 2, 0.9, 1, 1, 0.9, 2.038409162883486}, {0.9, 1, 0.7, 0.6, 3, 0.95, 0.2822459241322029},
               {6, 1, 1.05, 1, 2, 0.9, 10.62736259344475},  {2, 1, 1, 1, 1, 0.99, 1.887768108518184},
               {2, 1, 1, 1, 1, 0, 1.895351068410258},       {5, 1, 1, 0.5, 4, 0, 12.98961612545794},
               {1.5, 1, 0.9, 1, 1, 0, 1.036821129035065},   {12, 1, 1, 1, 1, 0, 67.65687106587498}};
  for (const auto& c : cases) {
    const auto discount = c.discount > 0.0 ? std::optional(c.discount) : std::nullopt;
    const double index = whittle_index(arm_of(c.f, c.q, c.r, c.weight), c.p, discount);
    EXPECT_NEAR(index, c.index, (discount ? 1e-9 : 1e-6) * c.index) << "p " << c.p << " b " << c.discount;
  }
}

/// b -> 0 leaves w p^2 / (p + r) / d; what follows is of order b: 1e-9 of it.
TEST(Whittle, WithoutAFutureIsTheGainOfOneLook) {
  ScalarArm arm = arm_of(0.8, 0.7, 2.0, 3.0);
  arm.dwell = 2.0;
  const double p = 1.7;
  EXPECT_NEAR(whittle_index(arm, p, 1e-12), 1.5 * p * p / (p + arm.r), 1e-9);
}

/// All variances in another unit: an identity, so to rounding. Powers of two scale exactly.
TEST(Whittle, ScalesWithTheVariances) {
  for (const auto discount : {std::optional(0.95), std::optional<double>()}) {
    const double one = whittle_index(arm_of(0.9, 0.4, 2.0), 3.0, discount);
    EXPECT_DOUBLE_EQ(whittle_index(arm_of(0.9, 1.6, 8.0), 12.0, discount), 4.0 * one);
  }
}

/// Random arms, none chosen: first looks are more work, and the index does not fall.
TEST(Whittle, IsIndexableAndMonotoneOnRandomArms) {
  RandomStream random(1);
  for (int seed = 0; seed < scaled(40); ++seed) {
    const ScalarArm arm =
        arm_of(random.uniform(0.3, 1.1), std::exp(random.uniform(-3, 2)), std::exp(random.uniform(-2, 3)));
    const auto discount = seed % 4 == 0 ? std::nullopt : std::optional(random.uniform(0.5, 0.99));
    const IndexabilityReport report = check_indexability(arm, arm.q, 100.0 * (arm.q + arm.r), 60, discount);
    EXPECT_TRUE(report.indexable && report.monotone)
        << "f " << arm.f << " q " << arm.q << " r " << arm.r << " b " << discount.value_or(1.0);
  }
}

/// On scalar arms the orbit index is the discounted Whittle index, up to its truncation: .98^2000 of the sum is left.
TEST(Whittle, IsTheOrbitIndexOfAScalarArm) {
  const Arm arm = scalar_arm_of(0.9, 1.0, 2.0);
  const double p = 4.0;
  const double orbit = orbit_index(arm, 0, p * Matrix::Ones(1, 1), {0.98, 2000});
  EXPECT_NEAR(orbit, whittle_index(arm_of(0.9, 1.0, 2.0), p, 0.98), 1e-9 * orbit);
}

/// Between the table's points, a decade of variances: what its header says.
TEST(IndexTable, IsAsExactAsItSays) {
  RandomStream random(4);
  const auto worst_of = [&](const Arm& arm, int draws) {
    const IndexTable table(arm, 0, 0.9);
    double worst = 0.0;
    for (int draw = 0; draw < draws; ++draw) {
      const double p = arm.q(0, 0) * std::pow(10.0, random.uniform(0.0, 1.0));
      const double exact = whittle_of(arm, 0, 0.9, p);
      worst = std::max(worst, std::abs(table(p) - exact) / exact);
    }
    return worst;
  };
  EXPECT_LE(worst_of(scalar_arm_of(0.9, 1.0, 2.0), 200), 1e-3);
  EXPECT_LE(worst_of(scalar_arm_of(0.9, 1.0, 2.0, 1.0, 0.8), 10), 1e-2);
}

/// The prototypes' calibrated values, printed to 1e-4; the mesh promises 1e-5 of the index.
TEST(Whittle, IsCalibratedWhereLooksMiss) {
  const struct { double p_detect, index; } cases[] = {{0.9, 10.2942}, {0.7, 8.4950}, {0.5, 6.6661}};
  for (const auto& c : cases) {
    Arm arm = scalar_arm_of(1.0, 0.5, 4.0, 1.0, c.p_detect);
    EXPECT_NEAR(whittle_of(arm, 0, 0.95, 5.0), c.index, 5e-5 + 1e-5 * c.index);
  }
}

}  // namespace
}  // namespace dwell::restless::testing
