#include "daemon/config/parsed_config.hpp"

#include <fstream>
#include <sstream>

#include <google/protobuf/io/tokenizer.h>

#include "radar/violation.hpp"

namespace dwell {
namespace {

class SyntaxErrors : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int line, google::protobuf::io::ColumnNumber column, const std::string& message) override {
    violations.push_back({"syntax", "", message, line + 1, column + 1});
  }
  std::vector<Violation> violations;
};

}  // namespace

ParsedConfig parse_config_text(const std::string& text, const std::string& source,
                               const std::filesystem::path& directory) {
  ParsedConfig parsed{{}, std::make_unique<FieldReader::Locations>(), source, directory};
  SyntaxErrors errors;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&errors);
  parser.WriteLocationsTo(parsed.locations.get());
  if (!parser.ParseFromString(text, &parsed.message)) throw InvalidInput(source, std::move(errors.violations));
  return parsed;
}

ParsedConfig parse_config_file(const std::filesystem::path& file) {
  std::ifstream input(file);
  if (!input || std::filesystem::is_directory(file)) {
    throw InvalidInput(file.string(), {{"file", "", "cannot be read"}});
  }
  std::ostringstream text;
  text << input.rdbuf();
  return parse_config_text(text.str(), file.string(), file.parent_path());
}

std::string problem_of(const v1::Config& config) {
  const auto* problems = v1::Config::descriptor()->FindOneofByName("problem");
  const auto* problem = config.GetReflection()->GetOneofFieldDescriptor(config, problems);
  return problem == nullptr ? "" : problem->name();
}

}  // namespace dwell
