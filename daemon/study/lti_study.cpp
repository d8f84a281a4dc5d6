// A linear system with several sensors: the schedule of each policy and its cost.

#include "daemon/config/problems.hpp"
#include "daemon/study/lti_plots.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/problem_reader.hpp"
#include "daemon/study/problem_report.hpp"

namespace dwell {
namespace {

using Json = ProblemReport::Json;

Json to_json(const lti::Solution& solution) {
  Json json{{"schedule", solution.schedule},
            {"cost", solution.cost},
            {"final_trace", solution.final_trace},
            {"expanded", solution.expanded}};
  if (!solution.probabilities.empty()) {
    json["probabilities"] = solution.probabilities;
    json["bound"] = solution.bound ? Json(*solution.bound) : Json(nullptr);
  }
  if (!solution.set_sizes.empty()) json["set_sizes"] = solution.set_sizes;
  return json;
}

}  // namespace

std::unique_ptr<StudyReport> study_lti(ParsedConfig config, const StudyRequest& request, const StudyWatch& watch) {
  ProblemReader reader(config, request);
  const lti::Problem problem = read_lti(reader.problem());
  const auto policies = reader.policies(*config.message.mutable_lti()->mutable_policy(), "window",
                                        [&](FieldReader in, v1::LtiPolicy::KindCase kind) {
                                          return read_lti_policy(std::move(in), kind, problem.sensor_count());
                                        });
  reader.check();
  // The same for all: policies draw from common numbers.
  const RandomStream stream = RandomStream(config.message.seed()).fork("schedule");
  auto report = std::make_unique<ProblemReport>(config.message, policies.size());
  std::vector<std::pair<std::string, lti::Solution>> solutions;
  for (const auto& [name, policy] : policies) {
    if (watch.stop) break;
    report->add(name, [&, &name = name, &policy = policy] {
      return to_json(solutions.emplace_back(name, solve(problem, policy, stream)).second);
    });
  }
  report->set_plot([all = std::move(solutions)](const std::filesystem::path& directory) { plot_lti(all, directory); });
  return report;
}

}  // namespace dwell
