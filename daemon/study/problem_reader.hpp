#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/config/policy_text.hpp"
#include "daemon/study/problem_kinds.hpp"

namespace dwell {

/// Reads a scheduling problem and the policies it is studied under, all violations together.
///
///     ProblemReader reader(config, request);
///     const lti::Problem problem = read_lti(reader.problem());
///     const auto policies = reader.policies(list, "window", read);
///     reader.check();
class ProblemReader {
 public:
  /// Both outlive it. `config` becomes the effective one; what stands beside the problem but for the seed is refused.
  ProblemReader(ParsedConfig& config, const StudyRequest& request);

  FieldReader problem() { return top().child(name_.c_str()); }

  /// The policies by name, (name, read(reader of the parameters, kind)): those of the command line where it names some,
  /// which then replace those in `list`, the problem's field `policy`; the fallback where neither has any.
  template <class Policies, class Read>
  auto policies(Policies& list, const char* fallback, const Read& read) {
    std::vector<std::string> texts = request_.policies;
    const bool of_command_line = !texts.empty();
    if (!of_command_line && list.empty()) texts.emplace_back(fallback);
    std::vector<std::string> names;
    if (texts.empty()) {
      for (const auto& policy : list) names.push_back(policy_text(policy));
    } else {
      list.Clear();
      for (const std::string& text : texts) {
        typename Policies::value_type policy;
        if (!parse_policy(text, policy, of_command_line_)) continue;
        *list.Add() = std::move(policy);
        names.push_back(text);
      }
    }
    using Settings = decltype(read(problem(), list[0].kind_case()));
    std::vector<std::pair<std::string, Settings>> settings;
    for (int i = 0; i < list.size(); ++i) {
      FieldReader in =
          of_command_line ? FieldReader(*list.Mutable(i), nullptr, of_command_line_) : problem().element("policy", i);
      const auto* kind = policy_kind(list[i]);
      if (kind == nullptr) {
        refuse_empty_policy(i, "must be one of: " + policy_names(list[i]));
      } else {
        settings.emplace_back(names[static_cast<std::size_t>(i)],
                              read(in.child(kind->name().c_str()), list[i].kind_case()));
      }
    }
    return settings;
  }

  /// Of a problem whose policies are no messages.
  void refuse_policy(Violation violation) { of_command_line_.push_back(std::move(violation)); }

  /// Errors   InvalidInput where anything was refused.
  void check() const;

 private:
  /// `policy {}` of the config, counted from 0.
  void refuse_empty_policy(int index, const std::string& rule);

  FieldReader top() { return {config_.message, config_.locations.get(), of_config_}; }

  ParsedConfig& config_;
  const StudyRequest& request_;
  std::string name_;
  std::vector<Violation> of_config_;
  std::vector<Violation> of_command_line_;
};

}  // namespace dwell
