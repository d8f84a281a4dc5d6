#include <algorithm>
#include <fstream>
#include <limits>

#include <Eigen/Cholesky>

#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

State read_state(FieldReader& in) {
  Vector2 place = Vector2::Zero();
  Vector2 speed = Vector2::Zero();
  in.number("x_m", place_m(), 1.0, place.x());
  in.number("y_m", place_m(), 1.0, place.y());
  in.number("vx_mps", speed_mps(), 1.0, speed.x());
  in.number("vy_mps", speed_mps(), 1.0, speed.y());
  return make_state(place, speed);
}

/// A time of stream, in nanoseconds; bounded so that sums stay inside 64 bits.
Duration read_time(FieldReader& in, const char* field, const Range& range) {
  double seconds = 0.0;
  in.number(field, range, 1.0, seconds);
  return from_seconds(seconds);
}

constexpr double kLongestRun_s = 3e9;  // a century

void read_start_time(FieldReader& in, Duration scan_period, TargetConfig& target) {
  const Duration start = read_time(in, "start_s", within(0.0, kLongestRun_s));
  if (!is_multiple(start, scan_period)) {
    in.refuse("start_s", in.value("start_s"), "must be a whole number of scan periods");
  }
  target.start = kStreamStart + start;
}

Leg read_leg(FieldReader in) {
  Leg leg;
  in.required("start_s");
  in.required("duration_s");
  leg.start = kStreamStart + read_time(in, "start_s", within(0.0, kLongestRun_s));
  leg.end = leg.start + read_time(in, "duration_s", above(0.0, kLongestRun_s));
  in.number("ax_mps2", within(-1e5, 1e5), 1.0, leg.acceleration_mps2.x());
  in.number("ay_mps2", within(-1e5, 1e5), 1.0, leg.acceleration_mps2.y());
  in.number("turn_rate_dps", within(-360.0, 360.0), kDegree, leg.turn_rate_radps);
  in.number("process_noise_scale", within(0.0, 1e6), 1.0, leg.process_noise_scale);
  if (leg.turn_rate_radps != 0.0 && !leg.acceleration_mps2.isZero(0.0)) {
    in.refuse("turn_rate_dps", in.value("turn_rate_dps"), "must not stand with an acceleration");
  }
  return leg;
}

ScriptedMotion read_script(FieldReader& in, Duration scan_period) {
  ScriptedMotion motion;
  motion.initial = read_state(in);
  in.number("altitude_m", place_m(), 1.0, motion.altitude_m);
  for (int i = 0; i < in.count("leg"); ++i) {
    motion.legs.push_back(read_leg(in.element("leg", i)));
    if (i > 0 && motion.legs[i].start < motion.legs[i - 1].end) {
      FieldReader leg = in.element("leg", i);
      leg.refuse("start_s", leg.value("start_s"), "must not be before the end of the leg above");
    }
  }
  if (in.has("process_noise")) {
    const ProcessNoise noise = read_process_noise(in.child("process_noise"), scan_period);
    motion.process_noise_root = noise_root(process_noise(ConstantVelocity{}, noise, to_seconds(scan_period)));
  }
  return motion;
}

Area read_area(FieldReader in) {
  Area area{Vector2::Zero(), 1.0, 3.0 * kDegree};  // a standard-rate turn
  in.number("centre_x_m", place_m(), 1.0, area.centre_m.x());
  in.number("centre_y_m", place_m(), 1.0, area.centre_m.y());
  in.required("radius_m");
  if (in.has("radius_m")) in.number("radius_m", length_m(), 1.0, area.radius_m);
  in.number("turn_rate_dps", within(1e-9, 360.0), kDegree, area.turn_rate_radps);
  return area;
}

JumpMarkovMotion read_jump_markov(FieldReader& in, const EngineConfig& config) {
  JumpMarkovMotion motion;
  motion.initial = read_state(in);
  in.number("altitude_m", place_m(), 1.0, motion.altitude_m);
  FieldReader jump = in.child("jump_markov");
  const ModeBank bank = jump.has("bank") ? read_bank(jump.child("bank"), config.scan_period, config.bank) : config.bank;
  motion.initial_probability = bank.initial_probability;
  for (const Mode& mode : bank.modes) motion.mode_names.push_back(mode.name);
  if (std::any_of(bank.modes.begin(), bank.modes.end(), [](const Mode& mode) { return mode.trailing.has_value(); })) {
    jump.refuse("bank", "", "must have modes of position and velocity alone: the truth has no other states");
  }
  if (jump.has("initial_mode")) {
    std::string name;
    jump.text("initial_mode", name);
    const auto same = [&](const Mode& mode) { return mode.name == name; };
    const auto mode = std::find_if(bank.modes.begin(), bank.modes.end(), same);
    motion.initial_probability.setZero();
    if (mode != bank.modes.end()) {
      motion.initial_probability[mode - bank.modes.begin()] = 1.0;
    } else {
      jump.refuse("initial_mode", jump.value("initial_mode"), "must be the name of a mode of its bank");
    }
  }
  bool without_noise = false;
  jump.flag("without_noise", without_noise);
  if (jump.has("area")) motion.area = read_area(jump.child("area"));
  if (const auto discrete = discretise(bank, to_seconds(config.scan_period))) {
    motion.system.transition_matrix = discrete->f;
    motion.system.transition = discrete->transition;
    motion.system.guards = discrete->guards;
    for (const StateMatrix& q : discrete->q) {
      motion.system.process_noise_root.push_back(without_noise ? StateMatrix::Zero() : noise_root(q));
    }
  }
  return motion;
}

/// The flight that a recording names; null, with a violation, where there is none.
const RecordedFlight* find_flight(FieldReader& in, const std::vector<RecordedFlight>& flights) {
  std::string names;
  for (const RecordedFlight& flight : flights) names += (names.empty() ? "" : ", ") + flight.id;
  if (!in.has("id")) {
    if (flights.size() == 1) return &flights.front();
    in.refuse("id", "", "is required: the file has " + names);
    return nullptr;
  }
  std::string id;
  in.text("id", id);
  for (const RecordedFlight& flight : flights) {
    if (flight.id == id) return &flight;
  }
  in.refuse("id", in.value("id"), "must be one of the file's: " + names);
  return nullptr;
}

RecordedMotion read_recorded(FieldReader in, const EngineConfig& config, RecordingShelf& shelf, TargetConfig& target,
                             std::vector<Violation>& violations) {
  RecordedMotion motion;
  std::string file;
  in.required("file");
  in.text("file", file);
  const Duration begin = read_time(in, "begin_s", within(0.0, kLongestRun_s));
  read_start_time(in, config.scan_period, target);
  in.number("east_m", place_m(), 1.0, motion.offset_m.x());
  in.number("north_m", place_m(), 1.0, motion.offset_m.y());
  in.flag("repeat", motion.repeat);
  if (file.empty()) return motion;
  std::vector<Violation> problems;
  const auto* flights = shelf.flights(file, problems);
  for (Violation& problem : problems) {
    if (problem.field == "file")
      in.refuse("file", in.value("file"), problem.rule);
    else
      violations.push_back(std::move(problem));
  }
  const RecordedFlight* flight = flights == nullptr ? nullptr : find_flight(in, *flights);
  if (flight == nullptr) return motion;
  const Duration length = target.duration.value_or(Duration::max());
  if (FlightPath::samples_in(*flight, begin, length) < 4) {
    in.refuse("begin_s", in.value("begin_s"), "must leave at least 4 rows of the recording");
    return motion;
  }
  motion.path = std::make_shared<const FlightPath>(*flight, begin, length);
  return motion;
}

std::variant<CuedStart, FirstPlotStart, NoStart> read_track_start(FieldReader in, const EngineConfig& config) {
  if (in.has("none")) {
    if (in.count("covariance") > 0 || in.has("first_plot")) in.refuse("none", "", "must stand alone");
    const bool surveyed = std::any_of(config.sensors.begin(), config.sensors.end(),
                                      [](const SensorConfig& sensor) { return sensor.surveillance_scans > 0; });
    if (!surveyed) in.refuse("none", "", "needs a radar with surveillance, which finds the target");
    return NoStart{};
  }
  if (in.has("first_plot")) {
    FirstPlotStart start;
    if (in.count("covariance") > 0) in.refuse("covariance", "", "must not stand with first_plot");
    const bool placeable = std::any_of(config.sensors.begin(), config.sensors.end(), [](const SensorConfig& sensor) {
      return std::holds_alternative<RadarFigures>(sensor.figures);
    });
    if (!placeable) in.refuse("first_plot", "", "needs a radar: plots of linear sensors are no positions");
    in.child("first_plot").number("speed_sigma_mps", above(0.0, 1e6), 1.0, start.speed_sigma_mps);
    return start;
  }
  CuedStart start;
  const auto values = in.numbers("covariance", variance(), {kStateSize, kStateSize * kStateSize});
  if (values.size() == kStateSize) start.covariance = row_major<State>(values, kStateSize, 1).asDiagonal();
  if (values.size() > kStateSize) start.covariance = row_major<StateMatrix>(values, kStateSize, kStateSize);
  if (!is_covariance(start.covariance)) in.refuse("covariance", "", "must be symmetric and positive definite");
  const State variances = start.covariance.diagonal();
  in.fill_in("covariance", std::span(variances.data(), kStateSize));
  return start;
}

void refuse_foreign_fields(FieldReader& in) {
  const bool recorded = in.has("recording");
  const bool random = in.has("jump_markov");
  if (recorded && random) in.refuse("jump_markov", "", "must not stand with recording");
  const auto refuse = [&](std::initializer_list<const char*> fields, const char* other) {
    for (const char* field : fields) {
      if (in.has(field)) in.refuse(field, in.value(field), std::string("must not stand with ") + other);
    }
  };
  if (recorded) refuse({"x_m", "y_m", "vx_mps", "vy_mps", "altitude_m", "start_s", "process_noise"}, "recording");
  if (random) refuse({"process_noise"}, "jump_markov");
  if ((recorded || random) && in.count("leg") > 0) {
    in.refuse("leg", "", recorded ? "must not stand with recording" : "must not stand with jump_markov");
  }
}

}  // namespace

bool is_multiple(Duration time, Duration scan_period) {
  return scan_period.count() > 0 && time.count() % scan_period.count() == 0;
}

const std::vector<RecordedFlight>* RecordingShelf::flights(const std::string& file, std::vector<Violation>& problems) {
  if (bad_.contains(file)) return nullptr;
  if (const auto known = flights_.find(file); known != flights_.end()) return &known->second;
  const std::filesystem::path path = directory_ / file;
  std::ifstream input(path);
  if (!input || std::filesystem::is_directory(path)) {
    problems.push_back({"file", "", "cannot be read: " + path.string()});
    return nullptr;
  }
  try {
    return &flights_.emplace(file, read_recording(input, path.string())).first->second;
  } catch (const InvalidInput& error) {
    bad_.insert(file);
    for (Violation violation : error.violations()) {
      // The line is the recording's, not the config's.
      const std::string where = violation.line > 0 ? ":" + std::to_string(violation.line) : "";
      violation.field = path.string() + where + ": " + violation.field;
      violation.line = violation.column = 0;
      problems.push_back(std::move(violation));
    }
    return nullptr;
  }
}

TargetConfig read_target(FieldReader in, const EngineConfig& config, RecordingShelf& shelf,
                         std::vector<Violation>& violations) {
  TargetConfig target;
  in.required("name");
  in.text("name", target.name);
  refuse_foreign_fields(in);
  if (in.has("duration_s")) target.duration = read_time(in, "duration_s", above(0.0, kLongestRun_s));
  if (in.has("recording")) {
    target.motion = read_recorded(in.child("recording"), config, shelf, target, violations);
  } else {
    read_start_time(in, config.scan_period, target);
    if (in.has("jump_markov")) {
      target.motion = read_jump_markov(in, config);
    } else {
      target.motion = read_script(in, config.scan_period);
    }
  }
  in.number("weight", above(0.0, 1e9), 1.0, target.weight);
  in.flag("calibration_flight", target.calibration_flight);
  target.target_class = read_target_class(in, config.tracker.classes);
  target.track_start = read_track_start(in.child("start"), config);
  return target;
}

}  // namespace dwell
