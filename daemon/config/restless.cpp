#include "daemon/config/problems.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

constexpr int kMaximumArms = 1000;
constexpr int kMaximumSensors = 64;

/// Of f: what grows tenfold a scan is no target, and its variance overflows within minutes without a look.
Range growth() { return within(-10.0, 10.0); }

void read_sensor(FieldReader in, int states, restless::Sensor& sensor) {
  if (states == 1) in.fill_in("h", std::vector<double>{1.0});
  const int count = in.count("h");
  const int side = side_of(in, "r");
  const int rows = count > 0 && count % states == 0 ? count / states : side > 0 ? side : 1;
  if (rows > restless::kMaximumStates) {
    in.refuse("h", std::to_string(rows) + " rows",
              "must have 1 to " + std::to_string(restless::kMaximumStates) + " rows");
    return;
  }
  sensor.h = read_matrix(in, "h", entry(), rows, states);
  sensor.r = read_matrix(in, "r", variance(), rows, rows);
  in.number("p_detect", above(0.0, 1.0), 1.0, sensor.p_detect);
}

bool read_arm(FieldReader in, restless::Arm& arm) {
  int states = 0;
  for (const char* field : {"f", "q", "p0"}) {
    if (states == 0) states = side_of(in, field);
  }
  if (states == 0 || states > restless::kMaximumStates) {
    in.refuse("f", std::to_string(in.count("f")) + " values",
              "must be square, n x n values row-major with n from 1 to " + std::to_string(restless::kMaximumStates));
    return false;
  }
  if (states == 1) in.fill_in("cost", std::vector<double>{1.0});
  arm.f = read_matrix(in, "f", growth(), states, states);
  arm.q = read_matrix(in, "q", variance(), states, states);
  arm.cost = read_matrix(in, "cost", entry(), states, states);
  in.number("weight", within(0.0, 1e9), 1.0, arm.weight);
  in.number("dwell", above(0.0, 1e6), 1.0, arm.dwell);
  arm.p0 = read_matrix(in, "p0", variance(), states, states);
  if (in.count("sensor") > kMaximumSensors) {
    in.refuse("sensor", std::to_string(in.count("sensor")), "must be at most " + std::to_string(kMaximumSensors));
    return false;
  }
  for (int s = 0; s < in.count("sensor"); ++s) {
    arm.sensors.emplace_back();
    read_sensor(in.element("sensor", s), states, arm.sensors.back());
    if (arm.sensors.back().h.rows() == 0) return false;
  }
  return true;
}

}  // namespace

restless::Problem read_restless(FieldReader in) {
  restless::Problem problem;
  if (in.has("discount")) {
    double discount = 0.5;
    in.number("discount", between(0.0, 1.0), 1.0, discount);
    problem.discount = discount;
  }
  const int arms = in.count("arm");
  if (arms == 0) in.refuse("arm", "", "one arm at least is required");
  if (arms > kMaximumArms) {
    in.refuse("arm", std::to_string(arms), "must be at most " + std::to_string(kMaximumArms));
    return problem;
  }
  in.integer("looks_per_scan", 1, std::max(1, arms), problem.looks_per_scan);
  bool complete = arms > 0;
  for (int i = 0; i < arms; ++i) complete = read_arm(in.element("arm", i), problem.arms.emplace_back()) && complete;
  if (!complete) return problem;
  for (const Violation& violation : validate(problem)) in.refuse(violation);
  if (in.refused_any()) return problem;
  for (const Violation& violation : validate_costs(problem)) in.refuse(violation);
  return problem;
}

restless::PolicySettings read_restless_policy(FieldReader in, v1::RestlessPolicy::KindCase kind) {
  switch (kind) {
    case v1::RestlessPolicy::kRoundRobin: {
      restless::RoundRobinSettings settings;
      in.choice("order", settings.order);
      return settings;
    }
    case v1::RestlessPolicy::kFixed: {
      restless::FixedSettings settings;
      in.integer("sensor", 1, kMaximumSensors, settings.sensor);
      return settings;
    }
    case v1::RestlessPolicy::kLargestVariance:
      return restless::LargestVarianceSettings{};
    case v1::RestlessPolicy::kSaImm: {
      restless::MyopicSettings settings;
      in.choice("cost", settings.cost);
      return settings;
    }
    case v1::RestlessPolicy::kLookahead: {
      restless::LookaheadSettings settings;
      in.integer("depth", 1, 4, settings.depth);
      return settings;
    }
    case v1::RestlessPolicy::kOrbit: {
      restless::OrbitSettings settings;
      in.number("discount", between(0.0, 1.0), 1.0, settings.discount);
      in.integer("steps", 2, 100'000, settings.steps);
      return settings;
    }
    case v1::RestlessPolicy::kWhittle:
      return restless::WhittleSettings{};
    case v1::RestlessPolicy::kIndex: {
      restless::IndexSettings settings;
      in.integer("depth", 1, 3, settings.depth);
      return settings;
    }
    case v1::RestlessPolicy::KIND_NOT_SET:
      break;
  }
  return restless::IndexSettings{};
}

}  // namespace dwell
