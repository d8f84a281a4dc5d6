// What `index` takes to decide, and how often it answers itself, beside a builder of value sets.

#include <algorithm>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bandit/catalogue.hpp"
#include "bandit/value_table.hpp"
#include "daemon/config/config_reader.hpp"
#include "daemon/study/run_metrics.hpp"
#include "tests/benchmarks/bench_scene.hpp"

namespace dwell {
namespace {

constexpr int kWarmUp = 100;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Scans as in real time: after each, sets are built for so many seconds of processor time, and what a set takes beyond
/// is taken from the next scans. `answered`: the share of scans after the warm-up that `index` decided, not orbits.
void decide(benchmark::State& state, EngineConfig config, double seconds_a_scan) {
  config.policy = IndexSettings{};
  config.value_table = std::make_shared<ValueTable>(ValueTable::OnDue::kGoOn);
  std::vector<double> decision_us;
  Engine engine(config);
  engine.set_policy(timed(make_policy(config.policy), decision_us));
  double left_s = 0.0;
  double built_s = 0.0;
  const auto scan = [&] {
    engine.scan();
    left_s = std::min(left_s + seconds_a_scan, seconds_a_scan);
    const double before = thread_seconds();
    double spent = 0.0;
    while (spent < left_s && config.value_table->waiting() > 0) {
      config.value_table->build_next();
      spent = thread_seconds() - before;
    }
    left_s -= spent;
    built_s += spent;
  };
  for (int i = 0; i < kWarmUp; ++i) scan();
  decision_us.clear();
  built_s = 0.0;
  int answered = 0;
  for (auto _ : state) {
    scan();
    state.SetIterationTime(1e-6 * decision_us.back());
    if (!engine.last().decision.fell_back) ++answered;
  }
  std::sort(decision_us.begin(), decision_us.end());
  const auto scans = static_cast<double>(decision_us.size());
  state.counters["p50_us"] = decision_us[decision_us.size() / 2];
  state.counters["p99_us"] = decision_us[decision_us.size() * 99 / 100];
  state.counters["answered"] = answered / scans;
  state.counters["built_ms_a_scan"] = 1e3 * built_s / scans;
}

/// Argument: targets, that cruise among three radars.
void index_cruising(benchmark::State& state) { decide(state, bench::scene(3, static_cast<int>(state.range(0))), 1.0); }
BENCHMARK(index_cruising)
    ->Arg(3)
    ->Arg(30)
    ->Arg(100)
    ->Arg(300)
    ->Iterations(500)  // a target at 50 m/s goes 30 km in 600: it stays where the radars see it well
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

/// Argument: percent of a processor that builds sets, with scans of 1 s.
void index_thirty_flights(benchmark::State& state) {
  const std::string file = std::string(DWELL_SOURCE_DIR) + "/daemon/scenarios/thirty_flights.textproto";
  decide(state, read_config_file(file).engine, 0.01 * static_cast<double>(state.range(0)));
}
BENCHMARK(index_thirty_flights)->Arg(100)->Arg(25)->Iterations(300)->UseManualTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace dwell
