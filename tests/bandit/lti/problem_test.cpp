#include "bandit/lti/problem.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "tests/bandit/lti/problems.hpp"

namespace dwell::lti {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> fields(const Problem& problem) {
  std::vector<std::string> fields;
  for (const Violation& violation : validate(problem)) fields.push_back(violation.field);
  return fields;
}

TEST(LtiProblem, ThePapersExamplesAreValid) {
  EXPECT_THAT(validate(chung(0.01)), IsEmpty());
  EXPECT_THAT(validate(gupta()), IsEmpty());
  EXPECT_THAT(validate(alriksson(10.0, 50)), IsEmpty());
}

TEST(LtiProblem, AllViolationsAreListed) {
  Problem problem = gupta(0);
  problem.w(0, 1) += 1.0;
  problem.initial = -Eigen::Matrix4d::Identity();
  problem.sensors[0].r = Eigen::Matrix2d::Zero();
  problem.sensors[1].c = Eigen::MatrixXd::Identity(2, 3);
  problem.sensors[2].cost = -1.0;
  problem.sensors[2].max_looks = -1;
  problem.communication_noise = kNaN;
  EXPECT_THAT(fields(problem), UnorderedElementsAre("horizon", "w", "initial_covariance", "sensor[1].r", "sensor[2].c",
                                                    "sensor[3].cost", "sensor[3].max_looks", "communication_noise"));
}

TEST(LtiProblem, AViolationSaysFieldValueAndRule) {
  Problem problem = gupta();
  problem.sensors[1].cost = -2.5;
  const std::vector<Violation> violations = validate(problem);
  ASSERT_EQ(violations.size(), 1U);
  EXPECT_EQ(to_string("lti", violations.front()), "lti: sensor[2].cost = -2.5: must be >= 0 and finite");
}

TEST(LtiProblem, EveryMatrixMustBeFinite) {
  Problem problem = gupta();
  problem.a(0, 0) = kNaN;
  problem.w(3, 3) = std::numeric_limits<double>::infinity();
  problem.initial(1, 1) = kNaN;
  problem.sensors[0].c(0, 0) = kNaN;
  problem.sensors[0].r(1, 1) = kNaN;
  EXPECT_THAT(fields(problem), UnorderedElementsAre("a", "w", "initial_covariance", "sensor[1].c", "sensor[1].r"));
}

TEST(LtiProblem, AnEmptyProblemIsRefusedNotFatal) {
  EXPECT_THAT(fields(Problem{}), UnorderedElementsAre("horizon", "a", "sensor"));
}

TEST(LtiProblem, SingularCovariancesAreGoodButNotSingularNoise) {
  Problem problem = gupta();
  problem.w.setZero();
  problem.initial.setZero();
  EXPECT_THAT(validate(problem), IsEmpty());
  problem.sensors[0].r << 1.0, 1.0, 1.0, 1.0;
  EXPECT_THAT(fields(problem), UnorderedElementsAre("sensor[1].r"));
}

TEST(LtiProblem, BudgetsMustLastWhereIdleIsNotAllowed) {
  Problem problem = gupta(15);
  for (Sensor& sensor : problem.sensors) sensor.max_looks = 5;
  EXPECT_THAT(validate(problem), IsEmpty());
  problem.horizon = 16;
  EXPECT_THAT(fields(problem), UnorderedElementsAre("horizon"));
  problem.allow_idle = true;
  EXPECT_THAT(validate(problem), IsEmpty());
}

// Ten looks in sixty steps: one more every six, the first at once.
TEST(LtiProblem, LooksOfASpreadBudget) {
  Problem problem = gupta(60);
  problem.sensors[1].max_looks = 10;
  EXPECT_EQ(looks_by(problem, 1, 60), std::numeric_limits<int>::max());
  EXPECT_EQ(looks_by(problem, 2, 1), 10);
  problem.spread = true;
  EXPECT_EQ(looks_by(problem, 1, 1), std::numeric_limits<int>::max());
  for (const auto& [step, looks] : {std::pair(1, 1), {6, 1}, {7, 2}, {12, 2}, {13, 3}, {54, 9}, {55, 10}, {60, 10}}) {
    EXPECT_EQ(looks_by(problem, 2, step), looks) << step;
  }
}

TEST(LtiProblem, TheFinalTraceKnowsNoCostOfLooks) {
  Problem problem = alriksson(10.0, 14);
  problem.sensors[0].cost = 1.0;
  EXPECT_THAT(fields(problem), UnorderedElementsAre("sensor[1].cost"));
}

}  // namespace
}  // namespace dwell::lti
