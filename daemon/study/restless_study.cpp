// Restless arms: the bound, the index of each arm at its start, and what each policy costs.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "bandit/restless/bound.hpp"
#include "bandit/restless/index_table.hpp"
#include "bandit/restless/simulate.hpp"
#include "daemon/config/problems.hpp"
#include "daemon/study/monte_carlo.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/problem_reader.hpp"
#include "daemon/study/problem_report.hpp"

namespace dwell {
namespace {

using Json = ProblemReport::Json;

const char* name_of(restless::BoundKind kind) {
  switch (kind) {
    case restless::BoundKind::kExact:
      return "exact";
    case restless::BoundKind::kCertified:
      return "certified";
    case restless::BoundKind::kReference:
      break;
  }
  return "reference";
}

bool whittle_applies(const restless::Arm& arm) { return arm.states() == 1 && arm.q(0, 0) > 0.0; }

Json index_json(const restless::Problem& problem, const restless::Analysis& analysis, std::size_t i) {
  const restless::Arm& arm = problem.arms[i];
  Json whittle = Json::array();
  Json orbit = Json::array();
  Json index = Json::array();
  for (std::size_t s = 0; s < arm.sensors.size(); ++s) {
    if (whittle_applies(arm) && arm.p0(0, 0) > 0.0) {
      whittle.push_back(restless::whittle_of(arm, s, problem.discount, arm.p0(0, 0)));
    }
    orbit.push_back(restless::orbit_index(arm, s, arm.p0));
    if (!analysis.priced.values.empty()) index.push_back(restless::advantage(problem, analysis.priced, i, s));
  }
  Json json = Json::object();
  if (!whittle.empty()) json["whittle"] = whittle;
  json["orbit"] = orbit;
  if (!index.empty()) json["index"] = index;
  return {{"index", json}};
}

/// What Whittle's index of an arm must be and is not; empty: nothing.
Json indexability_json(const restless::Arm& arm, std::optional<double> discount) {
  const auto report = restless::check_indexability(arm, discount);
  if (!report || (report->indexable && report->monotone)) return {};
  return {{"indexable", report->indexable}, {"monotone", report->monotone}, {"at", report->offenders}};
}

Json bound_json(const restless::Bound& bound) {
  Json json{{"value", bound.value}, {"kind", name_of(bound.kind)}, {"price", bound.price}};
  if (bound.reference) json["reference"] = *bound.reference;
  return json;
}

bool draws(const restless::Problem& problem) {
  for (const restless::Arm& arm : problem.arms) {
    for (const restless::Sensor& sensor : arm.sensors) {
      if (sensor.p_detect < 1.0) return true;
    }
  }
  return false;
}

Json run_policy(const restless::Problem& problem, const restless::Analysis& analysis,
                const restless::PolicySettings& settings, int runs, const RandomStream& stream) {
  std::vector<double> costs;
  std::vector<double> rates(problem.arms.size(), 0.0);
  const auto policy = restless::make_policy(settings, problem, analysis.priced);
  for (int run = 0; run < runs; ++run) {
    restless::SimulationSettings simulation;
    simulation.random = stream.fork(static_cast<std::uint64_t>(run));
    const restless::Simulated result = restless::simulate(problem, *policy, simulation);
    costs.push_back(result.cost);
    for (std::size_t i = 0; i < rates.size(); ++i) rates[i] += result.look_rate[i] / runs;
  }
  const Estimate cost = estimate(costs);
  if (!std::isfinite(cost.mean)) throw std::runtime_error("the cost grows without end");
  Json json{{problem.discount ? "discounted_cost" : "average_cost", cost.mean}};
  if (analysis.bound.value > 0.0) json["gap_percent"] = 100.0 * (cost.mean / analysis.bound.value - 1.0);
  if (runs > 1) json["stderr"] = cost.standard_error;
  json["look_rate"] = rates;
  return json;
}

}  // namespace

std::unique_ptr<StudyReport> study_restless(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch) {
  ProblemReader reader(config, request);
  const restless::Problem problem = read_restless(reader.problem());
  const bool scalar = std::all_of(problem.arms.begin(), problem.arms.end(), whittle_applies);
  const auto policies =
      reader.policies(*config.message.mutable_restless()->mutable_policy(), "index", read_restless_policy);
  for (const auto& [name, settings] : policies) {
    if (std::holds_alternative<restless::WhittleSettings>(settings) && !scalar) {
      reader.problem().refuse("policy", name, "requires arms of one state with process noise above 0");
    }
  }
  reader.check();
  restless::AnalysisSettings wanted;
  wanted.values = std::any_of(policies.begin(), policies.end(),
                              [](const auto& policy) { return restless::needs_prices(policy.second); });
  wanted.stop = [&] { return watch.stop.load(); };
  restless::Analysis analysis;
  try {
    analysis = restless::analyse(problem, wanted);
    analysis.bound = restless::certify(problem, analysis, wanted.stop);
  } catch (const restless::Stopped&) {
    fmt::print(stderr, "stopped before the bound was found\n");
    return std::make_unique<ProblemReport>(config.message, policies.size());
  } catch (const std::domain_error& error) {
    reader.problem().refuse("arm", "the problem", error.what());
    reader.check();
  }
  Json head{{"bound", bound_json(analysis.bound)}};
  head["arms"] = Json::array();
  for (std::size_t i = 0; i < problem.arms.size(); ++i) {
    head["arms"].push_back(index_json(problem, analysis, i));
    const Json indexability = indexability_json(problem.arms[i], problem.discount);
    if (indexability.is_null()) continue;
    head["arms"].back()["indexability"] = indexability;
    fmt::print(stderr, "restless.arm[{}]: Whittle's index is not what it must be: {}\n", i + 1, indexability.dump());
  }
  auto report = std::make_unique<ProblemReport>(config.message, policies.size(), head);
  const int runs = draws(problem) ? request.runs : 1;
  if (draws(problem) && runs == 1) fmt::print(stderr, "one run with looks that miss: no standard error\n");
  const RandomStream stream = RandomStream(config.message.seed()).fork("restless");
  for (const auto& [name, settings] : policies) {
    if (watch.stop) break;
    report->add(name, [&, &settings = settings] { return run_policy(problem, analysis, settings, runs, stream); });
  }
  return report;
}

}  // namespace dwell
