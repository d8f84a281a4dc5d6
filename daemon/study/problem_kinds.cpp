#include "daemon/study/problem_kinds.hpp"

#include <algorithm>

#include "radar/assert.hpp"

namespace dwell {
namespace {

constexpr ProblemKind kKinds[] = {
    {"", study_scenario},
    {"lti", study_lti},
    {"hmm_selection", study_hmm_selection},
    {"restless", study_restless},
    {"hmm_bandit", study_hmm_bandit},
};

}  // namespace

const ProblemKind& kind_of(const v1::Config& config) {
  const std::string name = problem_of(config);
  const auto* kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const ProblemKind& candidate) { return name == candidate.name; });
  DWELL_ASSERT(kind != std::end(kKinds));  // a problem of the schema without a row
  return *kind;
}

}  // namespace dwell
