// A Markov chain with several sensors: the expected cost of each policy.

#include "daemon/config/problems.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/problem_reader.hpp"
#include "daemon/study/problem_report.hpp"

namespace dwell {

std::unique_ptr<StudyReport> study_hmm_selection(ParsedConfig config, const StudyRequest& request,
                                                 const StudyWatch& watch) {
  ProblemReader reader(config, request);
  const hmm_selection::Problem problem = read_hmm_selection(reader.problem());
  const auto policies = reader.policies(*config.message.mutable_hmm_selection()->mutable_policy(), "window",
                                        [&](FieldReader in, v1::HmmSelectionPolicy::KindCase kind) {
                                          return read_hmm_selection_policy(std::move(in), kind, problem.sensor_count());
                                        });
  reader.check();
  const RandomStream stream = RandomStream(config.message.seed()).fork("symbols");
  auto report = std::make_unique<ProblemReport>(config.message, policies.size());
  for (const auto& [name, policy] : policies) {
    if (watch.stop) break;
    report->add(name, [&, &policy = policy] {
      const hmm_selection::Solution solution = solve(problem, policy, std::max(2, request.runs), stream);
      return ProblemReport::Json{{"cost", solution.cost},
                                 {"stderr", solution.standard_error},
                                 {"first", solution.first},
                                 {"looks", solution.looks},
                                 {"expanded", solution.expanded}};
    });
  }
  return report;
}

}  // namespace dwell
