#include "daemon/config/problems.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

Range probability() { return within(0.0, 1.0); }

void read_sensor(FieldReader in, int states, hmm_selection::Sensor& sensor) {
  const int symbols = std::max(1, in.count("emission") / states);
  sensor.emission = read_matrix(in, "emission", probability(), states, symbols);
  in.number("cost", cost(), 1.0, sensor.cost);
}

}  // namespace

hmm_selection::Problem read_hmm_selection(FieldReader in) {
  hmm_selection::Problem problem;
  in.required("horizon");
  problem.horizon = 1;
  in.integer("horizon", 1, hmm_selection::kMaximumHorizon, problem.horizon);
  in.number("beta", above(0.0, 1e12), 1.0, problem.beta);
  const int side = side_of(in, "transition");
  const int states = side > 0 ? side : in.count("belief");
  if (states == 0 || states > hmm_selection::kMaximumStates) {
    in.refuse(
        "transition", std::to_string(in.count("transition")) + " values",
        "must be square, s x s values row-major with s from 1 to " + std::to_string(hmm_selection::kMaximumStates));
    return problem;
  }
  problem.transition = read_matrix(in, "transition", probability(), states, states);
  problem.belief = read_matrix(in, "belief", probability(), 1, states).row(0);
  for (int u = 0; u < in.count("sensor"); ++u) {
    read_sensor(in.element("sensor", u), states, problem.sensors.emplace_back());
  }
  for (const Violation& violation : validate(problem)) in.refuse(violation);
  return problem;
}

hmm_selection::PolicySettings read_hmm_selection_policy(FieldReader in, v1::HmmSelectionPolicy::KindCase kind,
                                                        int sensors) {
  switch (kind) {
    case v1::HmmSelectionPolicy::kRoundRobin:
      return hmm_selection::RoundRobinSettings{};
    case v1::HmmSelectionPolicy::kFixed: {
      hmm_selection::FixedSettings settings;
      in.integer("sensor", 1, std::max(1, sensors), settings.sensor);
      return settings;
    }
    case v1::HmmSelectionPolicy::kWindow: {
      hmm_selection::WindowSettings settings;
      in.integer("d", 1, 20, settings.d);
      return settings;
    }
    case v1::HmmSelectionPolicy::kOptimum:
    case v1::HmmSelectionPolicy::KIND_NOT_SET:
      break;
  }
  return hmm_selection::OptimumSettings{};
}

}  // namespace dwell
