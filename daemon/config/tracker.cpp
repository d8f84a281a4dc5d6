#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

/// A number without a default: where it is absent nothing stands for it.
void required_number(FieldReader& in, const char* field, const Range& range, double& target) {
  in.required(field);
  if (in.has(field)) in.number(field, range, 1.0, target);
}

/// A motion with trailing states; empty where the mode has none of them.
std::optional<TrailingMotion> read_trailing_motion(FieldReader& in) {
  if (in.has("constant_acceleration")) {
    FieldReader motion = in.child("constant_acceleration");
    ConstantAcceleration model{1.0};
    required_number(motion, "jerk_density", above(0.0, 1e12), model.jerk_density);
    motion.number("start_sigma_mps2", above(0.0, 1e6), 1.0, model.start_sigma_mps2);
    return model;
  }
  if (in.has("singer")) {
    FieldReader motion = in.child("singer");
    Singer model{1.0, 1.0};
    required_number(motion, "sigma_mps2", above(0.0, 1e6), model.sigma_mps2);
    required_number(motion, "time_constant_s", within(0.01, 1e6), model.time_constant_s);
    return model;
  }
  if (in.has("unknown_turn_rate")) {
    FieldReader motion = in.child("unknown_turn_rate");
    UnknownTurnRate model{1.0, 1.0};
    required_number(motion, "acceleration_density", above(0.0, 1e12), model.acceleration_density);
    required_number(motion, "rate_density", above(0.0, 1e6), model.rate_density);
    motion.number("start_sigma_dps", above(0.0, 360.0), kDegree, model.start_sigma_radps);
    return model;
  }
  return std::nullopt;
}

Mode read_mode(FieldReader in, Duration scan_period) {
  Mode mode;
  in.required("name");
  in.text("name", mode.name);
  if (in.has("coordinated_turn")) {
    FieldReader turn = in.child("coordinated_turn");
    double rate_radps = 1.0;  // replaced, or the bank is refused
    turn.required("turn_rate_dps");
    turn.number("turn_rate_dps", within(-360.0, 360.0), kDegree, rate_radps);
    if (rate_radps == 0.0) {
      turn.refuse("turn_rate_dps", turn.value("turn_rate_dps"), "must not be 0: that is constant_velocity");
    } else {
      mode.motion = CoordinatedTurn{rate_radps};
    }
  }
  mode.trailing = read_trailing_motion(in);
  if (mode.trailing && in.has("process_noise")) {
    in.refuse("process_noise", "", "must not stand with a motion that has its own noise");
  }
  if (in.has("process_noise")) mode.noise = read_process_noise(in.child("process_noise"), scan_period);
  return mode;
}

/// E with E E' = covariance; empty where that is not symmetric and positive semidefinite, to 1e-9 of its largest.
std::optional<Eigen::MatrixXd> semidefinite_root(const Eigen::MatrixXd& covariance) {
  const double rounding = 1e-9 * covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > rounding) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  if (solver.eigenvalues().minCoeff() < -rounding) return std::nullopt;
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// The number of the mode that the field names; 0, with a violation, where there is none.
int read_mode_name(FieldReader& in, const char* field, const std::vector<Mode>& modes) {
  std::string name;
  in.required(field);
  in.text(field, name);
  const auto mode = std::find_if(modes.begin(), modes.end(), [&](const Mode& m) { return m.name == name; });
  if (mode != modes.end()) return static_cast<int>(mode - modes.begin());
  if (!name.empty()) in.refuse(field, in.value(field), "must be the name of a mode of the bank");
  return 0;
}

Guard read_guard(FieldReader in, const std::vector<Mode>& modes) {
  constexpr int kMostRows = 8;
  Guard guard;
  guard.from = read_mode_name(in, "from", modes);
  guard.to = read_mode_name(in, "to", modes);
  if (guard.from == guard.to && in.has("from") && in.value("from") == in.value("to")) {
    in.refuse("to", in.value("to"), "must be another mode than from");
  }
  const int rows = in.count("b");
  if (rows < 1 || rows > kMostRows) in.refuse("b", std::to_string(rows) + " values", "must have 1 to 8 values");
  const auto l = in.numbers("l", within(-1e6, 1e6), {rows * kStateSize});
  const auto b = in.numbers("b", within(-1e12, 1e12), {});
  const auto noise = in.numbers("noise", variance(), {rows, rows * rows});
  if (in.count("l") == 0) in.refuse("l", "", "is required: 4 values for each of b");
  guard.l.setZero(rows, kStateSize);
  guard.b.setZero(rows);
  guard.noise_root.setZero(rows, rows);
  if (!l.empty() && !b.empty()) {
    guard.l = row_major<Eigen::MatrixXd>(l, rows, kStateSize);
    guard.b = row_major<Eigen::VectorXd>(b, rows, 1);
  }
  if (noise.empty()) return guard;
  const bool full = noise.size() > b.size();
  const Eigen::MatrixXd covariance = full ? row_major<Eigen::MatrixXd>(noise, rows, rows)
                                          : Eigen::MatrixXd(row_major<Eigen::VectorXd>(noise, rows, 1).asDiagonal());
  if (const auto root = semidefinite_root(covariance)) {
    guard.noise_root = *root;
  } else {
    in.refuse("noise", "", "must be symmetric and positive semidefinite");
  }
  return guard;
}

/// Modes, chain and start of a bank that is spelled out.
ModeBank read_modes(FieldReader& in, Duration scan_period) {
  ModeBank bank;
  std::set<std::string> names;
  const int count = in.count("mode");
  if (count > Tracker::kMostModes) {
    in.refuse("mode", std::to_string(count) + " modes", "must be at most " + std::to_string(Tracker::kMostModes));
  }
  for (int i = 0; i < count; ++i) {
    bank.modes.push_back(read_mode(in.element("mode", i), scan_period));
    const std::string& name = bank.modes.back().name;
    if (!name.empty() && !names.insert(name).second) in.refuse("mode", name, "names must be unique in the bank");
  }
  bank.transition = Eigen::MatrixXd::Identity(count, count);
  bank.initial_probability = Eigen::VectorXd::Constant(count, 1.0 / count);
  if (count > 1 && in.count("transition") == 0) in.refuse("transition", "", "is required with more than one mode");
  if (const auto transition = read_stochastic(in, "transition", count)) bank.transition = *transition;
  const auto initial = in.numbers("initial_probability", within(0.0, 1.0), {count});
  if (!initial.empty()) {
    bank.initial_probability = row_major<Eigen::VectorXd>(initial, count, 1);
    check_probabilities(in, "initial_probability", bank.initial_probability.transpose());
    bank.initial_probability /= bank.initial_probability.sum();
  }
  in.number("transition_interval_s", within(1e-3, 1e6), 1.0, bank.transition_interval_s);
  for (int i = 0; i < in.count("guard"); ++i) {
    bank.guards.push_back(read_guard(in.element("guard", i), bank.modes));
  }
  return bank;
}

}  // namespace

ProcessNoise read_process_noise(FieldReader in, Duration scan_period) {
  double step_s = 1.0;
  const bool continuous = in.has("white_noise_acceleration");
  if (continuous && in.has("step_s")) {
    in.refuse("step_s", in.value("step_s"), "must not stand with white_noise_acceleration, which has no steps");
  } else if (!continuous) {
    in.number("step_s", within(1e-3, 3600.0), 1.0, step_s);
  }
  ProcessNoise noise = NoProcessNoise{};
  if (continuous) {
    WhiteNoiseAcceleration form{0.0};
    in.number("white_noise_acceleration", within(0.0, 1e12), 1.0, form.q);
    noise = form;
  } else if (in.has("piecewise_acceleration")) {
    PiecewiseAcceleration form{0.0, step_s};
    in.number("piecewise_acceleration", within(0.0, 1e6), 1.0, form.sigma_mps2);
    noise = form;
  } else if (in.has("diagonal")) {
    FieldReader diagonal = in.child("diagonal");
    const auto b = diagonal.numbers("b", within(0.0, 1e6), {kStateSize});
    if (diagonal.count("b") == 0) diagonal.refuse("b", "", "is required: 4 values");
    if (!b.empty()) noise = DiagonalNoise{row_major<State>(b, kStateSize, 1), step_s};
  } else {
    in.refuse("white_noise_acceleration", "",
              "one of white_noise_acceleration, piecewise_acceleration, diagonal is required");
  }
  if (!divides(noise, to_seconds(scan_period))) {
    in.refuse("step_s", number_text(step_s), "must divide scan_period_s");
    return NoProcessNoise{};
  }
  return noise;
}

ModeBank read_bank(FieldReader in, Duration scan_period, const ModeBank& fallback) {
  ModeBank bank = fallback;
  const bool spelled_out = in.count("mode") > 0;
  const std::initializer_list<const char*> rest{"mode", "transition", "initial_probability", "guard"};
  const bool has_rest = in.has("transition_interval_s") ||
                        std::any_of(rest.begin(), rest.end(), [&](const char* field) { return in.count(field) > 0; });
  if (in.has("name")) {
    std::string name;
    in.text("name", name);
    if (const auto named = named_bank(name)) {
      bank = *named;
    } else if (!name.empty()) {
      in.refuse("name", in.value("name"), "must be one of: " + bank_names());
    }
    if (has_rest) in.refuse("name", in.value("name"), "must stand alone: the named bank has its modes and its chain");
  } else if (spelled_out) {
    bank = read_modes(in, scan_period);
  } else if (has_rest) {
    in.refuse("mode", "", "is required where the chain of a bank is given");
  }
  for (const Mode& mode : bank.modes) {
    if (!divides(mode.noise, to_seconds(scan_period))) {
      in.refuse("name", mode.name, "has process noise by steps of 1 s, which must divide scan_period_s");
      return fallback;
    }
  }
  if (!transition_over(bank.transition, to_seconds(scan_period) / bank.transition_interval_s)) {
    in.refuse("transition", "", "has no root for a scan period: give it for transition_interval_s = scan_period_s");
  }
  return bank;
}

namespace {

void read_existence(FieldReader& in, Duration scan_period, TrackerSettings& tracker) {
  if (!tracker.has_existence()) {
    if (in.has("existence")) in.refuse("existence", "", "is of the associations IPDA, ITS and JPDA");
    return;
  }
  FieldReader existence = in.child("existence");
  ExistenceSettings& settings = tracker.existence;
  existence.number("confirm", between(0.0, 1.0), 1.0, settings.confirm);
  existence.number("remove", between(0.0, 1.0), 1.0, settings.remove);
  existence.number("new_targets_per_hour", above(0.0, 1e9), 1.0, settings.new_targets_per_hour);
  double lifetime_s = 1000.0;  // the air picture of a radar is another one after a quarter of an hour
  existence.number("lifetime_s", above(0.0, 1e9), 1.0, lifetime_s);
  settings.survival = std::exp(-to_seconds(scan_period) / lifetime_s);
  if (settings.remove >= settings.confirm) {
    existence.refuse("remove", existence.value("remove"), "must be below confirm");
  }
}

void read_initiation(FieldReader in, bool has_existence, InitiationSettings& initiation) {
  in.number("largest_speed_mps", above(0.0, 1e6), 1.0, initiation.largest_speed_mps);
  if (has_existence && !in.has("m_of_n")) return;
  FieldReader rule = in.child("m_of_n");
  MOfN m_of_n;
  rule.integer("plots", 2, 100, m_of_n.plots);
  rule.integer("looks", 2, 100, m_of_n.looks);
  if (m_of_n.looks < m_of_n.plots) rule.refuse("looks", rule.value("looks"), "must be no less than plots");
  initiation.m_of_n = m_of_n;
}

bool has_trailing(const Mode& mode) { return mode.trailing.has_value(); }

void read_particles(FieldReader in, FieldReader& tracker, EngineConfig& config) {
  ParticleSettings& settings = config.tracker.particles.emplace();
  in.choice("kind", settings.kind);
  in.integer("count", 1, 10'000, settings.count);
  if (config.tracker.association != Association::kNearest) {
    tracker.refuse("particles", "", "must stand with association NEAREST");
  }
  if (config.tracker.update != UpdateForm::kEkf) tracker.refuse("particles", "", "must stand with update EKF");
  if (!config.bank.guards.empty() || std::any_of(config.bank.modes.begin(), config.bank.modes.end(), has_trailing)) {
    tracker.refuse("particles", "", "must stand with a bank without guards and trailing states");
  }
}

}  // namespace

void read_tracker(FieldReader in, EngineConfig& config) {
  FieldReader bank = in.child("bank");
  config.bank = read_bank(bank, config.scan_period, config.bank);
  std::string default_name = kDefaultBank;
  if (!bank.has("name") && bank.count("mode") == 0) bank.text("name", default_name);
  in.choice("update", config.tracker.update);
  in.number("gate", positive_or_infinite(), 1.0, config.tracker.gate);
  in.number("lost_probability", between(0.0, 1.0), 1.0, config.tracker.lost_probability);
  in.number("lost_sigma_m", positive_or_infinite(), 1.0, config.tracker.lost_sigma_m);
  in.number("lost_squared_distance", positive_or_infinite(), 1.0, config.lost_squared_distance);
  in.choice("association", config.tracker.association);
  if (config.tracker.association == Association::kIts &&
      std::any_of(config.bank.modes.begin(), config.bank.modes.end(), has_trailing)) {
    in.refuse("association", "ITS", "must stand with a bank without trailing states");
  }
  if (config.tracker.association == Association::kIts && config.tracker.classes.size() > 0) {
    in.refuse("association", "ITS", "must stand without classes");
  }
  read_existence(in, config.scan_period, config.tracker);
  if (in.has("initiation")) read_initiation(in.child("initiation"), config.tracker.has_existence(), config.initiation);
  if (in.has("particles")) read_particles(in.child("particles"), in, config);
}

}  // namespace dwell
