#include <gmock/gmock.h>

#include "daemon/config/policy_reader.hpp"

namespace dwell {
namespace {

using ::testing::HasSubstr;

constexpr int kSensors = 3;

std::vector<std::string> policy_names() {
  std::vector<std::string> names;
  const auto* type = v1::Policy::descriptor();
  for (int i = 0; i < type->field_count(); ++i) names.push_back(type->field(i)->name());
  return names;
}

/// The policy with all its parameters written out, or the violations.
std::string effective(const std::string& text) {
  std::vector<Violation> violations;
  auto policy = parse_policy_text(text, violations);
  if (policy) (void)read_policy(*policy, kSensors, true, violations);
  std::string refused;
  for (const Violation& violation : violations) refused += to_string("", violation) + "\n";
  return violations.empty() ? policy_text(*policy) : refused;
}

TEST(PolicyText, EveryPolicyOfTheSchemaIsDescribedWithEveryParameter) {
  const auto policies = describe_policies(kSensors, true);
  ASSERT_EQ(policies.size(), policy_names().size());
  for (std::size_t i = 0; i < policies.size(); ++i) {
    EXPECT_EQ(policies[i].name, policy_names()[i]);
    EXPECT_FALSE(policies[i].summary.empty());
    const auto* type = v1::Policy::descriptor()->FindFieldByName(policies[i].name)->message_type();
    ASSERT_EQ(static_cast<int>(policies[i].parameters.size()), type->field_count()) << policies[i].name;
    for (int field = 0; field < type->field_count(); ++field) {
      const FieldDescription& parameter = policies[i].parameters[static_cast<std::size_t>(field)];
      EXPECT_EQ(parameter.name, type->field(field)->name());
      EXPECT_THAT(parameter.rule, HasSubstr("must be"));
      EXPECT_FALSE(parameter.default_value.empty()) << parameter.name;
    }
  }
}

TEST(PolicyText, EveryPolicyByItsNameTakesTheDefaults) {
  for (const PolicyDescription& policy : describe_policies(kSensors, true)) {
    std::string spelled_out = policy.name;
    for (const FieldDescription& parameter : policy.parameters) {
      spelled_out += ":" + parameter.name + "=" + parameter.default_value;
    }
    EXPECT_EQ(effective(policy.name), effective(spelled_out));
  }
}

TEST(PolicyText, TextOfAPolicyReadsBackTheSame) {
  for (const std::string& name : policy_names()) {
    const std::string text = effective(name);
    EXPECT_EQ(effective(text), text);
    EXPECT_EQ(text.substr(0, name.size()), name);
  }
  EXPECT_EQ(effective("sa_imm:beta=1e3:cost=full:nodes=7"), "sa_imm:cost=full:beta=1000:nodes=7");
  EXPECT_EQ(effective("fixed:sensor=3"), "fixed:sensor=3");
}

TEST(PolicyText, EveryChoiceOfAnEnumIsTakenInEitherCase) {
  for (const PolicyDescription& policy : describe_policies(kSensors, true)) {
    const auto* type = v1::Policy::descriptor()->FindFieldByName(policy.name)->message_type();
    for (int i = 0; i < type->field_count(); ++i) {
      const auto* choices = type->field(i)->enum_type();
      for (int j = 0; choices != nullptr && j < choices->value_count(); ++j) {
        std::string lower = choices->value(j)->name();
        for (char& c : lower) c = static_cast<char>(std::tolower(c));
        const std::string before = policy.name + ":" + type->field(i)->name() + "=";
        EXPECT_THAT(effective(before + choices->value(j)->name()), HasSubstr(before + lower));
        EXPECT_EQ(effective(before + choices->value(j)->name()), effective(before + lower));
      }
    }
  }
}

TEST(PolicyText, UnknownPolicyListsTheValid) {
  for (const char* text : {"", "sa_im", "SA_IMM", " sa_imm", "sa_imm ", "sa_imm=1", "kind", ":", "=", "sa_imm,fixed"}) {
    const std::string refused = effective(text);
    EXPECT_THAT(refused, HasSubstr("policy")) << text;
    for (const std::string& name : policy_names()) EXPECT_THAT(refused, HasSubstr(name)) << text;
  }
}

TEST(PolicyText, UnknownParameterListsTheValid) {
  EXPECT_EQ(effective("sa_imm:depth=2"), "sa_imm.depth = 2: unknown parameter; known: cost, beta, nodes\n");
  EXPECT_EQ(effective("sa_imm:"), "sa_imm.: unknown parameter; known: cost, beta, nodes\n");
  EXPECT_EQ(effective("sa_imm:NODES=5"), "sa_imm.NODES = 5: unknown parameter; known: cost, beta, nodes\n");
  EXPECT_EQ(effective("largest_variance:x=1"),
            "largest_variance.x = 1: unknown parameter; known: nothing: it has no parameters\n");
}

TEST(PolicyText, BadValueSaysWhatItMayBe) {
  EXPECT_EQ(effective("sa_imm:cost=y"), "sa_imm.cost = y: must be one of: position, x, full, none\n");
  EXPECT_EQ(effective("sa_imm:cost"), "sa_imm.cost: must be one of: position, x, full, none\n");
  EXPECT_EQ(effective("sa_imm:nodes=2.5"), "sa_imm.nodes = 2.5: must be a whole number\n");
  EXPECT_EQ(effective("sa_imm:nodes=-3"), "sa_imm.nodes = -3: must be a whole number\n");
  EXPECT_EQ(effective("sa_imm:nodes=99999999999"), "sa_imm.nodes = 99999999999: must be a whole number\n");
  EXPECT_EQ(effective("sa_imm:nodes=33"), "sa_imm.nodes = 33: must be a whole number from 2 to 32\n");
  EXPECT_EQ(effective("sa_imm:beta=much"), "sa_imm.beta = much: must be a number\n");
  EXPECT_EQ(effective("sa_imm:beta=nan"), "sa_imm.beta = nan: must be in [0, 1000000000000]\n");
  EXPECT_EQ(effective("sa_imm:beta=-1"), "sa_imm.beta = -1: must be in [0, 1000000000000]\n");
  EXPECT_EQ(effective("fixed:sensor=4"), "fixed.sensor = 4: must be a whole number from 1 to 3\n");
  EXPECT_EQ(effective("fixed:sensor=1 sensor: 2"),
            "fixed.sensor = 1 sensor: must be a whole number\n"
            "fixed. 2: unknown parameter; known: sensor\n");
}

TEST(PolicyText, ParameterGivenTwiceIsRefused) {
  EXPECT_EQ(effective("sa_imm:nodes=5:nodes=6"), "sa_imm.nodes = 6: is given twice\n");
}

TEST(PolicyText, AllViolationsAreListed) {
  std::vector<Violation> violations;
  auto policy = parse_policy_text("sa_imm:cost=y:depth=2:nodes=x:beta=-1", violations);
  EXPECT_EQ(violations.size(), 3);
  ASSERT_TRUE(policy.has_value());  // what is left can be checked against its rules, all in one answer
  EXPECT_FALSE(read_policy(*policy, kSensors, false, violations));
  EXPECT_EQ(violations.size(), 4);
}

TEST(PolicyText, MessageWithoutAPolicyListsTheValid) {
  v1::Policy empty;
  std::vector<Violation> violations;
  EXPECT_FALSE(read_policy(empty, kSensors, false, violations));
  ASSERT_EQ(violations.size(), 1);
  EXPECT_THAT(violations[0].rule, HasSubstr("round_robin, fixed, largest_variance, sa_imm"));
  EXPECT_EQ(policy_text(empty), "");
}

}  // namespace
}  // namespace dwell
