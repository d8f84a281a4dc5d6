#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/study/study_report.hpp"

namespace dwell {

/// What the policies of a scheduling problem came to: one JSON object each, whose members are the columns of the table
/// and of the CSV. Numbers stand in the table; lists, and what some policies alone have, below it.
class ProblemReport final : public StudyReport {
 public:
  using Json = nlohmann::ordered_json;

  using Plot = std::function<void(const std::filesystem::path& directory)>;

  /// `config` is the effective one; `head` has what is said of the problem itself, before `policies`.
  ProblemReport(v1::Config config, std::size_t policies, Json head = Json::object());

  /// Draws into the directory that `write` fills.
  void set_plot(Plot plot) { plot_ = std::move(plot); }

  /// The result of the next policy and the time that it took. What `solve` throws is said on stderr.
  void add(const std::string& name, const std::function<Json()>& solve);

  std::string table() const override;
  std::string json() const override;
  std::string csv() const override;
  void write(const std::filesystem::path& directory) const override;
  bool complete() const override { return results_.size() == policies_; }

 private:
  struct Result {
    std::string name;
    Json members;
    double seconds;
  };

  std::vector<std::string> columns() const;
  Json to_json(bool with_times) const;

  v1::Config config_;
  std::size_t policies_;
  Json head_;
  std::vector<Result> results_;
  Plot plot_;
};

}  // namespace dwell
