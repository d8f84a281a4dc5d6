#include "daemon/study/lti_plots.hpp"

#include <fstream>

#include <spdlog/fmt/fmt.h>

#include "daemon/study/gnuplot.hpp"
#include "daemon/study/study_report.hpp"

namespace dwell {

void plot_lti(const std::vector<std::pair<std::string, lti::Solution>>& solutions,
              const std::filesystem::path& directory) {
  if (solutions.empty()) return;
  std::string data;
  std::string lines;
  std::string rows;
  std::string names;
  for (std::size_t p = 0; p < solutions.size(); ++p) {
    const auto& [name, solution] = solutions[p];
    data += fmt::format("\"{}\"\n# step trace row sensor\n", name);
    const std::size_t row = solutions.size() - p;  // the first on top
    for (std::size_t k = 0; k < solution.schedule.size(); ++k) {
      data += fmt::format("{} {} {} {}\n", k + 1, solution.traces[k], row, solution.schedule[k]);
    }
    data += "\n\n";
    const char* next = p + 1 < solutions.size() ? ", \\\n  " : "\n";
    lines += fmt::format("'lti.dat' index {} using 1:2 with steps lw 2 title columnheader(1){}", p, next);
    rows += fmt::format("'lti.dat' index {} using 1:3:4 with points pt 5 ps 0.8 lc variable notitle{}", p, next);
    names += fmt::format("{}\"{}\" {}", p == 0 ? "" : ", ", name, row);
  }
  write_file(directory / "lti.dat", data);
  write_file(directory / "trace_over_steps.gp",
             std::string(kSvg) +
                 "set output 'trace_over_steps.svg'\nset xlabel 'step'\n"
                 "set ylabel 'trace of the covariance'\nset logscale y\nplot \\\n  " +
                 lines);
  write_file(directory / "schedule.gp",
             std::string(kSvg) +
                 "set output 'schedule.svg'\nset xlabel 'step'\nset title 'sensor by colour'\n"
                 "set offsets 0,0,0.5,0.5\nset ytics (" +
                 names + ")\nplot \\\n  " + rows);
  run_gnuplot(directory, "trace_over_steps.gp");
  run_gnuplot(directory, "schedule.gp");
}

}  // namespace dwell
