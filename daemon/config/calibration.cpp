#include <algorithm>
#include <cmath>

#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

RadarTruth read_truth(FieldReader in) {
  RadarTruth truth;
  double range_scale = 1.0;
  double azimuth_scale = 1.0;
  in.number("range_noise_scale", within(1e-3, 1e3), 1.0, range_scale);
  in.number("azimuth_noise_scale", within(1e-3, 1e3), 1.0, azimuth_scale);
  in.number("range_bias_m", within(-1e5, 1e5), 1.0, truth.correction.range_bias_m);
  in.number("azimuth_bias_deg", within(-180.0, 180.0), kDegree, truth.correction.azimuth_bias_rad);
  in.number("time_bias_s", within(-60.0, 60.0), 1.0, truth.correction.time_bias_s);
  in.number("detection_scale", within(0.0, 1e3), 1.0, truth.detection_scale);
  in.number("clutter_scale", within(0.0, 100.0), 1.0, truth.clutter_scale);
  truth.correction.log_range_scale = std::log(range_scale);
  truth.correction.log_azimuth_scale = std::log(azimuth_scale);
  return truth;
}

}  // namespace

void read_radar_truth(FieldReader radar, SensorConfig& sensor) {
  sensor.truth = read_truth(radar.child("truth"));
  for (int i = 0; i < radar.count("fault"); ++i) {
    FieldReader in = radar.element("fault", i);
    RadarFault fault;
    double start_s = 0.0;
    in.number("start_s", within(0.0, 1e9), 1.0, start_s);
    fault.start = TimePoint(from_seconds(start_s));
    if (in.has("duration_s")) {
      double duration_s = 0.0;
      in.number("duration_s", above(0.0, 1e9), 1.0, duration_s);
      fault.end = fault.start + from_seconds(duration_s);
    }
    fault.change = read_truth(in.child("change"));
    sensor.faults.push_back(fault);
  }
}

void read_calibration(FieldReader in, CalibrationSettings& settings) {
  in.choice("mode", settings.mode);
  in.integer("period_scans", 1, 1'000'000, settings.period_scans);
  settings.delay_scans = std::min(settings.delay_scans, settings.period_scans);
  in.integer("delay_scans", 1, settings.period_scans, settings.delay_scans);
  in.integer("window_plots", 10, 100'000, settings.window_plots);
  in.number("exploration", within(0.0, 0.5), 1.0, settings.exploration);
  FieldReader prior = in.child("prior");
  prior.number("log_noise_scale", above(0.0, 5.0), 1.0, settings.prior.log_scale);
  prior.number("range_bias_m", above(0.0, 1e5), 1.0, settings.prior.range_bias_m);
  prior.number("azimuth_bias_deg", above(0.0, 180.0), kDegree, settings.prior.azimuth_bias_rad);
  prior.number("time_bias_s", above(0.0, 60.0), 1.0, settings.prior.time_bias_s);
}

}  // namespace dwell
