// Hidden Markov arms that stand still unless they are played: the Gittins index of each at its belief.

#include <spdlog/fmt/fmt.h>

#include "bandit/hmm_bandit/gittins.hpp"
#include "daemon/config/problems.hpp"
#include "daemon/study/problem_kinds.hpp"
#include "daemon/study/problem_reader.hpp"
#include "daemon/study/problem_report.hpp"

namespace dwell {
namespace {

/// All that can be asked for, and what is answered where nothing is.
constexpr const char* kIndex = "gittins_hmm";

}  // namespace

std::unique_ptr<StudyReport> study_hmm_bandit(ParsedConfig config, const StudyRequest& request,
                                              const StudyWatch& watch) {
  using Json = ProblemReport::Json;
  ProblemReader reader(config, request);
  const hmm_bandit::Problem problem = read_hmm_bandit(reader.problem());
  for (const std::string& name : request.policies) {
    if (name != kIndex) reader.refuse_policy({"policy", name, std::string("must be one of: ") + kIndex});
  }
  reader.check();
  Json head{{"arms", Json::array()}};
  for (std::size_t i = 0; i < problem.arms.size() && !watch.stop; ++i) {
    const hmm_bandit::Arm& arm = problem.arms[i];
    const hmm_bandit::GittinsResult result = hmm_bandit::gittins_index(arm, arm.belief, problem.discount);
    head["arms"].push_back({{"index", {{kIndex, result.index}}}});
    if (result.converged) continue;
    head["arms"].back()["converged"] = false;
    fmt::print(stderr, "hmm_bandit.arm[{}]: the index has not converged: it may be above {}\n", i + 1, result.index);
  }
  return std::make_unique<ProblemReport>(config.message, watch.stop ? 1 : 0, head);
}

}  // namespace dwell
