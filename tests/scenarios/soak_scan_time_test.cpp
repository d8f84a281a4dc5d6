// R31: what a running solve costs the scans. Wall-clock times, so with the long counts alone.

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/scenarios/calibrated_run.hpp"

namespace dwell::testing {
namespace {

struct Times {
  double p50_us;
  double p99_us;
  double largest_us;
  long waits;  ///< of the scans' thread for anything, by the kernel's count
};

long waits_so_far() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

/// Of a scan with all that calibration does between it and the next.
Times measure(const CalibrationLoop::Solve& solver, bool asks) {
  Engine engine(scenario("calibration_traffic", SaImmSettings{}));
  CalibrationLoop loop(engine, solver);
  loop.set_waits(false);
  std::vector<double> times;
  long waits = 0;
  while (engine.last().scan < 20'600) {
    if (asks && engine.last().scan >= 600 && !loop.due()) loop.ask(false);
    const long waits_before = waits_so_far();
    const auto before = std::chrono::steady_clock::now();
    (void)loop.before_scan();
    engine.scan();
    waits += waits_so_far() - waits_before;
    if (asks) loop.after_scan();
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - before;
    if (engine.last().scan > 600) times.push_back(spent.count());
  }
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times[times.size() * 99 / 100], times.back(), waits};
}

TEST(ScanTime, ARunningSolveDelaysNoScan) {
  // One after the other, for as long as the scans go on: asked to stop, it goes on to the end of its solve.
  const auto solves = [](const CalibrationTask& task, const EstimatorSettings& settings) {
    CalibrationOutcome outcome;
    while (!settings.stop()) outcome = solve(task, {});
    return outcome;
  };
  const Times without = measure(solve, false);
  const Times with = measure(solves, true);
  std::printf(
      "scan: p50 %.1f us, p99 %.1f us, largest %.0f us; beside a solve: p50 %.1f us, p99 %.1f us, largest %.0f us, %ld "
      "waits\n",
      without.p50_us, without.p99_us, without.largest_us, with.p50_us, with.p99_us, with.largest_us, with.waits);
  EXPECT_EQ(with.waits, 0);
  // A thousandth of the scan period, where a solve takes a third of a second. On a machine that others keep busy its
  // delays are in both figures, and the solve takes half of what was left.
  EXPECT_LE(with.p99_us, std::max(1000.0, 2.0 * without.p99_us));
}

}  // namespace
}  // namespace dwell::testing
