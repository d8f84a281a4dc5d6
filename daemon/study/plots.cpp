#include "daemon/study/plots.hpp"

#include <algorithm>
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include "daemon/study/gnuplot.hpp"

namespace dwell {
namespace {

void write_series(const Study& study, const std::filesystem::path& file) {
  std::ofstream out(file);
  for (const PolicyOutcome& policy : study.policies) {
    out << "\"" << policy.name << "\"\n# time_s position_rms_m low high filter_sigma_m\n";
    for (const SeriesPoint& point : policy.series) {
      out << fmt::format("{} {} {} {} {}\n", point.time_s, point.position_rms_m, point.position_rms_low_m,
                         point.position_rms_high_m, point.filter_sigma_m);
    }
    out << "\n\n";
  }
}

void write_schedules(const Study& study, const std::filesystem::path& file) {
  std::ofstream out(file);
  for (const PolicyOutcome& policy : study.policies) {
    out << "\"" << policy.name << "\"\n# time_s sensor track\n";
    for (std::size_t scan = 0; scan < policy.first_run.size(); ++scan) {
      const ScanSample& sample = policy.first_run[scan];
      if (sample.sensor == 0) continue;
      out << fmt::format("{} {} {}\n", policy.series[scan].time_s, sample.sensor, sample.track);
    }
    out << "\n\n";
  }
}

std::string error_script(std::size_t policies) {
  std::string text = std::string(kSvg) +
                     "set output 'error_over_time.svg'\nset xlabel 'time, s'\n"
                     "set ylabel 'position RMS over runs and tracks, m'\nset logscale y\nplot \\\n";
  for (std::size_t p = 0; p < policies; ++p) {
    text += fmt::format(
        "  'series.dat' index {0} using 1:3:4 with filledcurves fs transparent solid 0.2 noborder lc {1} notitle, \\\n"
        "  '' index {0} using 1:2 with lines lw 2 lc {1} title columnheader(1){2}\n",
        p, p + 1, p + 1 < policies ? ", \\" : "");
  }
  return text;
}

std::string schedule_script(const Study& study) {
  const std::size_t policies = study.policies.size();
  std::string text = fmt::format(
      "set terminal svg size 900,{} noenhanced background 'white'\nset output 'schedule.svg'\n"
      "set multiplot layout {},1\nset xlabel 'time, s'\nset ylabel 'track'\nset ytics 1\nset key outside\n"
      "set offsets 0,0,0.5,0.5\n",
      220 * policies, policies);
  for (std::size_t p = 0; p < policies; ++p) {
    text += fmt::format(
        "set title '{}: sensor by colour'\nplot 'schedule.dat' index {} using 1:3:2 with points pt 5 ps 0.6 lc "
        "variable notitle\n",
        study.policies[p].name, p);
  }
  return text + "unset multiplot\n";
}

}  // namespace

void plot_study(const Study& study, const std::filesystem::path& directory) {
  const bool empty = std::any_of(study.policies.begin(), study.policies.end(),
                                 [](const PolicyOutcome& policy) { return policy.series.empty(); });
  if (empty) return;
  write_series(study, directory / "series.dat");
  write_schedules(study, directory / "schedule.dat");
  std::ofstream(directory / "error_over_time.gp") << error_script(study.policies.size());
  std::ofstream(directory / "schedule.gp") << schedule_script(study);
  run_gnuplot(directory, "error_over_time.gp");
  run_gnuplot(directory, "schedule.gp");
}

}  // namespace dwell
