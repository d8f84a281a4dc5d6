// One IMM cycle of one track: mix, predict, EKF update, combine.

#include <benchmark/benchmark.h>

#include "radar/range_bearing_radar.hpp"
#include "tracker/measurement.hpp"

namespace dwell {
namespace {

void imm_cycle(benchmark::State& state, const char* bank_name) {
  const ModeBank bank = *named_bank(bank_name);
  const DiscreteBank discrete = *discretise(bank, 1.0);
  RadarFigures figures;
  figures.range_noise_floor_m = 15.0;
  figures.azimuth_noise_floor_rad = 0.05 * kDegree;
  const RangeBearingRadar radar(figures);
  ImmEstimate estimate =
      make_estimate({{3e4, 100.0, 4e4, -50.0}, StateMatrix::Identity() * 1e4}, bank.initial_probability);
  ImmEstimate predicted = estimate;
  std::vector<PredictedMeasurement> measurements;
  std::vector<Vector2> innovations(estimate.modes.size());
  for (auto _ : state) {
    if (predict(discrete, estimate, predicted) != Numerics::kOk) state.SkipWithError("predict");
    if (predict_measurements(radar, UpdateForm::kEkf, predicted, measurements) != Numerics::kOk) {
      state.SkipWithError("predict_measurements");
    }
    // The plot of a target where the combined prediction is, 10 m off in range.
    const Vector2 z = radar.measure(combined_mean(predicted)) + Vector2(10.0, 0.0);
    for (std::size_t j = 0; j < innovations.size(); ++j) innovations[j] = radar.residual(z, measurements[j].z);
    if (update(measurements, innovations, predicted) != Numerics::kOk) state.SkipWithError("update");
    benchmark::DoNotOptimize(combine(predicted));
    std::swap(estimate, predicted);
  }
}
BENCHMARK_CAPTURE(imm_cycle, two_modes, "evans_practical");
BENCHMARK_CAPTURE(imm_cycle, three_modes, "cruise_and_turn");

}  // namespace
}  // namespace dwell
