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
