#include "daemon/study/problem_reader.hpp"

namespace dwell {

ProblemReader::ProblemReader(ParsedConfig& config, const StudyRequest& request)
    : config_(config), request_(request), name_(problem_of(config.message)) {
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  config.message.GetReflection()->ListFields(config.message, &fields);
  if (request.seed || !config.message.has_seed()) config.message.set_seed(request.seed.value_or(1));
  for (const auto* field : fields) {
    if (field->name() == name_ || field->name() == "seed") continue;
    top().refuse(field->name().c_str(), "",
                 "must not stand beside " + name_ + ": a config is a scenario or one problem");
  }
}

void ProblemReader::refuse_empty_policy(int index, const std::string& rule) {
  const auto* problem = config_.message.GetDescriptor()->FindFieldByName(name_);
  const auto* policy = problem->message_type()->FindFieldByName("policy");
  Violation violation{name_ + ".policy[" + std::to_string(index + 1) + "]", "", rule};
  if (const auto* tree = config_.locations ? config_.locations->GetTreeForNested(problem, -1) : nullptr) {
    const auto place = tree->GetLocation(policy, index);
    violation.line = place.line + 1;
    violation.column = place.column + 1;
  }
  of_config_.push_back(std::move(violation));
}

void ProblemReader::check() const {
  if (of_config_.empty() && of_command_line_.empty()) return;
  if (of_config_.empty()) throw InvalidInput("--policies", of_command_line_);
  std::vector<Violation> all = of_config_;
  for (Violation violation : of_command_line_) {
    violation.field = "--policies: " + violation.field;
    all.push_back(std::move(violation));
  }
  throw InvalidInput(config_.source, std::move(all));
}

}  // namespace dwell
