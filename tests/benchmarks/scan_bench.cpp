// A whole scan of the engine: truth, prediction, decision, look, update.

#include <benchmark/benchmark.h>

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

}  // namespace
}  // namespace dwell
