#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/command_line.hpp"

namespace dwell::client {
namespace {

/// The exit code, or -1 and the parsed line.
int parse(std::vector<const char*> arguments, CommandLine* line = nullptr) {
  arguments.insert(arguments.begin(), "dwellctl");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto result = parse_command_line(static_cast<int>(arguments.size()), arguments.data());
  testing::internal::GetCapturedStdout();
  const std::string error = testing::internal::GetCapturedStderr();
  if (const int* code = std::get_if<int>(&result)) {
    EXPECT_EQ(*code == 0, error.empty());
    return *code;
  }
  if (line != nullptr) *line = std::get<CommandLine>(result);
  return -1;
}

TEST(CommandLine, ABadOneIsTwoAndHelpIsZero) {
  using Arguments = std::vector<const char*>;
  for (const Arguments& bad : {Arguments{},
                               {"foo"},
                               {"policy"},
                               {"policy", "foo"},
                               {"policy", "set"},
                               {"policy", "set", "sa_imm", "nodes:7"},
                               {"policy", "set", "sa_imm", "=7"},
                               {"policy", "set", "sa_imm", "nodes="},
                               {"radar", "down"},
                               {"step", "0"},
                               {"step", "x"},
                               {"step", "1", "2"},
                               {"status", "pause"},
                               {"--nonsense", "status"},
                               {"--control", "foo", "status"},
                               {"--timeout", "0", "status"},
                               {"--timeout", "nan", "status"},
                               {"--control", "status"}}) {
    EXPECT_EQ(parse(bad), 2) << testing::PrintToString(bad);
  }
  for (const Arguments& help : {Arguments{"--help"}, {"policy", "--help"}, {"policy", "set", "-h"}}) {
    EXPECT_EQ(parse(help), 0) << testing::PrintToString(help);
  }
}

TEST(CommandLine, HasTheDocumentedDefaults) {
  CommandLine line;
  ASSERT_EQ(parse({"status"}, &line), -1);
  EXPECT_EQ(line.control.endpoint, "tcp://127.0.0.1:5557");
  EXPECT_EQ(line.stream, "tcp://127.0.0.1:5556");
  EXPECT_EQ(line.control.timeout.count(), 2000);
  EXPECT_EQ(line.control.tries, 3);
  EXPECT_FALSE(line.json);
  EXPECT_TRUE(line.request.has_get_status());
}

TEST(CommandLine, OptionsMayStandOnBothSidesOfTheCommand) {
  CommandLine line;
  ASSERT_EQ(parse({"--json", "policy", "get", "--timeout", "0.25", "--control", "ipc:///tmp/c"}, &line), -1);
  EXPECT_TRUE(line.json);
  EXPECT_EQ(line.verb, Verb::kPolicyGet);
  EXPECT_EQ(line.control.timeout.count(), 250);
  EXPECT_EQ(line.control.endpoint, "ipc:///tmp/c");
}

TEST(CommandLine, PolicySetJoinsItsParameters) {
  CommandLine line;
  ASSERT_EQ(parse({"policy", "set", "sa_imm", "cost=x", "beta=-1", "nodes=7", "--json"}, &line), -1);
  EXPECT_EQ(line.request.set_policy().text(), "sa_imm:cost=x:beta=-1:nodes=7");
  EXPECT_TRUE(line.json);
  ASSERT_EQ(parse({"policy", "set", "sa_imm:cost=x"}, &line), -1);
  EXPECT_EQ(line.request.set_policy().text(), "sa_imm:cost=x");
}

TEST(CommandLine, EachVerbAsksForItsOwn) {
  CommandLine line;
  ASSERT_EQ(parse({"step"}, &line), -1);
  EXPECT_EQ(line.request.step().scans(), 1u);
  ASSERT_EQ(parse({"step", "25"}, &line), -1);
  EXPECT_EQ(line.request.step().scans(), 25u);
  ASSERT_EQ(parse({"radar", "down", "far east"}, &line), -1);
  EXPECT_EQ(line.request.set_radar().name(), "far east");
  EXPECT_FALSE(line.request.set_radar().up());
  ASSERT_EQ(parse({"radar", "up", "west"}, &line), -1);
  EXPECT_TRUE(line.request.set_radar().up());
  ASSERT_EQ(parse({"radar", "list"}, &line), -1);
  EXPECT_TRUE(line.request.has_list_radars());
  ASSERT_EQ(parse({"policy", "list"}, &line), -1);
  EXPECT_TRUE(line.request.has_list_policies());
  for (const char* verb : {"watch", "explain", "snapshot"}) {
    ASSERT_EQ(parse({verb}, &line), -1);
    EXPECT_TRUE(line.request.has_get_snapshot()) << verb;
  }
  ASSERT_EQ(parse({"pause"}, &line), -1);
  EXPECT_TRUE(line.request.has_pause());
  ASSERT_EQ(parse({"resume"}, &line), -1);
  EXPECT_TRUE(line.request.has_resume());
  ASSERT_EQ(parse({"stop"}, &line), -1);
  EXPECT_TRUE(line.request.has_stop());
}

}  // namespace
}  // namespace dwell::client
