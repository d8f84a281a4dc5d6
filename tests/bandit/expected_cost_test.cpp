#include "bandit/expected_cost.hpp"

#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "radar/linear_sensor.hpp"
#include "radar/range_bearing_radar.hpp"
#include "tests/bandit/expected_cost_accuracy.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double with_look(const CostWeights& weights, const PredictedState& state, int nodes = 5) {
  double cost = kNaN;
  EXPECT_EQ(ExpectedCost(weights, nodes).with_look(state.estimate, *state.sensor, state.update, cost), Numerics::kOk);
  return cost;
}

double without_look(const CostWeights& weights, const PredictedState& state) {
  return ExpectedCost(weights, 5).without_look(state.estimate);
}

std::vector<PredictedState> all_states(int runs, int count) {
  std::vector<PredictedState> states = closed_loop_states(runs, 21);
  const std::vector<PredictedState> more = random_states(count, 22);
  states.insert(states.end(), more.begin(), more.end());
  return states;
}

std::shared_ptr<const Sensor> xy_sensor(const Matrix2& r, double p_d) {
  return std::make_shared<LinearSensor>(position_selector(), r, p_d);
}

/// Two modes of different size, place and probability, seen by x and y with sigma 1.
PredictedState two_modes(double p_d) {
  Eigen::VectorXd c(2);
  c << 0.7, 0.3;
  PredictedState state{"two modes", make_estimate({}, c), xy_sensor(Matrix2::Identity(), p_d), UpdateForm::kEkf};
  state.estimate.modes[0] = {State(0.0, 10.0, 0.0, -5.0), State(2.0, 1.0, 3.0, 1.0).asDiagonal()};
  state.estimate.modes[1] = {State(1.0, 12.0, 2.0, -7.0), State(9.0, 4.0, 16.0, 4.0).asDiagonal()};
  return state;
}

// The oracle.

TEST(ExpectedCost, AgreesWithTheOracleInClosedLoops) {
  expect_accurate("closed loops", closed_loop_states(scaled(10) / 5 + 1, 1));
}

TEST(ExpectedCost, AgreesWithTheOracleOverWideRanges) {
  expect_accurate("wide ranges", random_states(scaled(1000), 2));
}

TEST(ExpectedCost, OracleAgreesWithMonteCarlo) {
  expect_confirmed(sample(closed_loop_states(1, 3), 6), scaled(400000));
  expect_confirmed(random_states(6, 4), scaled(400000));
}

/// The twin of the last test: the sum without the spread of the modes is seen to be wrong by the same draws.
TEST(ExpectedCost, MonteCarloTellsTheWithinModePartAlone) {
  const PredictedState state = two_modes(1.0);
  CostWeights weights;
  weights.w = position_weight();
  double within = 0.0;
  for (const auto& mode : {0, 1}) {
    PredictedState alone = state;
    alone.estimate.probability = Eigen::Vector2d::Unit(mode);
    within += state.estimate.probability[mode] * with_look(weights, alone);
  }
  const MonteCarlo drawn = monte_carlo_parts(state, scaled(400000), RandomStream(6));
  EXPECT_GT(drawn.mean.position - within, 4.5 * drawn.standard_error.position);
}

// Closed forms.

TEST(ExpectedCost, OneModeReducesTheCostAsTheKalmanFilterDoes) {
  const double p_d = 0.8;
  for (const auto& sensor : {xy_sensor(Vector2(4.0, 9.0).asDiagonal(), p_d)}) {
    // Axis by axis: p - p^2 / (p + r) = 12 x 4 / 16 = 3 of x, 27 x 9 / 36 = 6.75 of y.
    PredictedState state{
        "", make_estimate({State::Zero(), State(12.0, 5.0, 27.0, 7.0).asDiagonal()}, Eigen::VectorXd::Ones(1)), sensor,
        UpdateForm::kEkf};
    CostWeights weights;
    weights.w = position_weight();
    weights.beta = 3.0;  // one mode is known: no share
    EXPECT_DOUBLE_EQ(without_look(weights, state), 39.0);
    EXPECT_NEAR(with_look(weights, state), p_d * 9.75 + (1.0 - p_d) * 39.0, 1e-13 * 39.0);
  }
}

/// Two modes of the same S: the log of their density ratio is linear in y, and with W = 0, beta = 1 the
/// expected cost is 2 c_1 E_{u ~ N(0,1)}[ 1 / (1 + exp(log(c_1 / c_2) + d^2 / 2 - d u)) ], d their
/// Mahalanobis distance. That integral by the midpoint rule on +-10 sigma with 2000 cells: exact to rounding.
TEST(ExpectedCost, EqualCovariancesMakeAOneDimensionalIntegral) {
  CostWeights weights;
  weights.beta = 1.0;
  for (const double d : {0.0, 0.5, 1.0, 2.0, 4.0, 7.0}) {
    PredictedState state = two_modes(1.0);
    state.estimate.modes[1].covariance = state.estimate.modes[0].covariance;  // S = diag(3, 4)
    state.estimate.modes[1].mean =
        state.estimate.modes[0].mean + State(0.6 * d * std::sqrt(3.0), 0.0, 0.8 * d * 2.0, 0.0);
    double exact = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const double u = -10.0 + 0.01 * (i + 0.5);
      const double density = std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi);
      exact += 0.01 * 2.0 * 0.7 * density / (1.0 + std::exp(std::log(0.7 / 0.3) + 0.5 * d * d - d * u));
    }
    EXPECT_NEAR(with_look(weights, state, 10), exact, 0.005 * 0.42) << d;
    EXPECT_NEAR(with_look(weights, state, 32), exact, 1e-5 * 0.42) << d;
  }
}

// Laws, over closed loops and wide ranges.

TEST(ExpectedCost, ALookNeverHurtsInExpectation) {
  for (const PredictedState& state : all_states(1, scaled(200))) {
    for (const CostKind& kind : kCostKinds) {
      const double without = without_look(kind.weights(), state);
      EXPECT_LE(with_look(kind.weights(), state), 1.02 * without) << state.origin << kind.name;  // the rule's error
      EXPECT_GE(with_look(kind.weights(), state), 0.0) << state.origin << kind.name;
    }
  }
}

TEST(ExpectedCost, LinearInTheDetectionProbability) {
  const CostWeights weights = kCostKinds[3].weights();
  const double without = without_look(weights, two_modes(1.0));
  const double certain = with_look(weights, two_modes(1.0));
  for (const double p_d : {0.0, 0.3, 0.75}) {
    EXPECT_NEAR(with_look(weights, two_modes(p_d)), p_d * certain + (1.0 - p_d) * without, 1e-14 * without);
  }
  EXPECT_EQ(with_look(weights, two_modes(0.0)), without);
}

TEST(ExpectedCost, LinearInTheWeights) {
  for (const PredictedState& state : all_states(1, scaled(100))) {
    CostWeights both = kCostKinds[1].weights();
    CostWeights trace = both;
    CostWeights mode = both;
    both.w *= 7.0;
    both.beta = 3.0;
    trace.beta = 0.0;
    mode.w.setZero();
    mode.beta = 1.0;
    const double sum = 7.0 * with_look(trace, state) + 3.0 * with_look(mode, state);
    EXPECT_NEAR(with_look(both, state), sum, 1e-12 * sum) << state.origin;  // rounding of the sums over the nodes
  }
}

TEST(ExpectedCost, ThePermutationOfModesChangesNothing) {
  for (const PredictedState& state : all_states(1, scaled(200))) {
    PredictedState other = state;
    for (int j = 0; j < state.estimate.size(); ++j) {
      const int from = (j + 1) % state.estimate.size();
      other.estimate.modes[static_cast<std::size_t>(j)] = state.estimate.modes[static_cast<std::size_t>(from)];
      other.estimate.probability[j] = state.estimate.probability[from];
    }
    for (const CostKind& kind : kCostKinds) {
      const double cost = with_look(kind.weights(), state);
      EXPECT_NEAR(with_look(kind.weights(), other), cost, 1e-12 * without_look(kind.weights(), state))
          << state.origin << kind.name;
    }
  }
}

TEST(ExpectedCost, TwoIdenticalModesAreOne) {
  PredictedState one = two_modes(0.9);
  one.estimate = make_estimate(one.estimate.modes[1], Eigen::VectorXd::Ones(1));
  PredictedState two = one;
  two.estimate = make_estimate(one.estimate.modes[0], Eigen::Vector2d(0.35, 0.65));
  for (const CostKind& kind : {kCostKinds[0], kCostKinds[2]}) {
    EXPECT_NEAR(with_look(kind.weights(), two), with_look(kind.weights(), one),
                1e-14 * without_look(kind.weights(), one));
  }
}

TEST(ExpectedCost, AModeSplitInTwoChangesNothingButTheRulesError) {
  const PredictedState two = two_modes(1.0);
  for (const int split : {0, 1}) {
    PredictedState three = two;
    three.estimate.modes.push_back(two.estimate.modes[static_cast<std::size_t>(split)]);
    three.estimate.probability.resize(3);
    three.estimate.probability << two.estimate.probability, 0.4 * two.estimate.probability[split];
    three.estimate.probability[split] *= 0.6;
    const CostWeights weights = kCostKinds[2].weights();
    const double without = without_look(weights, two);
    EXPECT_NEAR(with_look(weights, three, 5), with_look(weights, two, 5), 0.02 * without);
    EXPECT_NEAR(with_look(weights, three, 10), with_look(weights, two, 10), 0.005 * without);
    EXPECT_NEAR(with_look(weights, three, 32), with_look(weights, two, 32), 1e-6 * without);
  }
}

TEST(ExpectedCost, AModeOfProbabilityZeroDoesNotCount) {
  const PredictedState two = two_modes(1.0);
  PredictedState three = two;
  three.estimate.modes.insert(three.estimate.modes.begin(), {State::Constant(1e3), StateMatrix::Identity()});
  three.estimate.probability.resize(3);
  three.estimate.probability << 0.0, two.estimate.probability;
  for (const CostKind& kind : kCostKinds) {
    EXPECT_NEAR(with_look(kind.weights(), three), with_look(kind.weights(), two),
                1e-12 * without_look(kind.weights(), two));
  }
}

/// No overlap, no overflow: each mode is certain after the look.
TEST(ExpectedCost, ModesFarApartAreToldApart) {
  PredictedState state = two_modes(1.0);
  for (const double distance_m : {1e2, 1e4, 1e8}) {
    state.estimate.modes[1].mean[kX] = distance_m;
    const CostWeights weights = kCostKinds[4].weights();
    EXPECT_NEAR(with_look(weights, state), 0.0, 1e-12);
  }
}

// Geometry.

StateMatrix rotation(double angle_rad) {
  StateMatrix turn = StateMatrix::Zero();
  turn({kX, kY}, {kX, kY}) = turn({kVx, kVy}, {kVx, kVy}) = Eigen::Rotation2Dd(angle_rad).toRotationMatrix();
  return turn;
}

PredictedState rotated(const PredictedState& state, double angle_rad) {
  const StateMatrix turn = rotation(angle_rad);
  PredictedState other = state;
  for (Gaussian& mode : other.estimate.modes) {
    mode = {turn * mode.mean, symmetric_part(turn * mode.covariance * turn.transpose())};
  }
  const auto p_d = state.sensor->detection_probability(combined_mean(state.estimate));
  if (const auto* radar = dynamic_cast<const RangeBearingRadar*>(state.sensor.get())) {
    RadarFigures figures = radar->figures();
    figures.position_m = Eigen::Rotation2Dd(angle_rad) * figures.position_m;
    other.sensor = std::make_shared<RangeBearingRadar>(figures);
  } else {
    other.sensor = std::make_shared<LinearSensor>(state.sensor->jacobian(State::Zero()) * turn.transpose(),
                                                  state.sensor->noise(State::Zero()), p_d);
  }
  return other;
}

TEST(ExpectedCost, RotatingTheSceneChangesNothing) {
  for (const PredictedState& state : all_states(1, scaled(200))) {
    for (const double angle_rad : {0.3, 2.0, 3.1}) {
      for (const CostKind& kind : kCostKinds) {
        const double without = without_look(kind.weights(), state);
        // 1e-9: coordinates of 1e5 m are rounded to 1e-11 m, and modes of as_printed lie 1e-3 m apart.
        EXPECT_NEAR(with_look(kind.weights(), rotated(state, angle_rad)), with_look(kind.weights(), state),
                    1e-9 * without)
            << state.origin << ", " << kind.name;
      }
    }
  }
}

/// At 100 km and offsets of 20 m the directions in which EKF and conversion linearise differ by 2e-4.
TEST(ExpectedCost, ConvertedAndEkfAgreeAtSmallNoise) {
  const auto radar = evans_radars()[0];
  PredictedState state = two_modes(1.0);
  state.sensor = radar;
  for (Gaussian& mode : state.estimate.modes) mode.mean += make_state({180e3, 200e3}, {0.0, 0.0});
  state.estimate.modes[1].mean[kX] += 20.0;
  PredictedState converted = state;
  converted.update = UpdateForm::kConverted;
  for (const CostKind& kind : kCostKinds) {
    const double without = without_look(kind.weights(), state);
    EXPECT_NEAR(with_look(kind.weights(), state), with_look(kind.weights(), converted), 1e-3 * without) << kind.name;
  }
}

/// Two modes either side of south, where the azimuth jumps from -pi to pi.
TEST(ExpectedCost, TheAzimuthMayWrapBetweenModes) {
  PredictedState state = two_modes(1.0);
  RadarFigures figures;
  figures.position_m = {0.5, 100e3};
  state.sensor = std::make_shared<RangeBearingRadar>(figures);
  PredictedState turned = rotated(state, std::numbers::pi / 2);
  for (const CostKind& kind : kCostKinds) {
    EXPECT_NEAR(with_look(kind.weights(), turned), with_look(kind.weights(), state),
                1e-9 * without_look(kind.weights(), state));
  }
}

// Numbers that fail.

TEST(ExpectedCost, AnIndefiniteInnovationCovarianceIsAnErrorAndLeavesTheCost) {
  PredictedState state = two_modes(1.0);
  state.estimate.modes[0].covariance(kX, kX) = -3.0;
  double cost = 12.0;
  ExpectedCost expected_cost(kCostKinds[0].weights(), 5);
  EXPECT_EQ(expected_cost.with_look(state.estimate, *state.sensor, state.update, cost), Numerics::kNotPositiveDefinite);
  EXPECT_EQ(cost, 12.0);
}

TEST(ExpectedCost, ANumberThatIsNotFiniteIsAnErrorAndLeavesTheCost) {
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
    PredictedState state = two_modes(1.0);
    state.estimate.modes[1].mean[kX] = bad;
    double cost = 12.0;
    ExpectedCost expected_cost(kCostKinds[0].weights(), 5);
    EXPECT_EQ(expected_cost.with_look(state.estimate, *state.sensor, state.update, cost), Numerics::kNotFinite);
    EXPECT_EQ(cost, 12.0);
    state = two_modes(1.0);
    state.estimate.probability[1] = bad;
    EXPECT_NE(expected_cost.with_look(state.estimate, *state.sensor, state.update, cost), Numerics::kOk);
    EXPECT_EQ(cost, 12.0);
  }
}

}  // namespace
}  // namespace dwell::testing
