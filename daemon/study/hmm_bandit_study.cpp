// Hidden Markov arms that stand still unless they are played: the Gittins index of each at its belief.

#include "bandit/hmm_bandit/gittins.hpp"
#include "daemon/config/problems.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/problem_reader.hpp"
#include "daemon/study/problem_report.hpp"

namespace dwell {

std::unique_ptr<StudyReport> study_hmm_bandit(ParsedConfig config, const StudyRequest& request,
                                              const StudyWatch& /*watch*/) {
  using Json = ProblemReport::Json;
  ProblemReader reader(config, request);
  const hmm_bandit::Problem problem = read_hmm_bandit(reader.problem());
  reader.check();
  Json head{{"arms", Json::array()}};
  for (const hmm_bandit::Arm& arm : problem.arms) {
    const double index = hmm_bandit::gittins_index(arm, arm.belief, problem.discount).index;
    head["arms"].push_back({{"index", {{"gittins_hmm", index}}}});
  }
  return std::make_unique<ProblemReport>(config.message, 0, head);
}

}  // namespace dwell
