#include "bandit/look_ahead.hpp"

#include <cstdio>

#include <gtest/gtest.h>

#include "bandit/sa_imm.hpp"
#include "tests/bandit/linear_plan.hpp"
#include "tests/bandit/predicted_states.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

TEST(LookAhead, OfOneScanIsSaImm) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    Scene scene = random_scene(3, static_cast<std::uint64_t>(seed));
    scene.usage_cost = {0.0, 3.0, 1.0};
    Decision one, sa_imm;
    LookAhead(LookAheadSettings{1}).decide(scene.situation(), one);
    SaImm(SaImmSettings{}).decide(scene.situation(), sa_imm);
    ASSERT_EQ(one.chosen, sa_imm.chosen);
    for (std::size_t i = 0; i < one.candidates.size(); ++i) {
      EXPECT_DOUBLE_EQ(one.candidates[i].score, sa_imm.candidates[i].score);
    }
  }
}

/// With one mode nothing that is measured tells what to do next: every plan's cost is Kalman's, by enumeration.
TEST(LookAhead, OfOneModeIsTheBestPlanOfLooks) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    for (const int depth : {2, 3}) {
      Scene scene = linear_scene(2, 3, static_cast<std::uint64_t>(seed));
      for (auto& sensor : scene.owned) {  // certain detections: what a miss leaves is a plan of its own
        sensor = std::make_shared<LinearSensor>(sensor->jacobian(State::Zero()), sensor->noise(State::Zero()), 1.0);
      }
      for (std::size_t s = 0; s < scene.sensors.size(); ++s) scene.sensors[s] = scene.owned[s].get();
      if (seed % 2 == 0) {
        scene.budgets[0] = LookBudget({1, 8, BudgetSettings::Span::kWindow, BudgetSettings::Spread::kEven});
        scene.budgets[0].next_scan();
      }
      const LinearPlan plan(scene, depth);
      const auto allowed = [&](int scan, std::size_t sensor, const std::vector<int>& looks) {
        LookBudget::Plan taken = 0;
        for (std::size_t k = 0; k < looks.size(); ++k) {
          if (looks[k] == static_cast<int>(sensor)) taken = static_cast<LookBudget::Plan>(taken | (1U << k));
        }
        return scene.budgets[sensor].allows(scan, taken);
      };
      Decision decision;
      LookAhead(LookAheadSettings{depth}).decide(scene.situation(), decision);
      for (const Candidate& candidate : decision.candidates) {
        EXPECT_NEAR(plan.without_looks() - candidate.score, plan.best_from(candidate.pair, allowed),
                    1e-9 * plan.without_looks());
      }
    }
  }
}

/// A filter step by one drawn measurement, for the Monte Carlo below.
ImmEstimate after_draw(const ImmEstimate& prior, const std::vector<PredictedMeasurement>& seen, const Sensor& sensor,
                       UpdateForm form, const DiscreteBank& bank, RandomStream& stream) {
  const auto mode = static_cast<std::size_t>([&] {
    double u = stream.uniform();
    int j = 0;
    while (j + 1 < prior.size() && u >= prior.probability[j]) u -= prior.probability[j++];
    return j;
  }());
  const Vector2 away = Matrix2(seen[mode].s_root.matrixL()) * Vector2(stream.normal(), stream.normal());
  std::vector<Vector2> innovations;
  for (const PredictedMeasurement& other : seen) {
    innovations.push_back(away + innovation(sensor, form, seen[mode].z, other.z));
  }
  ImmEstimate estimate = prior;
  EXPECT_EQ(update(seen, innovations, estimate), Numerics::kOk);
  ImmEstimate next;
  EXPECT_EQ(predict(bank, estimate, next), Numerics::kOk);
  return next;
}

struct Error {
  double value;  // of a pair's score, as a part of the idle cost of both scans
  double noise;  // standard error of the reference, likewise
};

/// Two scans of one track: the score against its definition, the outcome of the first look drawn at random.
Error error_of(const ImmEstimate& estimate, const std::vector<std::shared_ptr<const Sensor>>& sensors, UpdateForm form,
               const DiscreteBank& bank, std::size_t first, int draws, RandomStream stream) {
  Scene scene;
  for (const auto& sensor : sensors) scene.add_sensor(sensor);
  scene.add_track(1, estimate);
  scene.update = form;
  scene.bank = bank;
  Decision decision;
  LookAhead(LookAheadSettings{2}).decide(scene.situation(), decision);
  ExpectedCost cost({position_weight(), 0.0}, 5);
  const double now = cost.without_look(estimate);
  double with = now;
  EXPECT_EQ(cost.with_look(estimate, *sensors[first], form, with), Numerics::kOk);
  ImmEstimate idle;
  EXPECT_EQ(predict(bank, estimate, idle), Numerics::kOk);
  const double later = cost.without_look(idle);
  std::vector<PredictedMeasurement> seen;
  EXPECT_EQ(predict_measurements(*sensors[first], form, estimate, seen), Numerics::kOk);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const ImmEstimate next = after_draw(estimate, seen, *sensors[first], form, bank, stream);
    double best = std::numeric_limits<double>::infinity();
    for (const auto& sensor : sensors) {
      double left = cost.without_look(next);
      EXPECT_EQ(cost.with_look(next, *sensor, form, left), Numerics::kOk);
      best = std::min(best, left);
    }
    sum += best;
    squares += best * best;
  }
  const double mean = sum / draws;
  const double noise = std::sqrt(std::max(0.0, squares / draws - mean * mean) / draws);
  const double score = now - with + later - mean;
  return {(decision.candidates[first].score - score) / (now + later), noise / (now + later)};
}

/// The approximation's error on what loops of Evans' and of Liu and Hwang's scenes come to. What is asserted is what is
/// published (bandit/README.md): an error of at most .1 % of the idle cost of the two scans, beyond four standard
/// errors of the reference, and .02 % in the root mean square (.01 % and .002 % seen).
TEST(LookAhead, FourOutcomesAModeAreWithinThePublishedError) {
  const std::vector<PredictedState> states = closed_loop_states(2, 11);
  const DiscreteBank evans = *discretise(*named_bank("evans_practical"), 1.0);
  const DiscreteBank liu_hwang = *discretise(*named_bank("liu_hwang"), 1.0);
  double worst = 0.0, squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < states.size(); i += 5) {
    const PredictedState& state = states[i];
    const bool is_evans = state.estimate.size() == 2;
    const auto sensors = is_evans ? evans_radars() : liu_hwang_sensors();
    const Error error = error_of(state.estimate, sensors, state.update, is_evans ? evans : liu_hwang,
                                 i % sensors.size(), scaled(1000), RandomStream(1).fork(i));
    EXPECT_LE(std::abs(error.value), 1e-3 + 4.0 * error.noise) << state.origin;
    worst = std::max(worst, std::abs(error.value));
    squares += error.value * error.value;
    ++count;
  }
  std::printf("%d states: worst error %.2f %%, root mean square %.3f %%\n", count, 100.0 * worst,
              100.0 * std::sqrt(squares / count));
  EXPECT_LE(std::sqrt(squares / count), 2e-4);
}

}  // namespace
}  // namespace dwell::testing
