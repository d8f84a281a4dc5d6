#pragma once

#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "radar/frames.hpp"
#include "tracker/measurement.hpp"
#include "tracker/mode_bank.hpp"

/// The motions and noises over which the laws are run. A new alternative of either variant gets its rows
/// here.
namespace dwell::catalogue {

template <class Model>
struct Named {
  std::string name;
  Model model;
  friend void PrintTo(const Named& row, std::ostream* out) { *out << row.name; }
};

using NamedMotion = Named<Motion>;
static_assert(std::variant_size_v<Motion> == 2, "a new motion needs a row below");
inline std::vector<NamedMotion> every_motion() {
  return {{"constant_velocity", ConstantVelocity{}},
          {"left_turn", CoordinatedTurn{10.0 * kDegree}},
          {"right_turn", CoordinatedTurn{-10.0 * kDegree}},
          {"several_circles", CoordinatedTurn{3.0}},
          {"slow_turn", CoordinatedTurn{-1e-4}},
          {"hardly_a_turn", CoordinatedTurn{1e-12}}};
}

using NamedNoise = Named<ProcessNoise>;
static_assert(std::variant_size_v<ProcessNoise> == 4, "a new noise needs a row below");
inline std::vector<NamedNoise> every_noise() {
  return {{"none", NoProcessNoise{}},
          {"white", WhiteNoiseAcceleration{0.1}},
          {"strong_white", WhiteNoiseAcceleration{2000.0}},
          {"piecewise", PiecewiseAcceleration{3.0}},
          {"piecewise_quarter", PiecewiseAcceleration{100.0, 0.25}},
          {"diagonal", DiagonalNoise{{0.3, 0.3, 0.1, 0.1}, 0.5}}};
}

using NamedTrailing = Named<TrailingMotion>;
static_assert(std::variant_size_v<TrailingMotion> == 3, "a new motion needs a row below");
inline std::vector<NamedTrailing> every_trailing() {
  return {{"constant_acceleration", ConstantAcceleration{2.0}},
          {"singer", Singer{10.0, 20.0}},
          {"singer_short", Singer{10.0, 0.3}},
          {"singer_long", Singer{10.0, 1e4}},
          {"unknown_turn_rate", UnknownTurnRate{1.0, 1e-4}}};
}

/// One mode of every motion, of either kind, with white noise.
inline std::vector<Mode> every_mode() {
  std::vector<Mode> modes;
  for (const NamedMotion& row : every_motion()) modes.push_back({row.name, row.model, WhiteNoiseAcceleration{1.0}});
  for (const NamedTrailing& row : every_trailing()) modes.push_back({row.name, {}, NoProcessNoise{}, row.model});
  return modes;
}

/// The rate of a motion, rad/s, counter-clockwise positive.
inline double turn_rate(const Motion& motion) {
  const auto* turn = std::get_if<CoordinatedTurn>(&motion);
  return turn == nullptr ? 0.0 : turn->turn_rate_radps;
}

/// x' = A x: the motion as a differential equation, p' = v and v' = w (-vy, vx).
inline StateMatrix generator(const Motion& motion) {
  StateMatrix a = StateMatrix::Zero();
  a(kX, kVx) = a(kY, kVy) = 1.0;
  a(kVy, kVx) = turn_rate(motion);
  a(kVx, kVy) = -turn_rate(motion);
  return a;
}

/// sum_k (-u^2)^k u^first / (first + 2k)! in long double, first >= 0: cos u, sin u, 1 - cos u, u - sin u.
inline long double alternating_series(long double u, int first) {
  long double term = 1.0L;
  for (int k = 1; k <= first; ++k) term *= u / static_cast<long double>(k);
  long double sum = 0.0L;
  for (int k = first; k < first + 40; k += 2) {
    sum += term;
    term *= -u * u / static_cast<long double>((k + 1) * (k + 2));
  }
  return sum;
}

inline std::vector<UpdateForm> every_update() {
  return {UpdateForm::kEkf, UpdateForm::kConverted, UpdateForm::kCubature};
}

inline std::string name_of(UpdateForm form) {
  switch (form) {
    case UpdateForm::kEkf:
      return "ekf";
    case UpdateForm::kConverted:
      return "converted";
    case UpdateForm::kCubature:
      break;
  }
  return "cubature";
}

/// The names of all banks, out of `bank_names()`.
inline std::vector<std::string> every_bank() {
  std::vector<std::string> names;
  std::istringstream text(bank_names());
  for (std::string name; std::getline(text >> std::ws, name, ',');) names.push_back(name);
  return names;
}

}  // namespace dwell::catalogue
