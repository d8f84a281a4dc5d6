#include <Eigen/Cholesky>

#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

/// That one look may draw on average; a million is a mistake in the units, and would stop the scan.
constexpr double kMostFalsePlots = 1e4;

BudgetSettings read_budget(FieldReader in, Duration scan_period) {
  constexpr int kMostLooks = 100'000;
  BudgetSettings budget;
  budget.looks = 1;
  in.required("looks");
  in.integer("looks", 1, kMostLooks, budget.looks);
  const bool window = in.has("window_s");
  if (!window && !in.has("horizon_s")) in.refuse("window_s", "", "one of window_s, horizon_s is required");
  budget.span = window ? BudgetSettings::Span::kWindow : BudgetSettings::Span::kHorizon;
  const char* field = window ? "window_s" : "horizon_s";
  double length_s = 0.0;
  if (in.has(field)) in.number(field, within(1e-3, 1e6), 1.0, length_s);
  in.choice("spread", budget.spread);
  if (length_s == 0.0) return {};  // refused already
  const Duration length = from_seconds(length_s);
  if (!is_multiple(length, scan_period)) {
    in.refuse(field, in.value(field), "must be a whole number of scan periods");
    return {};
  }
  budget.scans = static_cast<int>(length / scan_period);
  if (budget.looks >= budget.scans) {
    in.refuse(
        "looks", in.value("looks"),
        "must be less than the " + std::to_string(budget.scans) + " scans of " + field + ", or it limits nothing");
  }
  return budget;
}

/// Scans between surveillance looks; 0 for none.
int read_surveillance(FieldReader in, Duration scan_period, const RadarFigures& figures) {
  double period_s = to_seconds(scan_period);
  in.required("period_s");
  in.number("period_s", above(0.0, 3600.0), 1.0, period_s);
  if (!is_multiple(from_seconds(period_s), scan_period)) {
    in.refuse("period_s", in.value("period_s"), "must be a whole number of scan periods");
    return 0;
  }
  const auto coverage = RangeBearingRadar(figures).coverage();
  if (!coverage) {
    in.refuse("period_s", in.value("period_s"), "needs a radar with a finite max_range_m");
    return 0;
  }
  const double false_plots = figures.clutter_density * 4.0 * coverage->half.prod();
  if (false_plots > kMostFalsePlots) {
    in.refuse("period_s", in.value("period_s"),
              "needs at most 10000 false plots a surveillance look (density x coverage); there are " +
                  number_text(false_plots));
  }
  return static_cast<int>(from_seconds(period_s) / scan_period);
}

/// What every sensor has, whatever it measures.
void read_use(FieldReader& in, Duration scan_period, SensorConfig& sensor) {
  in.number("usage_cost", cost(), 1.0, sensor.usage_cost);
  bool down = false;
  in.flag("down", down);
  sensor.up = !down;
  if (in.has("budget")) sensor.budget = read_budget(in.child("budget"), scan_period);
}

}  // namespace

SensorConfig read_radar(FieldReader in, Duration scan_period, const TargetClasses& classes) {
  SensorConfig sensor;
  RadarFigures figures;
  in.required("name");
  in.text("name", sensor.name);
  in.number("x_m", place_m(), 1.0, figures.position_m.x());
  in.number("y_m", place_m(), 1.0, figures.position_m.y());
  in.number("beamwidth_deg", above(0.0, 90.0), kDegree, figures.beamwidth_rad);
  in.number("pulse_length_s", above(0.0, 1.0), 1.0, figures.pulse_length_s);
  in.decibel("snr_reference_db", within(-30.0, 120.0), figures.snr_reference);
  // A millimetre: with the fourth power of what is less, R overflows at the ranges that there may be.
  in.number("reference_range_m", within(1e-3, 1e9), 1.0, figures.reference_range_m);
  in.number("range_noise_floor_m", within(0.0, 1e9), 1.0, figures.range_noise_floor_m);
  in.number("azimuth_noise_floor_deg", within(0.0, 90.0), kDegree, figures.azimuth_noise_floor_rad);
  if (in.has("false_alarm_probability")) {
    SwerlingOneDetection detection;
    in.number("false_alarm_probability", between(0.0, 1.0), 1.0, detection.false_alarm_probability);
    figures.detection = detection;
  } else {
    FixedDetection detection;
    in.number("detection_probability", above(0.0, 1.0), 1.0, detection.probability);
    figures.detection = detection;
  }
  in.number("max_range_m", positive_or_infinite(), 1.0, figures.max_range_m);
  in.number("sector_centre_deg", within(-360.0, 360.0), kDegree, figures.sector_centre_rad);
  in.number("sector_width_deg", above(0.0, 360.0), kDegree, figures.sector_width_rad);
  in.number("clutter_density", non_negative(), 1.0, figures.clutter_density);
  figures.dwell_azimuth_rad = 3.0 * figures.beamwidth_rad;
  in.number("dwell_azimuth_deg", above(0.0, 180.0), kDegree, figures.dwell_azimuth_rad);
  in.number("dwell_range_m", length_m(), 1.0, figures.dwell_range_m);
  read_use(in, scan_period, sensor);
  const double false_plots = figures.clutter_density * 4.0 * figures.dwell_range_m * figures.dwell_azimuth_rad;
  if (false_plots > kMostFalsePlots) {
    in.refuse("clutter_density", in.value("clutter_density"),
              "must give at most 10000 false plots a look (density x footprint); gives " + number_text(false_plots));
  }
  if (in.has("surveillance")) {
    sensor.surveillance_scans = read_surveillance(in.child("surveillance"), scan_period, figures);
  }
  sensor.declaration = read_emission(in, classes);
  read_radar_truth(in, sensor);
  sensor.figures = figures;
  return sensor;
}

SensorConfig read_linear_sensor(FieldReader in, Duration scan_period, const TargetClasses& classes) {
  SensorConfig sensor;
  LinearFigures figures;
  in.required("name");
  in.text("name", sensor.name);
  const std::vector<double> c = in.numbers("c", within(-1e6, 1e6), {8});
  const std::vector<double> r = in.numbers("r", variance(), {4});
  if (in.count("c") == 0) in.refuse("c", "", "is required: 2 x 4 values, row-major");
  if (in.count("r") == 0) in.refuse("r", "", "is required: 2 x 2 values, row-major");
  if (c.size() == 8) figures.c = row_major<MeasurementJacobian>(c, 2, kStateSize);
  if (r.size() == 4) {
    figures.r = row_major<Matrix2>(r, 2, 2);
    if (!is_covariance(figures.r)) in.refuse("r", "", "must be symmetric and positive definite");
  }
  in.number("detection_probability", above(0.0, 1.0), 1.0, figures.detection_probability);
  read_use(in, scan_period, sensor);
  sensor.declaration = read_emission(in, classes);
  sensor.figures = figures;
  return sensor;
}

}  // namespace dwell
