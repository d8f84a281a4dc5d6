#include "daemon/study/problem_report.hpp"

#include <algorithm>
#include <chrono>

#include <spdlog/fmt/fmt.h>

namespace dwell {
namespace {

using Json = ProblemReport::Json;

/// As JSON writes it, a list without its brackets and commas, what is not there empty.
std::string cell(const Json& members, const std::string& column) {
  const auto member = members.find(column);
  if (member == members.end() || member->is_null()) return "";
  if (!member->is_array()) return member->is_string() ? member->get<std::string>() : member->dump();
  std::string text;
  for (const Json& element : *member) text += (text.empty() ? "" : " ") + element.dump();
  return text;
}

}  // namespace

ProblemReport::ProblemReport(v1::Config config, std::size_t policies, Json head)
    : config_(std::move(config)), policies_(policies), head_(std::move(head)) {}

void ProblemReport::add(const std::string& name, const std::function<Json()>& solve) {
  try {
    const auto start = std::chrono::steady_clock::now();
    Json members = solve();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    results_.push_back({name, std::move(members), spent.count()});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
  }
}

/// The members that any policy has, in order of appearance.
std::vector<std::string> ProblemReport::columns() const {
  std::vector<std::string> names;
  for (const Result& result : results_) {
    for (const auto& [name, value] : result.members.items()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

std::string ProblemReport::table() const {
  std::vector<std::string> scalars;
  std::vector<std::string> below;
  for (const std::string& column : columns()) {
    const bool scalar = std::all_of(results_.begin(), results_.end(), [&](const Result& result) {
      return result.members.contains(column) && !result.members[column].is_structured();
    });
    (scalar ? scalars : below).push_back(column);
  }
  std::size_t width = 6;
  for (const Result& result : results_) width = std::max(width, result.name.size());
  std::string text;
  for (const auto& [name, value] : head_.items()) text += name + " " + value.dump() + "\n";
  text += fmt::format("{:<{}}", "policy", width);
  for (const std::string& column : scalars) text += fmt::format("  {:>20}", column);
  text += fmt::format("  {:>10}\n", "seconds");
  for (const Result& result : results_) {
    text += fmt::format("{:<{}}", result.name, width);
    for (const std::string& column : scalars) text += fmt::format("  {:>20}", cell(result.members, column));
    text += fmt::format("  {:>10.3g}\n", result.seconds);
  }
  for (const std::string& column : below) {
    text += "\n" + column + "\n";
    for (const Result& result : results_) {
      if (const std::string value = cell(result.members, column); !value.empty()) {
        text += fmt::format("{:<{}}  {}\n", result.name, width, value);
      }
    }
  }
  return text;
}

std::string ProblemReport::json() const { return to_json(true).dump(2) + "\n"; }

std::string ProblemReport::csv() const {
  std::string text = "policy";
  for (const std::string& column : columns()) text += "," + column;
  text += '\n';
  for (const Result& result : results_) {
    text += '"' + result.name + '"';
    for (const std::string& column : columns()) text += "," + cell(result.members, column);
    text += '\n';
  }
  return text;
}

void ProblemReport::write(const std::filesystem::path& directory) const {
  std::filesystem::create_directories(directory);
  write_file(directory / "results.json", to_json(false).dump(2) + "\n");
  write_file(directory / "results.csv", csv());
  Json times = Json::object();
  for (const Result& result : results_) times[result.name] = {{"seconds", result.seconds}};
  write_file(directory / "times.json", times.dump(2) + "\n");
  write_config(directory, config_);
  if (plot_) plot_(directory);
}

Json ProblemReport::to_json(bool with_times) const {
  Json json = head_;
  json["policies"] = Json::array();
  for (const auto& [name, members, seconds] : results_) {
    Json policy{{"name", name}};
    policy.update(members);
    if (with_times) policy["seconds"] = seconds;
    json["policies"].push_back(std::move(policy));
  }
  return json;
}

}  // namespace dwell
