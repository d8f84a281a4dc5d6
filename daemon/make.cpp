#include "daemon/make.hpp"

#include "radar/calibration/corrected_radar.hpp"
#include "radar/linear_sensor.hpp"

namespace dwell {
namespace {

struct MakeSensor {
  std::unique_ptr<Sensor> operator()(const RadarFigures& figures) const {
    return std::make_unique<CorrectedRadar>(figures);
  }
  std::unique_ptr<Sensor> operator()(const LinearFigures& figures) const {
    return std::make_unique<LinearSensor>(figures.c, figures.r, figures.detection_probability);
  }
};

struct MakeTrajectory {
  TimePoint start;
  TimePoint end;
  Duration scan_period;
  RandomStream stream;

  std::unique_ptr<Trajectory> operator()(const ScriptedMotion& motion) const {
    Script script{motion.initial, start, end, motion.altitude_m, motion.legs, motion.process_noise_root};
    return std::make_unique<ScriptedTrajectory>(std::move(script), stream.fork("process_noise"));
  }
  std::unique_ptr<Trajectory> operator()(const JumpMarkovMotion& motion) const {
    RandomStream first = stream.fork("initial_mode");
    const int mode = draw_index(motion.initial_probability.transpose(), first);
    const JumpMarkovScript script{motion.initial, mode, start, end, scan_period, motion.altitude_m, motion.area};
    return std::make_unique<JumpMarkovTrajectory>(motion.system, script, stream.fork("process_noise"));
  }
  std::unique_ptr<Trajectory> operator()(const RecordedMotion& motion) const {
    return std::make_unique<RecordedTrajectory>(motion.path, start, end, motion.offset_m);
  }
};

}  // namespace

std::unique_ptr<Sensor> make_sensor(const SensorConfig& config) {
  std::unique_ptr<Sensor> sensor = std::visit(MakeSensor{}, config.figures);
  if (config.declaration) sensor->set_declaration(*config.declaration);
  return sensor;
}

std::unique_ptr<Trajectory> make_trajectory(const TargetConfig& config, TimePoint start, Duration scan_period,
                                            const RandomStream& root, const std::string& name) {
  const TimePoint end = config.duration ? start + *config.duration : TimePoint::max();
  return std::visit(MakeTrajectory{start, end, scan_period, root.fork("target/" + name)}, config.motion);
}

}  // namespace dwell
