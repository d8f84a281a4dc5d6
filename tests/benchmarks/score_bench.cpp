// The expected cost of one (radar, track) pair.

#include <benchmark/benchmark.h>

#include "bandit/expected_cost.hpp"
#include "tests/benchmarks/bench_scene.hpp"

namespace dwell {
namespace {

/// Arguments: nodes on each axis. The track is that of a scene after 60 scans.
void pair_score(benchmark::State& state) {
  Engine engine(bench::scene(3, 3));
  for (int i = 0; i < 60; ++i) engine.scan();
  ExpectedCost expected_cost({position_weight(), 0.0}, static_cast<int>(state.range(0)));
  const ImmEstimate& estimate = engine.tracks().front().estimate;
  double cost = 0.0;
  for (auto _ : state) {
    if (expected_cost.with_look(estimate, *engine.sensors()[0], UpdateForm::kEkf, cost) != Numerics::kOk) {
      state.SkipWithError("with_look");
    }
    benchmark::DoNotOptimize(cost);
  }
}
BENCHMARK(pair_score)->Arg(3)->Arg(5)->Arg(10);

}  // namespace
}  // namespace dwell
