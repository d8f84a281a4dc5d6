// Every number of a scheduling problem: refused outside its limits, and what is accepted can be solved.

#include <atomic>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "daemon/study/problem_kinds.hpp"
#include "radar/violation.hpp"

namespace dwell {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

struct Row {
  std::string field;  // Message.field of problem.proto
  std::string text;   // a problem with @ for the value
  std::string path;
  std::string rule;
  std::vector<std::string> bad;  // as a violation prints them
  std::vector<std::string> good;
};

std::string lti(const std::string& fields) { return "lti { " + fields + " }"; }
std::string hmm(const std::string& fields) { return "hmm_selection { " + fields + " }"; }

std::string restless(const std::string& fields) { return "restless { " + fields + " }"; }
std::string bandit(const std::string& fields) { return "hmm_bandit { " + fields + " }"; }

const std::string kArmFields = "arm { f: 1 q: 1 p0: 1 sensor { r: 1 } ";
const std::string kArm = kArmFields + "} ";
const std::string kBanditArm = "arm { transition: [1, 0, 0, 1] emission: [1, 1] reward: [0, 1] belief: [.5, .5] } ";
const std::string kSteps = "horizon: 4 ";
const std::string kSystem = "a: [1, 0, 0, 1] w: [1, 0, 0, 1] initial_covariance: [1, 0, 0, 1] ";
const std::string kSensor = "sensor { c: [1, 0] r: [1] } ";
const std::string kChain = "transition: [.5, .5, .5, .5] belief: [.5, .5] ";
const std::string kEmission = "sensor { emission: [.5, .5, .5, .5] } ";
const std::string kLti = kSteps + kSystem + kSensor;
const std::string kHmm = kSteps + kChain + kEmission;
const std::string kEntry = "must be in [-1000000000, 1000000000]";
const std::string kVariance = "must be in [-1e+18, 1e+18]";
const std::string kCost = "must be in [0, 1000000000000]";

// clang-format off
const std::vector<Row> kRows{
  {"Lti.horizon", lti(kSystem + kSensor + "horizon: @"), "lti.horizon", "must be a whole number from 1 to 10000",
   {"0", "10001"}, {"1", "10000"}},
  {"Lti.a", lti(kSteps + kSensor + "w: [1, 0, 0, 1] initial_covariance: [1, 0, 0, 1] a: [1, 0, @, 1]"), "lti.a",
   kEntry, {"nan", "inf", "1000000001"}, {"-1e9", "0", "1e9"}},
  {"Lti.w", lti(kSteps + kSensor + "a: [1, 0, 0, 1] initial_covariance: [1, 0, 0, 1] w: [1, 0, 0, @]"), "lti.w",
   kVariance, {"nan", "inf", "1.1e+18"}, {"0", "1e18"}},
  {"Lti.initial_covariance", lti(kSteps + kSensor + "a: [1, 0, 0, 1] w: [1, 0, 0, 1] initial_covariance: [1, 0, 0, @]"),
   "lti.initial_covariance", kVariance, {"nan", "-inf", "1.1e+18"}, {"0", "1e18"}},
  {"Lti.communication_noise", lti(kLti + kSensor + "communication_noise: @"), "lti.communication_noise",
   "must be in [0, 1e+18]", {"nan", "inf", "-1"}, {"0", "1e18"}},
  {"LtiSensor.c", lti(kSteps + kSystem + "sensor { r: [1] c: [1, @] }"), "lti.sensor[1].c", kEntry,
   {"nan", "-1000000001"}, {"0", "1e9"}},
  {"LtiSensor.r", lti(kSteps + kSystem + "sensor { c: [1, 0] r: [@] }"), "lti.sensor[1].r", kVariance,
   {"nan", "inf", "1.1e+18"}, {"1e-18", "1e18"}},
  {"LtiSensor.cost", lti(kSteps + kSystem + "sensor { c: [1, 0] r: [1] cost: @ }"), "lti.sensor[1].cost", kCost,
   {"nan", "-1"}, {"0", "1e12"}},
  {"LtiSensor.max_looks", lti(kLti + "sensor { c: [1, 0] r: [1] max_looks: @ }"), "lti.sensor[2].max_looks",
   "must be a whole number from 0 to 10000", {"10001"}, {"0", "10000"}},
  {"LtiFixed.sensor", lti(kLti + "policy { fixed { sensor: @ } }"), "lti.policy[1].fixed.sensor",
   "must be a whole number from 1 to 1", {"0", "2"}, {"1"}},
  {"LtiWindow.d", lti(kLti + "policy { window { d: @ } }"), "lti.policy[1].window.d",
   "must be a whole number from 1 to 10000", {"0", "10001"}, {"1", "10000"}},
  {"LtiThreshold.f", lti(kLti + "policy { threshold { f: @ } }"), "lti.policy[1].threshold.f",
   "must be in [1, 1000000000]", {"nan", "inf", "0.999"}, {"1", "1e9"}},
  {"LtiBeam.width", lti(kLti + "policy { beam { width: @ } }"), "lti.policy[1].beam.width",
   "must be a whole number from 1 to 1000000", {"0", "1000001"}, {"1", "1000000"}},
  {"LtiRelaxedDp.alpha", lti(kLti + "policy { relaxed_dp { alpha: @ } }"), "lti.policy[1].relaxed_dp.alpha",
   "must be in [1, 1000]", {"nan", "0.999", "1001"}, {"1", "1000"}},

  {"HmmSelection.transition", hmm(kSteps + kEmission + "belief: [.5, .5] transition: [1, 0, @, 1]"),
   "hmm_selection.transition", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
  {"HmmSelection.belief", hmm(kSteps + kEmission + "transition: [1, 0, 0, 1] belief: [1, @]"),
   "hmm_selection.belief", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
  {"HmmSelection.horizon", hmm(kChain + kEmission + "horizon: @"), "hmm_selection.horizon",
   "must be a whole number from 1 to 100000", {"0", "100001"}, {"1", "1000"}},
  {"HmmSelection.beta", hmm(kHmm + "beta: @"), "hmm_selection.beta", "must be in (0, 1000000000000]",
   {"nan", "inf", "0"}, {"1e-300", "1e12"}},
  {"HmmSensor.emission", hmm(kSteps + kChain + "sensor { emission: [1, 0, @, 1] }"),
   "hmm_selection.sensor[1].emission", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
  {"HmmSensor.cost", hmm(kHmm + "sensor { emission: [1, 0, 0, 1] cost: @ }"), "hmm_selection.sensor[2].cost", kCost,
   {"nan", "-1"}, {"0", "1e12"}},
  {"HmmFixed.sensor", hmm(kHmm + "policy { fixed { sensor: @ } }"), "hmm_selection.policy[1].fixed.sensor",
   "must be a whole number from 1 to 1", {"0", "2"}, {"1"}},
  {"HmmWindow.d", hmm(kHmm + "policy { window { d: @ } }"), "hmm_selection.policy[1].window.d",
   "must be a whole number from 1 to 20", {"0", "21"}, {"1", "20"}},

  {"Restless.discount", restless(kArm + "discount: @"), "restless.discount", "must be in (0, 1)",
   {"nan", "0", "1"}, {"0.01", "0.99"}},
  {"Restless.looks_per_scan", restless(kArm + "looks_per_scan: @"), "restless.looks_per_scan",
   "must be a whole number from 1 to 1", {"0", "2"}, {"1"}},
  {"RestlessArm.f", restless("arm { q: 1 p0: 1 sensor { r: 1 } f: @ }"), "restless.arm[1].f", "must be in [-10, 10]",
   {"nan", "10.1"}, {"-10", "0", "10"}},
  {"RestlessArm.q", restless("arm { f: 1 p0: 1 sensor { r: 1 } q: @ }"), "restless.arm[1].q", kVariance,
   {"nan", "1.1e+18"}, {"0.01", "1e6"}},
  {"RestlessArm.cost", restless(kArmFields + "cost: @ }"), "restless.arm[1].cost", kEntry, {"nan", "1000000001"},
   {"1", "1e9"}},
  {"RestlessArm.weight", restless(kArmFields + "weight: @ }"), "restless.arm[1].weight", "must be in [0, 1000000000]",
   {"nan", "-1"}, {"1e-3", "1e9"}},
  {"RestlessArm.dwell", restless(kArmFields + "dwell: @ }"), "restless.arm[1].dwell", "must be in (0, 1000000]",
   {"nan", "0", "1000001"}, {"0.5", "3"}},
  {"RestlessArm.p0", restless("arm { f: 1 q: 1 sensor { r: 1 } p0: @ }"), "restless.arm[1].p0", kVariance,
   {"nan", "1.1e+18"}, {"0.01", "1e6"}},
  {"RestlessSensor.h", restless("arm { f: 1 q: 1 p0: 1 sensor { r: 1 h: @ } }"), "restless.arm[1].sensor[1].h", kEntry,
   {"nan", "1000000001"}, {"0.1", "10"}},
  {"RestlessSensor.r", restless("arm { f: 1 q: 1 p0: 1 sensor { r: @ } }"), "restless.arm[1].sensor[1].r", kVariance,
   {"nan", "1.1e+18"}, {"0.01", "1e6"}},
  {"RestlessSensor.p_detect", restless("arm { f: .9 q: 1 p0: 1 sensor { r: 1 p_detect: @ } }"),
   "restless.arm[1].sensor[1].p_detect", "must be in (0, 1]", {"nan", "0", "1.1"}, {"1"}},
  {"Fixed.sensor", restless(kArm + "policy { fixed { sensor: @ } }"), "restless.policy[1].fixed.sensor",
   "must be a whole number from 1 to 64", {"0", "65"}, {"1", "64"}},
  {"RestlessLookahead.depth", restless(kArm + "policy { lookahead { depth: @ } }"),
   "restless.policy[1].lookahead.depth", "must be a whole number from 1 to 4", {"0", "5"}, {"1", "4"}},
  {"Orbit.discount", restless(kArm + "policy { orbit { discount: @ } }"), "restless.policy[1].orbit.discount",
   "must be in (0, 1)", {"nan", "0", "1"}, {"0.5"}},
  {"Orbit.steps", restless(kArm + "policy { orbit { steps: @ } }"), "restless.policy[1].orbit.steps",
   "must be a whole number from 2 to 100000", {"1", "100001"}, {"2"}},
  {"Index.depth", restless(kArm + "policy { index { depth: @ } }"), "restless.policy[1].index.depth",
   "must be a whole number from 1 to 3", {"0", "4"}, {"1", "3"}},

  {"HmmBandit.discount", bandit(kBanditArm + "discount: @"), "hmm_bandit.discount", "must be in (0, 1)",
   {"nan", "0", "1"}, {"0.1", "0.9"}},
  {"HmmBanditArm.transition", bandit("discount: .9 arm { emission: [1, 1] reward: [0, 1] belief: [.5, .5] transition: [1, 0, @, 1] }"),
   "hmm_bandit.arm[1].transition", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
  {"HmmBanditArm.emission", bandit("discount: .9 arm { transition: [1, 0, 0, 1] reward: [0, 1] belief: [.5, .5] emission: [1, 0, @, 1] }"),
   "hmm_bandit.arm[1].emission", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
  {"HmmBanditArm.reward", bandit("discount: .9 arm { transition: [1, 0, 0, 1] emission: [1, 1] belief: [.5, .5] reward: [0, @] }"),
   "hmm_bandit.arm[1].reward", kEntry, {"nan", "1000000001"}, {"-1e9", "1e9"}},
  {"HmmBanditArm.belief", bandit("discount: .9 arm { transition: [1, 0, 0, 1] emission: [1, 1] reward: [0, 1] belief: [1, @] }"),
   "hmm_bandit.arm[1].belief", "must be in [0, 1]", {"nan", "-0.1", "1.1"}, {"0"}},
};
// clang-format on

std::string with(const Row& row, const std::string& value) {
  std::string text = row.text;
  return text.replace(text.find('@'), 1, value);
}

std::unique_ptr<StudyReport> study(const std::string& text, const StudyRequest& request = {}) {
  static const std::atomic<bool> never{false};
  ParsedConfig config = parse_config_text(text, "test", ".");
  const ProblemKind& kind = kind_of(config.message);
  return kind.study(std::move(config), request, {never, [](int, int) {}});
}

std::vector<Violation> violations_of(const std::string& text) {
  try {
    (void)study(text);
    return {};
  } catch (const InvalidInput& error) {
    return error.violations();
  }
}

TEST(ProblemFields, ABadValueIsOneViolationWithPathValueRuleAndPlace) {
  for (const Row& row : kRows) {
    for (const std::string& value : row.bad) {
      SCOPED_TRACE(row.field + ": " + value);
      const std::vector<Violation> violations = violations_of(with(row, value));
      ASSERT_THAT(violations, SizeIs(1));
      EXPECT_EQ(violations[0].field, row.path);
      EXPECT_EQ(violations[0].value, value);
      EXPECT_EQ(violations[0].rule, row.rule);
      const std::string name = row.field.substr(row.field.find('.') + 1) + ":";
      EXPECT_EQ(violations[0].line, 1);
      EXPECT_EQ(violations[0].column, static_cast<int>(row.text.rfind(name, row.text.find('@'))) + 1);
    }
  }
}

void expect_numbers(const nlohmann::json& json) {
  if (json.is_structured()) {
    for (const auto& element : json) expect_numbers(element);
  } else {
    EXPECT_FALSE(json.is_null());  // how JSON writes what is not finite
  }
}

TEST(ProblemFields, WhatIsAcceptedIsSolved) {
  for (const Row& row : kRows) {
    for (const std::string& value : row.good) {
      SCOPED_TRACE(row.field + ": " + value);
      std::unique_ptr<StudyReport> report;
      ASSERT_NO_THROW(report = study(with(row, value)));
      EXPECT_TRUE(report->complete());
      expect_numbers(nlohmann::json::parse(report->json()));
    }
  }
}

void numeric_fields(const google::protobuf::Descriptor& type, std::set<std::string>& fields) {
  using google::protobuf::FieldDescriptor;
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) numeric_fields(*field.message_type(), fields);
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE || field.cpp_type() == FieldDescriptor::CPPTYPE_UINT32) {
      fields.insert(type.name() + "." + field.name());
    }
  }
}

TEST(ProblemFields, TheTableHasEveryNumberOfTheSchema) {
  std::set<std::string> wanted;
  const auto* problems = v1::Config::descriptor()->FindOneofByName("problem");
  for (int i = 0; i < problems->field_count(); ++i) numeric_fields(*problems->field(i)->message_type(), wanted);
  std::set<std::string> there;
  for (const Row& row : kRows) there.insert(row.field);
  EXPECT_EQ(there, wanted);
}

TEST(ProblemKinds, EveryProblemOfTheSchemaHasItsKind) {
  const auto* problems = v1::Config::descriptor()->FindOneofByName("problem");
  EXPECT_STREQ(kind_of(v1::Config()).name, "");
  for (int i = 0; i < problems->field_count(); ++i) {
    v1::Config config;
    (void)config.GetReflection()->MutableMessage(&config, problems->field(i));
    EXPECT_EQ(kind_of(config).name, problems->field(i)->name());
  }
}

TEST(ProblemFields, AnEmptyProblemIsRefusedNotFatal) {
  for (const char* text : {"lti {}", "hmm_selection {}"}) EXPECT_THAT(violations_of(text), ::testing::Not(IsEmpty()));
}

}  // namespace
}  // namespace dwell
