#include "radar/look.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "radar/assert.hpp"
#include "radar/frames.hpp"
#include "radar/jump_markov_trajectory.hpp"

namespace dwell {
namespace {

bool in_footprint(const Sensor& sensor, const Vector2& z, const Vector2& centre) {
  const Vector2 half = sensor.footprint_half_extent();
  const Vector2 offset = sensor.residual(z, centre).cwiseAbs();
  return offset[0] <= half[0] && offset[1] <= half[1];
}

void add_false_alarms(const Sensor& sensor, const Dwell& dwell, const MeasurementBox& box, RandomStream stream,
                      std::vector<Plot>& plots) {
  if (sensor.clutter_density() <= 0.0) return;
  const Vector2& centre = box.centre;
  const Vector2 half(box.half[0], std::min(box.half[1], std::numbers::pi));  // no direction counts twice
  const double near = std::max(0.0, centre[0] - half[0]);
  const double far = std::min(sensor.largest_range(), centre[0] + half[0]);
  if (far <= near) return;
  RandomStream declared = stream.fork("declared");
  const int count = stream.poisson(sensor.clutter_density() * (far - near) * 2.0 * half[1]);
  for (int i = 0; i < count; ++i) {
    const double range_m = stream.uniform(near, far);
    const double azimuth_rad = wrap_angle(centre[1] + stream.uniform(-half[1], half[1]));
    plots.push_back({dwell.time, dwell.radar, {range_m, azimuth_rad}, std::nullopt});
    if (const Declaration* declaration = sensor.declaration()) {
      plots.back().declared = static_cast<int>(declared.uniform() * declaration->classes());
    }
  }
}

/// The plot that a covered target gives, where it is detected.
void add_detection(const Sensor& sensor, const Dwell& dwell, const TargetTruth& target, const Vector2& z,
                   const RandomStream& look, std::vector<Plot>& plots) {
  RandomStream draw = look.fork(target.id.number);
  if (draw.uniform() >= sensor.detection_probability(target.state)) return;
  const Matrix2 root = sensor.noise(target.state).llt().matrixL();
  const double first = draw.normal();
  const double second = draw.normal();
  const Vector2 noisy = z + root * Vector2(first, second);
  // residual() of the zero measurement brings a bearing back into (-pi, pi].
  plots.push_back({dwell.time, dwell.radar, sensor.residual(noisy, Vector2::Zero()), target.id});
  const Declaration* declaration = sensor.declaration();
  if (declaration == nullptr || !target.target_class) return;
  plots.back().declared = draw_index(declaration->emission.row(*target.target_class), draw);
}

RandomStream stream_of_look(const RandomStream& stream, const Dwell& dwell) {
  return stream.fork(static_cast<std::uint64_t>(dwell.time.time_since_epoch().count()));
}

}  // namespace

void simulate_look(const Sensor& sensor, const Dwell& dwell, std::span<const TargetTruth> targets,
                   const RandomStream& stream, std::vector<Plot>& plots) {
  plots.clear();
  const RandomStream look = stream_of_look(stream, dwell);
  const Vector2 centre = sensor.measure(dwell.pointing);
  for (const TargetTruth& target : targets) {
    const Vector2 z = sensor.measure(target.state);
    if (!sensor.covers(target.state) || !in_footprint(sensor, z, centre)) continue;
    add_detection(sensor, dwell, target, z, look, plots);
  }
  add_false_alarms(sensor, dwell, {centre, sensor.footprint_half_extent()}, look.fork("false_alarms"), plots);
}

void simulate_survey(const Sensor& sensor, const Dwell& dwell, std::span<const TargetTruth> targets,
                     const RandomStream& stream, std::vector<Plot>& plots) {
  plots.clear();
  const std::optional<MeasurementBox> coverage = sensor.coverage();
  DWELL_ASSERT(coverage.has_value());
  const RandomStream look = stream_of_look(stream, dwell);
  for (const TargetTruth& target : targets) {
    if (sensor.covers(target.state)) {
      add_detection(sensor, dwell, target, sensor.measure(target.state), look, plots);
    }
  }
  add_false_alarms(sensor, dwell, *coverage, look.fork("false_alarms"), plots);
}

}  // namespace dwell
