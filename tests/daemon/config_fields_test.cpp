#include <algorithm>
#include <cmath>
#include <set>

#include "bandit/value_table.hpp"
#include "daemon/config/policy_reader.hpp"
#include "tests/daemon/support.hpp"

namespace dwell::testing {
namespace {

/// One numeric field of the config: what it may be, and values on both sides of each limit.
struct Row {
  std::string field;  // Message.field of config.proto
  std::string text;   // a config with @ for the value
  std::string path;
  std::string rule;
  std::vector<std::string> bad;  // as a violation prints them
  std::vector<std::string> good;
};

std::string radar(const std::string& fields) {
  return "radar {\n  name: \"r\"\n  " + fields + "\n}\ntarget { name: \"t\" y_m: 50e3 }\n";
}
std::string linear(const std::string& fields) {
  return "linear_sensor {\n  name: \"c\"\n  " + fields + "\n}\ntarget { name: \"t\" }\n";
}
std::string target(const std::string& fields) {
  return "radar { name: \"r\" }\ntarget {\n  name: \"t\"\n  " + fields + "\n}\n";
}
std::string top(const std::string& fields) {
  return "radar { name: \"r\" }\ntarget { name: \"t\" y_m: 50e3 }\n" + fields + "\n";
}

const std::vector<std::string> kNotFinite{"nan", "inf", "-inf"};

std::vector<std::string> not_finite_and(std::initializer_list<const char*> more) {
  std::vector<std::string> all = kNotFinite;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

const std::string kC = "c: [1, 0, 0, 0,  0, 0, 1, 0] ";
const std::string kR = "r: [1, 0, 0, 1] ";
const std::string kTwoModes = "tracker { bank { mode { name: \"a\" } mode { name: \"b\" } ";
std::string guard(const std::string& fields) {
  return top(kTwoModes + "transition: [1, 0, 0, 1] guard { from: \"a\" to: \"b\" " + fields + " } } }");
}
std::string one_mode(const std::string& motion) {
  return top("tracker { bank { mode { name: \"a\" " + motion + " } } }");
}
const std::string kRecording = "recording { file: \"flights/flights.csv\" id: \"belevingsvlucht\" ";

// clang-format off
const std::vector<Row> kRows{
  {"Config.scan_period_s", top("scan_period_s: @"), "scan_period_s", "must be in [0.001, 3600]",
   not_finite_and({"0", "-1", "0.0009", "3600.1"}), {"0.001", "0.25", "3600"}},
  {"Config.looks_per_scan", top("looks_per_scan: @"), "looks_per_scan", "must be a whole number from 1 to 1",
   {"0", "2", "4294967295"}, {"1"}},
  {"Config.max_wait_turns", top("max_wait_turns: @"), "max_wait_turns", "must be a whole number from 0 to 1000000",
   {"1000001", "4294967295"}, {"0", "1", "1000000"}},
  {"Config.study_scans", top("study_scans: @"), "study_scans", "must be a whole number from 1 to 1000000",
   {"0", "1000001", "4294967295"}, {"1", "1000000"}},

  {"Radar.x_m", radar("x_m: @"), "radar[1].x_m", "must be in [-1000000000, 1000000000]",
   not_finite_and({"1000000001", "-1000000001"}), {"-1e9", "0", "1e9"}},
  {"Radar.y_m", radar("y_m: @"), "radar[1].y_m", "must be in [-1000000000, 1000000000]",
   not_finite_and({"1000000001", "-1000000001"}), {"-1e9", "0", "1e9"}},
  {"Radar.beamwidth_deg", radar("beamwidth_deg: @"), "radar[1].beamwidth_deg", "must be in (0, 90]",
   not_finite_and({"0", "-1", "90.1"}), {"1e-12", "90"}},
  {"Radar.pulse_length_s", radar("pulse_length_s: @"), "radar[1].pulse_length_s", "must be in (0, 1]",
   not_finite_and({"0", "-1", "1.1"}), {"1e-15", "1"}},
  {"Radar.snr_reference_db", radar("snr_reference_db: @"), "radar[1].snr_reference_db", "must be in [-30, 120]",
   not_finite_and({"-30.1", "120.1"}), {"-30", "120"}},
  {"Radar.reference_range_m", radar("reference_range_m: @"), "radar[1].reference_range_m",
   "must be in [0.001, 1000000000]", not_finite_and({"0", "-1", "0.0009", "1000000001"}), {"1e-3", "1e9"}},
  {"Radar.range_noise_floor_m", radar("range_noise_floor_m: @"), "radar[1].range_noise_floor_m",
   "must be in [0, 1000000000]", not_finite_and({"-0.1", "1000000001"}), {"0", "1e9"}},
  {"Radar.azimuth_noise_floor_deg", radar("azimuth_noise_floor_deg: @"), "radar[1].azimuth_noise_floor_deg",
   "must be in [0, 90]", not_finite_and({"-0.1", "90.1"}), {"0", "90"}},
  {"Radar.detection_probability", radar("detection_probability: @"), "radar[1].detection_probability",
   "must be in (0, 1]", not_finite_and({"0", "-0.1", "1.1"}), {"1e-9", "1"}},
  {"Radar.false_alarm_probability", radar("false_alarm_probability: @"), "radar[1].false_alarm_probability",
   "must be in (0, 1)", not_finite_and({"0", "1", "-0.1", "1.1"}), {"1e-300", "0.999"}},
  {"Radar.max_range_m", radar("max_range_m: @"), "radar[1].max_range_m", "must be > 0",
   {"nan", "-inf", "0", "-1"}, {"1e-3", "60e3", "inf"}},
  {"Radar.sector_centre_deg", radar("sector_centre_deg: @"), "radar[1].sector_centre_deg", "must be in [-360, 360]",
   not_finite_and({"-361", "361"}), {"-360", "360"}},
  {"Radar.sector_width_deg", radar("sector_width_deg: @"), "radar[1].sector_width_deg", "must be in (0, 360]",
   not_finite_and({"0", "-1", "361"}), {"1e-9", "360"}},
  {"Radar.clutter_density", radar("clutter_density: @"), "radar[1].clutter_density", "must be >= 0 and finite",
   not_finite_and({"-1"}), {"0", "1e-3"}},
  {"Radar.dwell_azimuth_deg", radar("dwell_azimuth_deg: @"), "radar[1].dwell_azimuth_deg", "must be in (0, 180]",
   not_finite_and({"0", "-1", "181"}), {"1e-9", "180"}},
  {"Radar.dwell_range_m", radar("dwell_range_m: @"), "radar[1].dwell_range_m", "must be in (0, 1000000000]",
   not_finite_and({"0", "-1", "1000000001"}), {"1e-3", "1e9"}},
  {"Radar.usage_cost", radar("usage_cost: @"), "radar[1].usage_cost", "must be in [0, 1000000000000]",
   not_finite_and({"-1", "1000000000001"}), {"0", "1e12"}},

  {"Budget.looks", radar("budget { looks: @ horizon_s: 1e6 }"), "radar[1].budget.looks",
   "must be a whole number from 1 to 100000", {"0", "100001", "4294967295"}, {"1", "100000"}},
  {"Budget.window_s", "scan_period_s: 0.001 " + radar("budget { looks: 1 window_s: @ }"), "radar[1].budget.window_s",
   "must be in [0.001, 1000000]", not_finite_and({"0", "-1", "1000001"}), {"0.002", "1e6"}},
  {"Budget.horizon_s", "scan_period_s: 0.001 " + radar("budget { looks: 1 horizon_s: @ }"),
   "radar[1].budget.horizon_s", "must be in [0.001, 1000000]", not_finite_and({"0", "-1", "1000001"}),
   {"0.002", "1e6"}},

  {"Surveillance.period_s", radar("max_range_m: 1e5 surveillance { period_s: @ }"), "radar[1].surveillance.period_s",
   "must be in (0, 3600]", not_finite_and({"0", "-1", "3601"}), {"1", "5", "3600"}},

  {"RadarTruth.range_noise_scale", radar("truth { range_noise_scale: @ }"), "radar[1].truth.range_noise_scale",
   "must be in [0.001, 1000]", not_finite_and({"0", "-1", "1001"}), {"0.001", "1000"}},
  {"RadarTruth.azimuth_noise_scale", radar("truth { azimuth_noise_scale: @ }"), "radar[1].truth.azimuth_noise_scale",
   "must be in [0.001, 1000]", not_finite_and({"0", "-1", "1001"}), {"0.001", "1000"}},
  {"RadarTruth.range_bias_m", radar("truth { range_bias_m: @ }"), "radar[1].truth.range_bias_m",
   "must be in [-100000, 100000]", not_finite_and({"100001", "-100001"}), {"-1e5", "0", "1e5"}},
  {"RadarTruth.azimuth_bias_deg", radar("truth { azimuth_bias_deg: @ }"), "radar[1].truth.azimuth_bias_deg",
   "must be in [-180, 180]", not_finite_and({"181", "-181"}), {"-180", "180"}},
  {"RadarTruth.time_bias_s", radar("truth { time_bias_s: @ }"), "radar[1].truth.time_bias_s", "must be in [-60, 60]",
   not_finite_and({"61", "-61"}), {"-60", "60"}},
  {"RadarTruth.detection_scale", radar("truth { detection_scale: @ }"), "radar[1].truth.detection_scale",
   "must be in [0, 1000]", not_finite_and({"-1", "1001"}), {"0", "1000"}},
  {"RadarTruth.clutter_scale", radar("truth { clutter_scale: @ }"), "radar[1].truth.clutter_scale",
   "must be in [0, 100]", not_finite_and({"-1", "101"}), {"0", "100"}},
  {"RadarFault.start_s", radar("fault { start_s: @ }"), "radar[1].fault[1].start_s", "must be in [0, 1000000000]",
   not_finite_and({"-1", "1000000001"}), {"0", "1e9"}},
  {"RadarFault.duration_s", radar("fault { duration_s: @ }"), "radar[1].fault[1].duration_s",
   "must be in (0, 1000000000]", not_finite_and({"0", "-1", "1000000001"}), {"1e-9", "1e9"}},

  {"Calibration.period_scans", top("calibration { period_scans: @ }"), "calibration.period_scans",
   "must be a whole number from 1 to 1000000", {"0", "1000001", "4294967295"}, {"1", "1000000"}},
  {"Calibration.delay_scans", top("calibration { delay_scans: @ }"), "calibration.delay_scans",
   "must be a whole number from 1 to 100", {"0", "101", "4294967295"}, {"1", "100"}},
  {"Calibration.window_plots", top("calibration { window_plots: @ }"), "calibration.window_plots",
   "must be a whole number from 10 to 100000", {"0", "9", "100001", "4294967295"}, {"10", "100000"}},
  {"Calibration.exploration", top("calibration { exploration: @ }"), "calibration.exploration", "must be in [0, 0.5]",
   not_finite_and({"-0.1", "0.6"}), {"0", "0.5"}},
  {"CalibrationPrior.log_noise_scale", top("calibration { prior { log_noise_scale: @ } }"),
   "calibration.prior.log_noise_scale", "must be in (0, 5]", not_finite_and({"0", "-1", "5.1"}), {"1e-3", "5"}},
  {"CalibrationPrior.range_bias_m", top("calibration { prior { range_bias_m: @ } }"), "calibration.prior.range_bias_m",
   "must be in (0, 100000]", not_finite_and({"0", "-1", "100001"}), {"1e-3", "1e5"}},
  {"CalibrationPrior.azimuth_bias_deg", top("calibration { prior { azimuth_bias_deg: @ } }"),
   "calibration.prior.azimuth_bias_deg", "must be in (0, 180]", not_finite_and({"0", "-1", "181"}), {"1e-3", "180"}},
  {"CalibrationPrior.time_bias_s", top("calibration { prior { time_bias_s: @ } }"), "calibration.prior.time_bias_s",
   "must be in (0, 60]", not_finite_and({"0", "-1", "61"}), {"1e-6", "60"}},

  {"LinearSensor.c", linear(kR + "c: [1, 0, 0, 0,  0, 0, @, 0]"), "linear_sensor[1].c",
   "must be in [-1000000, 1000000]", not_finite_and({"1000001"}), {"0", "-1e6", "1e6"}},
  {"LinearSensor.r", linear(kC + "r: [1, 0, 0, @]"), "linear_sensor[1].r", "must be in [-1e+18, 1e+18]",
   not_finite_and({"1.1e+18"}), {"1e-12", "1e18"}},
  {"LinearSensor.detection_probability", linear(kC + kR + "detection_probability: @"),
   "linear_sensor[1].detection_probability", "must be in (0, 1]", not_finite_and({"0", "1.1"}), {"1e-9", "1"}},
  {"LinearSensor.usage_cost", linear(kC + kR + "usage_cost: @"), "linear_sensor[1].usage_cost",
   "must be in [0, 1000000000000]", not_finite_and({"-1", "1000000000001"}), {"0", "1e12"}},

  {"Target.x_m", target("x_m: @"), "target[1].x_m", "must be in [-1000000000, 1000000000]",
   not_finite_and({"1000000001"}), {"-1e9", "0", "1e9"}},
  {"Target.y_m", target("y_m: @"), "target[1].y_m", "must be in [-1000000000, 1000000000]",
   not_finite_and({"-1000000001"}), {"-1e9", "0", "1e9"}},
  {"Target.vx_mps", target("vx_mps: @"), "target[1].vx_mps", "must be in [-1000000, 1000000]",
   not_finite_and({"1000001"}), {"-1e6", "1e6"}},
  {"Target.vy_mps", target("vy_mps: @"), "target[1].vy_mps", "must be in [-1000000, 1000000]",
   not_finite_and({"1000001"}), {"-1e6", "1e6"}},
  {"Target.altitude_m", target("altitude_m: @"), "target[1].altitude_m", "must be in [-1000000000, 1000000000]",
   not_finite_and({"1000000001"}), {"-1e9", "1e9"}},
  {"Target.start_s", target("start_s: @"), "target[1].start_s", "must be in [0, 3000000000]",
   not_finite_and({"-1", "3000000001"}), {"0", "5", "3e9"}},
  {"Target.duration_s", target("duration_s: @"), "target[1].duration_s", "must be in (0, 3000000000]",
   not_finite_and({"0", "-1", "3000000001"}), {"1e-9", "5", "3e9"}},
  {"Target.weight", target("weight: @"), "target[1].weight", "must be in (0, 1000000000]",
   not_finite_and({"0", "-1", "1000000001"}), {"1e-300", "1e9"}},
  {"Leg.start_s", target("leg { duration_s: 2 start_s: @ }"), "target[1].leg[1].start_s",
   "must be in [0, 3000000000]", not_finite_and({"-1", "3000000001"}), {"0", "1.5", "3e9"}},
  {"Leg.duration_s", target("leg { start_s: 2 duration_s: @ }"), "target[1].leg[1].duration_s",
   "must be in (0, 3000000000]", not_finite_and({"0", "-1", "3000000001"}), {"1e-9", "3e9"}},
  {"Leg.ax_mps2", target("leg { start_s: 2 duration_s: 2 ax_mps2: @ }"), "target[1].leg[1].ax_mps2",
   "must be in [-100000, 100000]", not_finite_and({"100001", "-100001"}), {"-1e5", "0", "1e5"}},
  {"Leg.ay_mps2", target("leg { start_s: 2 duration_s: 2 ay_mps2: @ }"), "target[1].leg[1].ay_mps2",
   "must be in [-100000, 100000]", not_finite_and({"100001", "-100001"}), {"-1e5", "0", "1e5"}},
  {"Leg.turn_rate_dps", target("vx_mps: 9 leg { start_s: 2 duration_s: 2 turn_rate_dps: @ }"),
   "target[1].leg[1].turn_rate_dps", "must be in [-360, 360]", not_finite_and({"361", "-361"}),
   {"-360", "0", "1e-12", "360"}},
  {"Leg.process_noise_scale",
   target("process_noise { white_noise_acceleration: 1 } leg { start_s: 2 duration_s: 2 process_noise_scale: @ }"),
   "target[1].leg[1].process_noise_scale", "must be in [0, 1000000]", not_finite_and({"-1", "1000001"}), {"0", "1e6"}},
  {"Area.centre_x_m", target("jump_markov { area { radius_m: 1 centre_x_m: @ } }"),
   "target[1].jump_markov.area.centre_x_m", "must be in [-1000000000, 1000000000]", not_finite_and({"1000000001"}),
   {"-1e9", "1e9"}},
  {"Area.centre_y_m", target("jump_markov { area { radius_m: 1 centre_y_m: @ } }"),
   "target[1].jump_markov.area.centre_y_m", "must be in [-1000000000, 1000000000]", not_finite_and({"1000000001"}),
   {"-1e9", "1e9"}},
  {"Area.radius_m", target("jump_markov { area { radius_m: @ } }"), "target[1].jump_markov.area.radius_m",
   "must be in (0, 1000000000]", not_finite_and({"0", "-1", "1000000001"}), {"1e-3", "1e9"}},
  {"Area.turn_rate_dps", target("vx_mps: 9 jump_markov { area { radius_m: 1 turn_rate_dps: @ } }"),
   "target[1].jump_markov.area.turn_rate_dps", "must be in [1e-09, 360]", not_finite_and({"0", "-1", "361"}),
   {"1e-9", "360"}},
  {"Recording.begin_s", target(kRecording + "begin_s: @ }"), "target[1].recording.begin_s",
   "must be in [0, 3000000000]", not_finite_and({"-1", "3000000001"}), {"0", "60"}},
  {"Recording.start_s", target(kRecording + "start_s: @ }"), "target[1].recording.start_s",
   "must be in [0, 3000000000]", not_finite_and({"-1", "3000000001"}), {"0", "7", "3e9"}},
  {"Recording.east_m", target(kRecording + "east_m: @ }"), "target[1].recording.east_m",
   "must be in [-1000000000, 1000000000]", not_finite_and({"1000000001"}), {"-1e9", "1e9"}},
  {"Recording.north_m", target(kRecording + "north_m: @ }"), "target[1].recording.north_m",
   "must be in [-1000000000, 1000000000]", not_finite_and({"1000000001"}), {"-1e9", "1e9"}},
  {"Start.covariance", target("y_m: 50e3 start { covariance: [1, 1, @, 1] }"), "target[1].start.covariance",
   "must be in [-1e+18, 1e+18]", not_finite_and({"1.1e+18"}), {"1e-12", "1e18"}},
  {"FirstPlot.speed_sigma_mps", target("y_m: 50e3 start { first_plot { speed_sigma_mps: @ } }"),
   "target[1].start.first_plot.speed_sigma_mps", "must be in (0, 1000000]", not_finite_and({"0", "-1", "1000001"}),
   {"1e-9", "1e6"}},

  {"Class.prior", top("classes { class { name: \"a\" prior: @ } class { name: \"b\" prior: 0.5 } }"),
   "classes.class[1].prior", "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0.5"}},
  {"Class.weight", top("classes { class { name: \"a\" weight: @ } class { name: \"b\" } }"),
   "classes.class[1].weight", "must be in [1e-09, 1000000000]", not_finite_and({"0", "-1", "1000000001"}),
   {"1e-9", "1e9"}},
  {"Classes.transition", top("classes { class { name: \"a\" } class { name: \"b\" } transition: [1, 0, @, 1] }"),
   "classes.transition", "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0"}},
  {"Radar.emission", radar("emission: [1, 0, @, 1]") + "classes { class { name: \"a\" } class { name: \"b\" } }",
   "radar[1].emission", "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0"}},
  {"LinearSensor.emission",
   linear(kC + kR + "emission: [1, 0, @, 1]") + "classes { class { name: \"a\" } class { name: \"b\" } }",
   "linear_sensor[1].emission", "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0"}},
  {"GittinsHmm.discount",
   top("classes { class { name: \"a\" } class { name: \"b\" } } policy { gittins_hmm { discount: @ } }"),
   "policy.gittins_hmm.discount", "must be in [0.01, 0.95]", not_finite_and({"0", "1"}), {"0.01", "0.95"}},

  {"Tracker.gate", top("tracker { gate: @ }"), "tracker.gate", "must be > 0", {"nan", "-inf", "0", "-1"},
   {"1e-9", "1e300", "inf"}},
  {"Tracker.lost_probability", top("tracker { lost_probability: @ }"), "tracker.lost_probability",
   "must be in (0, 1)", not_finite_and({"0", "1"}), {"1e-300", "0.999"}},
  {"Tracker.lost_sigma_m", top("tracker { lost_sigma_m: @ }"), "tracker.lost_sigma_m", "must be > 0",
   {"nan", "-inf", "0", "-1"}, {"1e-9", "1e300", "inf"}},
  {"Tracker.lost_squared_distance", top("tracker { lost_squared_distance: @ }"), "tracker.lost_squared_distance",
   "must be > 0", {"nan", "-inf", "0", "-1"}, {"1e-9", "1e300", "inf"}},
  {"Particles.count", top("tracker { particles { count: @ } }"), "tracker.particles.count",
   "must be a whole number from 1 to 10000", {"0", "10001"}, {"1", "10000"}},
  {"Existence.confirm", top("tracker { association: IPDA existence { confirm: @ } }"), "tracker.existence.confirm",
   "must be in (0, 1)", not_finite_and({"0", "1"}), {"0.006", "0.999999"}},
  {"Existence.remove", top("tracker { association: IPDA existence { remove: @ } }"), "tracker.existence.remove",
   "must be in (0, 1)", not_finite_and({"0", "1"}), {"1e-300", "0.98"}},
  {"Existence.new_targets_per_hour", top("tracker { association: JPDA existence { new_targets_per_hour: @ } }"),
   "tracker.existence.new_targets_per_hour", "must be in (0, 1000000000]", not_finite_and({"0", "-1", "1000000001"}),
   {"1e-9", "1e9"}},
  {"Existence.lifetime_s", top("tracker { association: JPDA existence { lifetime_s: @ } }"),
   "tracker.existence.lifetime_s", "must be in (0, 1000000000]", not_finite_and({"0", "-1", "1000000001"}),
   {"1e-3", "1e9"}},
  {"Initiation.largest_speed_mps", top("tracker { initiation { largest_speed_mps: @ } }"),
   "tracker.initiation.largest_speed_mps", "must be in (0, 1000000]", not_finite_and({"0", "-1", "1000001"}),
   {"1e-9", "1e6"}},
  {"MOfN.plots", top("tracker { initiation { m_of_n { plots: @ looks: 100 } } }"), "tracker.initiation.m_of_n.plots",
   "must be a whole number from 2 to 100", {"0", "1", "101"}, {"2", "100"}},
  {"MOfN.looks", top("tracker { initiation { m_of_n { plots: 2 looks: @ } } }"), "tracker.initiation.m_of_n.looks",
   "must be a whole number from 2 to 100", {"0", "1", "101"}, {"2", "100"}},
  {"ModeBank.transition", top(kTwoModes + "transition: [1, 0, @, 1] } }"), "tracker.bank.transition",
   "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0"}},
  {"ModeBank.transition_interval_s", top(kTwoModes + "transition: [.9, .1, .1, .9] transition_interval_s: @ } }"),
   "tracker.bank.transition_interval_s", "must be in [0.001, 1000000]", not_finite_and({"0", "-1", "0.0009", "1000001"}),
   {"0.001", "2.5", "1e6"}},
  {"ModeBank.initial_probability", top(kTwoModes + "transition: [1, 0, 0, 1] initial_probability: [1, @] } }"),
   "tracker.bank.initial_probability", "must be in [0, 1]", not_finite_and({"-0.1", "1.1"}), {"0"}},
  {"Guard.l", guard("l: [1, @, 0, 0] b: 1"), "tracker.bank.guard[1].l", "must be in [-1000000, 1000000]",
   not_finite_and({"1000001"}), {"-1e6", "0", "1e6"}},
  {"Guard.b", guard("l: [1, 0, 0, 0] b: @"), "tracker.bank.guard[1].b", "must be in [-1000000000000, 1000000000000]",
   not_finite_and({"1000000000001"}), {"-1e12", "0", "1e12"}},
  {"Guard.noise", guard("l: [1, 0, 0, 0] b: 1 noise: @"), "tracker.bank.guard[1].noise", "must be in [-1e+18, 1e+18]",
   not_finite_and({"1.1e+18"}), {"0", "1e18"}},
  {"ConstantAcceleration.jerk_density", one_mode("constant_acceleration { jerk_density: @ }"),
   "tracker.bank.mode[1].constant_acceleration.jerk_density", "must be in (0, 1000000000000]",
   not_finite_and({"0", "-1", "1000000000001"}), {"1e-9", "1e12"}},
  {"ConstantAcceleration.start_sigma_mps2", one_mode("constant_acceleration { jerk_density: 1 start_sigma_mps2: @ }"),
   "tracker.bank.mode[1].constant_acceleration.start_sigma_mps2", "must be in (0, 1000000]",
   not_finite_and({"0", "-1", "1000001"}), {"1e-9", "1e6"}},
  {"Singer.sigma_mps2", one_mode("singer { sigma_mps2: @ time_constant_s: 10 }"),
   "tracker.bank.mode[1].singer.sigma_mps2", "must be in (0, 1000000]", not_finite_and({"0", "-1", "1000001"}),
   {"1e-9", "1e6"}},
  {"Singer.time_constant_s", one_mode("singer { sigma_mps2: 1 time_constant_s: @ }"),
   "tracker.bank.mode[1].singer.time_constant_s", "must be in [0.01, 1000000]",
   not_finite_and({"0", "-1", "1000001"}), {"0.01", "1e6"}},
  {"UnknownTurnRate.acceleration_density", one_mode("unknown_turn_rate { acceleration_density: @ rate_density: 1 }"),
   "tracker.bank.mode[1].unknown_turn_rate.acceleration_density", "must be in (0, 1000000000000]",
   not_finite_and({"0", "-1", "1000000000001"}), {"1e-9", "1e12"}},
  {"UnknownTurnRate.rate_density", one_mode("unknown_turn_rate { acceleration_density: 1 rate_density: @ }"),
   "tracker.bank.mode[1].unknown_turn_rate.rate_density", "must be in (0, 1000000]",
   not_finite_and({"0", "-1", "1000001"}), {"1e-9", "1e6"}},
  {"UnknownTurnRate.start_sigma_dps",
   one_mode("unknown_turn_rate { acceleration_density: 1 rate_density: 1 start_sigma_dps: @ }"),
   "tracker.bank.mode[1].unknown_turn_rate.start_sigma_dps", "must be in (0, 360]",
   not_finite_and({"0", "-1", "361"}), {"1e-9", "360"}},
  {"CoordinatedTurn.turn_rate_dps",
   top("tracker { bank { mode { name: \"a\" coordinated_turn { turn_rate_dps: @ } } } }"),
   "tracker.bank.mode[1].coordinated_turn.turn_rate_dps", "must be in [-360, 360]", not_finite_and({"361"}),
   {"-360", "1e-9", "360"}},
  {"ProcessNoise.white_noise_acceleration", target("process_noise { white_noise_acceleration: @ }"),
   "target[1].process_noise.white_noise_acceleration", "must be in [0, 1000000000000]",
   not_finite_and({"-1", "1000000000001"}), {"0", "1e12"}},
  {"ProcessNoise.piecewise_acceleration",
   top("tracker { bank { mode { name: \"a\" process_noise { piecewise_acceleration: @ } } } }"),
   "tracker.bank.mode[1].process_noise.piecewise_acceleration", "must be in [0, 1000000]",
   not_finite_and({"-1", "1000001"}), {"0", "1e6"}},
  {"DiagonalNoise.b", target("process_noise { diagonal { b: [1, 1, 1, @] } }"),
   "target[1].process_noise.diagonal.b", "must be in [0, 1000000]", not_finite_and({"-1", "1000001"}), {"0", "1e6"}},
  {"ProcessNoise.step_s", target("process_noise { piecewise_acceleration: 1 step_s: @ }"),
   "target[1].process_noise.step_s", "must be in [0.001, 3600]", not_finite_and({"0", "-1", "0.0009", "3601"}),
   {"0.001", "0.5", "1"}},

  {"Fixed.sensor", top("policy { fixed { sensor: @ } }"), "policy.fixed.sensor", "must be a whole number from 1 to 1",
   {"0", "2", "4294967295"}, {"1"}},
  {"SaImm.beta", top("policy { sa_imm { beta: @ } }"), "policy.sa_imm.beta", "must be in [0, 1000000000000]",
   not_finite_and({"-1", "1000000000001"}), {"0", "1e12"}},
  {"Random.horizon", top("policy { random { horizon: @ } }"), "policy.random.horizon",
   "must be a whole number from 1 to 8", {"0", "9"}, {"1", "8"}},
  {"Window.d", top("policy { window { d: @ } }"), "policy.window.d", "must be a whole number from 1 to 8", {"0", "9"},
   {"1", "8"}},
  {"Threshold.f", top("policy { threshold { f: @ } }"), "policy.threshold.f", "must be in [1, 1000000000]",
   not_finite_and({"0.999", "1000000001"}), {"1", "1e9"}},
  {"Threshold.horizon", top("policy { threshold { horizon: @ } }"), "policy.threshold.horizon",
   "must be a whole number from 1 to 8", {"0", "9"}, {"1", "8"}},
  {"RelaxedDp.alpha", top("policy { relaxed_dp { alpha: @ } }"), "policy.relaxed_dp.alpha", "must be in [1, 1000]",
   not_finite_and({"0.999", "1001"}), {"1", "1e3"}},
  {"RelaxedDp.horizon", top("policy { relaxed_dp { horizon: @ } }"), "policy.relaxed_dp.horizon",
   "must be a whole number from 1 to 8", {"0", "9"}, {"1", "8"}},
  {"Beam.width", top("policy { beam { width: @ } }"), "policy.beam.width", "must be a whole number from 1 to 10000",
   {"0", "10001"}, {"1", "10000"}},
  {"Beam.horizon", top("policy { beam { horizon: @ } }"), "policy.beam.horizon",
   "must be a whole number from 1 to 8", {"0", "9"}, {"1", "8"}},
  {"Optimum.horizon", top("policy { optimum { horizon: @ } }"), "policy.optimum.horizon",
   "must be a whole number from 1 to 8", {"0", "9"}, {"1", "8"}},
  {"LookAhead.depth", top("policy { lookahead { depth: @ } }"), "policy.lookahead.depth",
   "must be a whole number from 1 to 3", {"0", "4"}, {"1", "3"}},
  {"TrackOrbit.discount", top("policy { orbit { discount: @ } }"), "policy.orbit.discount", "must be in [0.5, 0.9999]",
   not_finite_and({"0.49", "1"}), {"0.5", "0.98", "0.9999"}},
  {"TrackOrbit.steps", top("policy { orbit { steps: @ } }"), "policy.orbit.steps",
   "must be a whole number from 2 to 2000", {"1", "2001", "4294967295"}, {"2", "2000"}},
  {"TrackIndex.depth", top("policy { index { depth: @ } }"), "policy.index.depth",
   "must be a whole number from 1 to 2", {"0", "3", "4294967295"}, {"1", "2"}},
  {"SaImm.nodes", top("policy { sa_imm { nodes: @ } }"), "policy.sa_imm.nodes", "must be a whole number from 2 to 32",
   {"0", "1", "33", "4294967295"}, {"2", "32"}},
  {"Stream.high_water_mark", top("stream { high_water_mark: @ }"), "stream.high_water_mark",
   "must be a whole number from 1 to 100000000", {"0", "100000001", "4294967295"}, {"1", "100000000"}},
};
// clang-format on

std::string with(const Row& row, const std::string& value) {
  std::string text = row.text;
  return text.replace(text.find('@'), 1, value);
}

/// Line and column, from 1, of the field's name.
std::pair<int, int> place_of(const Row& row) {
  const std::string name = row.field.substr(row.field.find('.') + 1) + ":";
  const std::size_t place = row.text.rfind(name, row.text.find('@'));
  const std::string before = row.text.substr(0, place);
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t line_start = before.rfind('\n');
  return {static_cast<int>(line), static_cast<int>(place - (line_start == std::string::npos ? -1 : line_start))};
}

TEST(ConfigFields, BadValueIsOneViolationWithPathValueRuleAndPlace) {
  for (const Row& row : kRows) {
    for (const std::string& value : row.bad) {
      SCOPED_TRACE(row.field + ": " + value + "\n" + refusal_of(with(row, value)));
      const auto violations = violations_of(with(row, value));
      ASSERT_EQ(violations.size(), 1);
      EXPECT_EQ(violations[0].field, row.path);
      EXPECT_EQ(violations[0].value, value);
      EXPECT_EQ(violations[0].rule, row.rule);
      EXPECT_EQ(std::pair(violations[0].line, violations[0].column), place_of(row));
    }
  }
}

TEST(ConfigFields, TextThatIsNoNumberIsASyntaxErrorAtItsPlace) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.field);
    const std::string before = row.text.substr(0, row.text.find('@'));
    const auto violations = violations_of(with(row, "\"1\""));
    ASSERT_EQ(violations.size(), 1);
    EXPECT_EQ(violations[0].field, "syntax");
    EXPECT_EQ(violations[0].line, std::count(before.begin(), before.end(), '\n') + 1);
    EXPECT_EQ(violations[0].column, static_cast<int>(before.size() - before.rfind('\n')));
  }
}

/// Every number of a message, and of the messages in it.
void expect_finite(const google::protobuf::Message& message) {
  using google::protobuf::FieldDescriptor;
  const auto* reflection = message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const bool repeated = field->is_repeated();
    const int count = repeated ? reflection->FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
      if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        expect_finite(repeated ? reflection->GetRepeatedMessage(message, field, i)
                               : reflection->GetMessage(message, field));
      } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
        const double value =
            repeated ? reflection->GetRepeatedDouble(message, field, i) : reflection->GetDouble(message, field);
        EXPECT_TRUE(std::isfinite(value)) << field->full_name() << " = " << value;
      }
    }
  }
}

TEST(ConfigFields, WhatIsAcceptedRunsUnderEveryPolicyAndPublishesFiniteNumbers) {
  const auto table = std::make_shared<ValueTable>();  // of all runs: what each asks for is much the same
  for (const Row& row : kRows) {
    const bool has_policy = row.path.rfind("policy.", 0) == 0;
    for (const std::string& value : row.good) {
      for (const PolicyDescription& policy : describe_policies(1)) {
        SCOPED_TRACE(row.field + ": " + value + (has_policy ? "" : " under " + policy.name));
        const std::string text = with(row, value) + (has_policy ? "" : "policy { " + policy.name + " {} }\n");
        ASSERT_EQ(refusal_of(text), "");
        DaemonConfig config = config_of(text);
        config.engine.value_table = table;
        RecordedRun recorded(config);
        recorded.scan(8);
        for (const v1::Envelope& envelope : recorded.stream.envelopes) expect_finite(envelope);
        if (has_policy) break;
      }
    }
  }
}

// Every number at the ends of what a double holds, either sign.
TEST(ConfigFields, TheEndsOfDoubleAreRefusedOrRun) {
  for (const Row& row : kRows) {
    for (const char* value : {"1e308", "-1e308", "5e-324"}) {
      SCOPED_TRACE(row.field + ": " + value);
      const std::string text = with(row, value);
      if (!refusal_of(text).empty()) continue;
      RecordedRun recorded(config_of(text));
      recorded.scan(8);
      for (const v1::Envelope& envelope : recorded.stream.envelopes) expect_finite(envelope);
    }
  }
}

void numeric_fields(const google::protobuf::Descriptor& type, std::set<std::string>& seen,
                    std::set<std::string>& fields) {
  using google::protobuf::FieldDescriptor;
  if (!seen.insert(type.name()).second) return;
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    // Scheduling problems have a table of their own: problem_fields_test.cpp.
    if (field.containing_oneof() != nullptr && field.containing_oneof()->name() == "problem") continue;
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) numeric_fields(*field.message_type(), seen, fields);
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE || field.cpp_type() == FieldDescriptor::CPPTYPE_UINT32) {
      fields.insert(type.name() + "." + field.name());
    }
  }
}

TEST(ConfigFields, TableHasEveryNumberOfTheSchema) {
  std::set<std::string> seen;
  std::set<std::string> wanted;
  numeric_fields(*v1::Config::descriptor(), seen, wanted);
  std::set<std::string> there;
  for (const Row& row : kRows) there.insert(row.field);
  EXPECT_EQ(there, wanted);
}

}  // namespace
}  // namespace dwell::testing
