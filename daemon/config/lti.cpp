#include "daemon/config/problems.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

void read_sensor(FieldReader in, int states, lti::Sensor& sensor) {
  const int count = in.count("c");
  const int side = side_of(in, "r");
  const int rows = count > 0 && count % states == 0 ? count / states : side > 0 ? side : 1;
  sensor.c = read_matrix(in, "c", entry(), rows, states);
  sensor.r = read_matrix(in, "r", variance(), rows, rows);
  in.number("cost", cost(), 1.0, sensor.cost);
  in.integer("max_looks", 0, lti::kMaximumHorizon, sensor.max_looks);
}

void read_system(FieldReader& in, lti::Problem& problem) {
  int states = 0;
  for (const char* field : {"a", "w", "initial_covariance"}) {
    if (states == 0) states = side_of(in, field);
  }
  if (states == 0 || states > lti::kMaximumStates) {
    in.refuse("a", std::to_string(in.count("a")) + " values",
              "must be square, n x n values row-major with n from 1 to " + std::to_string(lti::kMaximumStates));
    return;
  }
  problem.a = read_matrix(in, "a", entry(), states, states);
  problem.w = read_matrix(in, "w", variance(), states, states);
  problem.initial = read_matrix(in, "initial_covariance", variance(), states, states);
  for (int j = 0; j < in.count("sensor"); ++j) {
    read_sensor(in.element("sensor", j), states, problem.sensors.emplace_back());
  }
  for (const Violation& violation : validate(problem)) in.refuse(violation);
}

}  // namespace

lti::Problem read_lti(FieldReader in) {
  lti::Problem problem;
  in.required("horizon");
  problem.horizon = 1;
  in.integer("horizon", 1, lti::kMaximumHorizon, problem.horizon);
  in.choice("objective", problem.objective);
  in.choice("covariance", problem.covariance);
  in.flag("allow_idle", problem.allow_idle);
  in.number("communication_noise", within(0.0, 1e18), 1.0, problem.communication_noise);
  read_system(in, problem);
  return problem;
}

lti::Policy read_lti_policy(FieldReader in, v1::LtiPolicy::KindCase kind, int sensors) {
  bool spread = false;
  const auto spread_too = [&](const lti::PolicySettings& settings) {
    in.flag("spread", spread);
    return lti::Policy{settings, spread};
  };
  switch (kind) {
    case v1::LtiPolicy::kRoundRobin:
      return spread_too(lti::RoundRobinSettings{});
    case v1::LtiPolicy::kFixed: {
      lti::FixedSettings settings;
      in.integer("sensor", 1, std::max(1, sensors), settings.sensor);
      return spread_too(settings);
    }
    case v1::LtiPolicy::kRandom: {
      lti::RandomSettings settings;
      in.choice("q", settings.q);
      return spread_too(settings);
    }
    case v1::LtiPolicy::kWindow: {
      lti::WindowSettings settings;
      in.integer("d", 1, lti::kMaximumHorizon, settings.d);
      return spread_too(settings);
    }
    case v1::LtiPolicy::kThreshold: {
      lti::ThresholdSettings settings;
      in.number("f", within(1.0, 1e9), 1.0, settings.f);
      return spread_too(settings);
    }
    case v1::LtiPolicy::kBeam: {
      lti::BeamSettings settings;
      in.integer("width", 1, 1'000'000, settings.width);
      return spread_too(settings);
    }
    case v1::LtiPolicy::kRelaxedDp: {
      lti::RelaxedDpSettings settings;
      in.number("alpha", within(1.0, 1e3), 1.0, settings.alpha);
      return {settings};
    }
    case v1::LtiPolicy::kOptimum:
    case v1::LtiPolicy::KIND_NOT_SET:
      break;
  }
  return {lti::OptimumSettings{}};
}

}  // namespace dwell
