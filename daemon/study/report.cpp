#include "daemon/study/report.hpp"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "daemon/study/plots.hpp"
#include "daemon/study/study_report.hpp"

namespace dwell {
namespace {

using Json = nlohmann::ordered_json;

bool starts_with(const std::string& text, const std::string& prefix) { return text.rfind(prefix, 0) == 0; }
bool is_total(const std::string& metric) { return metric.find('.') == std::string::npos; }

double quantile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

Json decision_times(const PolicyOutcome& policy) {
  return {{"p50", quantile(policy.decision_us, 0.50)}, {"p99", quantile(policy.decision_us, 0.99)}};
}

Json policy_json(const Study& study, const PolicyOutcome& policy, bool with_times) {
  Json metrics = Json::object();
  Json by_radar = Json::object();
  Json by_track = Json::object();
  for (std::size_t m = 0; m < study.metrics.size(); ++m) {
    const std::string& name = study.metrics[m];
    const Estimate value = estimate(policy.of_metric(m));
    const Json both{{"mean", value.mean}, {"stderr", value.standard_error}};
    if (starts_with(name, "looks.radar.")) {
      by_radar[name.substr(12)] = both;
    } else if (starts_with(name, "looks.track.")) {
      by_track[name.substr(12)] = both;
    } else {
      metrics[name] = both;
    }
  }
  Json series = Json::array();
  for (const SeriesPoint& point : policy.series) {
    series.push_back({{"time_s", point.time_s},
                      {"x_rms_m", point.x_rms_m},
                      {"y_rms_m", point.y_rms_m},
                      {"position_rms_m", point.position_rms_m},
                      {"filter_sigma_m", point.filter_sigma_m}});
  }
  Json json{{"name", policy.name},
            {"metrics", metrics},
            {"looks", {{"by_radar", by_radar}, {"by_track", by_track}}},
            {"series", series}};
  if (with_times) json["decision_time_us"] = decision_times(policy);
  return json;
}

std::string pair_line(const Study& study, const PairedDifference& pair) {
  const char* verdict = pair.low > 0.0 ? "worse" : pair.high < 0.0 ? "better" : "no clear difference";
  return fmt::format("  {} - {}: {:+.4g} [{:+.4g}, {:+.4g}], {} better in {:.0f} % of runs: {}\n",
                     study.policies[pair.a].name, study.policies[pair.b].name, pair.mean, pair.low, pair.high,
                     study.policies[pair.a].name, 100.0 * pair.a_better_share, verdict);
}

}  // namespace

std::string study_table(const Study& study) {
  std::size_t width = 12;
  for (const std::string& metric : study.metrics) width = std::max(width, metric.size());
  std::string text = fmt::format("{} runs of {} scans, seeds from {}; mean (standard error)\n\n{:<{}}", study.runs_done,
                                 study.options.scans, study.options.seed, "", width);
  for (const PolicyOutcome& policy : study.policies) text += fmt::format("  {:>24}", policy.name);
  text += '\n';
  for (std::size_t m = 0; m < study.metrics.size(); ++m) {
    text += fmt::format("{:<{}}", study.metrics[m], width);
    for (const PolicyOutcome& policy : study.policies) {
      const Estimate value = estimate(policy.of_metric(m));
      text += fmt::format("  {:>24}", fmt::format("{:.4g} ({:.2g})", value.mean, value.standard_error));
    }
    text += '\n';
  }
  text += fmt::format("{:<{}}", "decision us p50/p99", width);
  for (const PolicyOutcome& policy : study.policies) {
    text += fmt::format("  {:>24}", fmt::format("{:.1f} / {:.1f}", quantile(policy.decision_us, 0.50),
                                                quantile(policy.decision_us, 0.99)));
  }
  text += '\n';
  for (const char* metric : {"position_mse_m2", "weighted_mse_m2", "weighted_variance_m2", "tracks_lost"}) {
    const auto place = std::find(study.metrics.begin(), study.metrics.end(), metric) - study.metrics.begin();
    const auto pairs = paired_differences(study, static_cast<std::size_t>(place));
    if (!pairs.empty()) text += fmt::format("\n{}, paired by run, 95 % interval:\n", metric);
    for (const PairedDifference& pair : pairs) text += pair_line(study, pair);
  }
  return text;
}

std::string study_json(const Study& study, bool with_times) {
  Json json{{"runs", study.runs_done}, {"seed", study.options.seed}, {"scans", study.options.scans}};
  json["policies"] = Json::array();
  for (const PolicyOutcome& policy : study.policies) {
    json["policies"].push_back(policy_json(study, policy, with_times));
  }
  json["paired"] = Json::array();
  for (std::size_t m = 0; m < study.metrics.size(); ++m) {
    if (!is_total(study.metrics[m])) continue;
    for (const PairedDifference& pair : paired_differences(study, m)) {
      json["paired"].push_back({{"a", study.policies[pair.a].name},
                                {"b", study.policies[pair.b].name},
                                {"metric", study.metrics[m]},
                                {"mean_difference", pair.mean},
                                {"ci95", {pair.low, pair.high}},
                                {"a_better_share", pair.a_better_share}});
    }
  }
  return json.dump(2) + "\n";
}

std::string study_csv(const Study& study) {
  std::string text = "policy,run";
  for (const std::string& metric : study.metrics) text += "," + metric;
  text += '\n';
  for (const PolicyOutcome& policy : study.policies) {
    for (std::size_t run = 0; run < policy.figures.size(); ++run) {
      text += fmt::format("\"{}\",{}", policy.name, run + 1);
      for (const double value : policy.figures[run]) text += fmt::format(",{}", value);
      text += '\n';
    }
  }
  return text;
}

void write_study(const Study& study, const v1::Config& config, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  write_file(directory / "results.json", study_json(study, false));
  write_file(directory / "results.csv", study_csv(study));
  Json times = Json::object();
  for (const PolicyOutcome& policy : study.policies) times[policy.name] = decision_times(policy);
  write_file(directory / "times.json", times.dump(2) + "\n");
  write_config(directory, config);
  plot_study(study, directory);
}

}  // namespace dwell
