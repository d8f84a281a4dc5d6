#include "daemon/config/problems.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

constexpr int kMaximumArms = 1000;

Range probability() { return within(0.0, 1.0); }

bool read_arm(FieldReader in, hmm_bandit::Arm& arm) {
  const int side = side_of(in, "transition");
  const int states = side > 0 ? side : in.count("belief");
  if (states == 0 || states > hmm_bandit::kMaximumStates) {
    in.refuse("transition", std::to_string(in.count("transition")) + " values",
              "must be square, n x n values row-major with n from 1 to " + std::to_string(hmm_bandit::kMaximumStates));
    return false;
  }
  arm.transition = read_matrix(in, "transition", probability(), states, states);
  arm.emission = read_matrix(in, "emission", probability(), states, std::max(1, in.count("emission") / states));
  arm.reward = read_matrix(in, "reward", entry(), 1, states).row(0);
  arm.belief = read_matrix(in, "belief", probability(), 1, states).row(0);
  return true;
}

}  // namespace

hmm_bandit::Problem read_hmm_bandit(FieldReader in) {
  hmm_bandit::Problem problem;
  in.required("discount");
  in.number("discount", between(0.0, 1.0), 1.0, problem.discount);
  const int arms = in.count("arm");
  if (arms > kMaximumArms) {
    in.refuse("arm", std::to_string(arms), "must be at most " + std::to_string(kMaximumArms));
    return problem;
  }
  bool complete = true;
  for (int i = 0; i < arms; ++i) complete = read_arm(in.element("arm", i), problem.arms.emplace_back()) && complete;
  if (!complete) return problem;
  for (const Violation& violation : validate(problem)) in.refuse(violation);
  return problem;
}

}  // namespace dwell
