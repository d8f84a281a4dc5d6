// A whole scan of the engine: truth, prediction, decision, look, update.

#include <algorithm>
#include <chrono>

#include <benchmark/benchmark.h>

#include "bandit/value_table.hpp"
#include "tests/benchmarks/bench_scene.hpp"

namespace dwell {
namespace {

constexpr int kScans = 500;  // a target at 50 m/s goes 30 km in 600: it stays where the radars see it well

/// Arguments: radars, targets.
void scan(benchmark::State& state, const PolicySettings& policy) {
  EngineConfig config = bench::scene(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  config.policy = policy;
  Engine engine(config);
  for (int i = 0; i < 100; ++i) engine.scan();
  for (auto _ : state) benchmark::DoNotOptimize(engine.scan());
  state.counters["pairs"] = static_cast<double>(engine.last().decision.candidates.size());
}
BENCHMARK_CAPTURE(scan, sa_imm, SaImmSettings{})
    ->Args({3, 3})
    ->Args({3, 30})
    ->Args({3, 100})
    ->Iterations(kScans)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(scan, round_robin, RoundRobinSettings{})
    ->Args({3, 30})
    ->Iterations(kScans)
    ->Unit(benchmark::kMicrosecond);

/// The scans of `index` in real time, all that is asked for built beside them. `answered`: the share that it decided
/// itself, not by orbits.
void scan_index(benchmark::State& state) {
  EngineConfig config = bench::scene(3, static_cast<int>(state.range(0)));
  config.policy = IndexSettings{};
  config.value_table = std::make_shared<ValueTable>(ValueTable::OnDue::kGoOn);
  Engine engine(config);
  const auto build_asked = [&] {
    while (config.value_table->waiting() > 0) config.value_table->build_next();
  };
  for (int i = 0; i < 100; ++i) {
    engine.scan();
    build_asked();
  }
  std::vector<double> microseconds;
  int answered = 0;
  for (auto _ : state) {
    const auto before = std::chrono::steady_clock::now();
    engine.scan();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    state.SetIterationTime(took.count());
    microseconds.push_back(1e6 * took.count());
    if (!engine.last().decision.fell_back) ++answered;
    build_asked();
  }
  std::sort(microseconds.begin(), microseconds.end());
  state.counters["p50_us"] = microseconds[microseconds.size() / 2];
  state.counters["p99_us"] = microseconds[microseconds.size() * 99 / 100];
  state.counters["answered"] = answered / static_cast<double>(microseconds.size());
}
BENCHMARK(scan_index)
    ->Arg(3)
    ->Arg(30)
    ->Arg(100)
    ->Arg(300)
    ->Iterations(kScans)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace dwell
