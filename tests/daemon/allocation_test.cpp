// A scan allocates nothing once its vectors have grown. Counted at malloc, under operator new and Eigen
// alike.

#include <Eigen/Dense>

#include "bandit/value_table.hpp"
#include "daemon/config/policy_reader.hpp"
#include "daemon/encode.hpp"
#include "tests/allocations.hpp"
#include "tests/daemon/support.hpp"
#include "tests/scale.hpp"

namespace dwell::testing {
namespace {

/// 3 radars and random targets that turn back at the edge of an area.
std::string scenario(bool clutter, int targets) {
  // A footprint that holds the target of a track gone astray, with 5 false plots on average.
  const std::string density =
      std::string(" dwell_range_m: 60e3 dwell_azimuth_deg: 30") + (clutter ? " clutter_density: 4e-5" : "");
  std::string text =
      "radar { name: \"west\" max_range_m: 1e6 x_m: -60e3 detection_probability: 0.9" + density +
      " }\n"
      "radar { name: \"east\" max_range_m: 1e6 x_m: 60e3 false_alarm_probability: 1e-6" +
      density +
      " }\n"
      "radar { name: \"south\" max_range_m: 1e6 y_m: -60e3 beamwidth_deg: 0.3 detection_probability: 0.95" +
      density + " }\n";
  RandomStream random(5);
  for (int i = 0; i < targets; ++i) {
    const auto number = [&](double limit) { return std::to_string(random.uniform(-limit, limit)); };
    text += "target { name: \"a target whose name is on the heap " + std::to_string(i) + "\" x_m: " + number(40e3) +
            " y_m: " + number(40e3) + " vx_mps: " + number(200) + " vy_mps: " + number(200) +
            " jump_markov { area { radius_m: 50e3 } } }\n";
  }
  // Nearly no track is given up: each has its part in every scan.
  // One waits for its first plot, out of the reach of all.
  text +=
      "target { name: \"a target that waits for its plot with a name on the heap\" x_m: 500e6 start { first_plot {} } "
      "}\n";
  return text + "tracker { lost_probability: 1e-300 lost_squared_distance: inf lost_sigma_m: inf }\n";
}

/// Policies whose searches take more or less of their stores from scan to scan: those grow now and then, ever less
/// often.
bool searches(const std::string& policy) {
  return policy == "optimum" || policy == "threshold" || policy == "relaxed_dp";
}

struct Case {
  std::string policy;
  bool clutter;
  int looks;
};

/// In the small count the fullest scans alone.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const PolicyDescription& policy : describe_policies(3)) {
    all.push_back({policy.name, true, 3});
    if (scaled(10) < 10) continue;
    for (const bool clutter : {false, true}) all.push_back({policy.name, clutter, 1});
    all.push_back({policy.name, false, 3});
  }
  return all;
}

TEST(Allocation, ScanAllocatesNothingAfterWarmUpUnderAnyPolicy) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.policy + (c.clutter ? ", clutter, " : ", no clutter, ") + std::to_string(c.looks) + " looks");
    // Schedules grow with the powers of the tracks; each track of `index` has sets to be built.
    const bool plans = searches(c.policy) || c.policy == "lookahead" || c.policy == "index";
    const int targets = plans ? 4 : 30;
    DaemonConfig config = config_of(scenario(c.clutter, targets) + "looks_per_scan: " + std::to_string(c.looks) +
                                    " policy { " + c.policy + " {} }");
    const auto table = std::make_shared<ValueTable>(ValueTable::OnDue::kGoOn);
    config.engine.value_table = table;
    const auto build_asked = [&] {  // beside the scans
      while (table->waiting() > 0) table->build_next();
    };
    Engine engine(config.engine);
    for (int i = 0; i < 200; ++i) {
      (void)engine.scan();
      build_asked();
    }
    ASSERT_EQ(std::ssize(engine.tracks()), targets);
    int allocating = 0;  // scans
    const int scans = plans ? 200 : 500;
    for (int i = 0; i < scans; ++i) {
      const long before = allocations();
      (void)engine.scan();
      if (allocations() > before) ++allocating;
      build_asked();
    }
    EXPECT_EQ(engine.counts().filter_failures, 0);
    EXPECT_LE(allocating, searches(c.policy) ? scans / 50 : 0) << "scans that allocate";
    EXPECT_GE(6 * std::ssize(engine.tracks()), 5 * targets);
  }
}

/// Of the default policy, once its stores have grown.
int scans_that_allocate(Engine& engine) {
  for (int i = 0; i < 200; ++i) (void)engine.scan();
  int allocating = 0;
  for (int i = 0; i < scaled(500); ++i) {
    const long before = allocations();
    (void)engine.scan();
    if (allocations() > before) ++allocating;
  }
  return allocating;
}

TEST(Allocation, NorDoesAnyAssociation) {
  for (const char* association : {"PDA", "IPDA existence { remove: 1e-300 }", "JPDA existence { remove: 1e-300 }"}) {
    SCOPED_TRACE(association);
    std::string text = scenario(true, 30);
    text.insert(text.find("tracker {") + 9, std::string(" association: ") + association);
    Engine engine(config_of(text).engine);
    EXPECT_EQ(scans_that_allocate(engine), 0);
    EXPECT_GE(6 * std::ssize(engine.tracks()), 5 * 30);
  }
}

TEST(Allocation, NorDoClasses) {
  for (const char* association : {"NEAREST", "JPDA existence { remove: 1e-300 }"}) {
    SCOPED_TRACE(association);
    std::string text = scenario(true, 30);
    text.insert(text.find("tracker {") + 9, std::string(" association: ") + association);
    for (std::size_t at = text.find("radar {"); at != std::string::npos; at = text.find("radar {", at + 1)) {
      text.insert(at + 7, " emission: [0.8, 0.2, 0.3, 0.7] ");
    }
    text += "classes { class { name: \"a\" } class { name: \"b\" weight: 9 } transition: [0.9, 0.1, 0.2, 0.8] }\n";
    Engine engine(config_of(text).engine);
    EXPECT_EQ(scans_that_allocate(engine), 0);
    EXPECT_GE(6 * std::ssize(engine.tracks()), 5 * 30);
  }
}

}  // namespace
}  // namespace dwell::testing
