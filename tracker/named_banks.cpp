#include <array>
#include <cmath>

#include "radar/frames.hpp"
#include "tracker/mode_bank.hpp"

namespace dwell {
namespace {

Eigen::MatrixXd matrix(int size, std::initializer_list<double> row_major) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(row_major.begin(), size, size);
}

Eigen::VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), std::ssize(values));
}

/// Three nearly constant velocity modes, their chain found by search on 15 recorded flights at looks every 1, 3 and 6
/// s: mean NEES / n in .74 .. 1.37 (tests/scenarios/flights_test.cpp). A stay of 167 s in cruise and 67 s in a turn.
ModeBank cruise_and_turn() {
  return {{{"cruise", ConstantVelocity{}, WhiteNoiseAcceleration{0.1}},
           {"turn", ConstantVelocity{}, WhiteNoiseAcceleration{60.0}},
           {"hard_turn", ConstantVelocity{}, WhiteNoiseAcceleration{2000.0}}},
          matrix(3, {.9940, .0055, .0005, .0100, .9850, .0050, .0100, .1400, .8500}),
          1.0,
          vector({.9, .05, .05})};
}

/// cruise_and_turn with turns of 7 deg/s either way, that of 3 g at 240 m/s, for targets that turn hard or in clutter:
/// a turn's own mode keeps the gate small that the white noise of hard_turn opens. Half circles of 4 g are followed
/// with three quarters of the error, and with .3 false plots in the gate a tenth of 3 g turns is lost, not five sixths
/// (tests/scenarios/soak_clutter_test.cpp). It costs two modes.
ModeBank manoeuvring() {
  const double rate = 7.0 * kDegree;
  return {{{"cruise", ConstantVelocity{}, WhiteNoiseAcceleration{0.1}},
           {"turn", ConstantVelocity{}, WhiteNoiseAcceleration{60.0}},
           {"hard_turn", ConstantVelocity{}, WhiteNoiseAcceleration{2000.0}},
           {"left_turn", CoordinatedTurn{rate}, WhiteNoiseAcceleration{20.0}},
           {"right_turn", CoordinatedTurn{-rate}, WhiteNoiseAcceleration{20.0}}},
          matrix(5, {.9930, .0050, .0004, .0008, .0008, .0100, .9810, .0030, .0030, .0030, .0100, .1400, .8300,
                     .0100, .0100, .0150, .0300, .0050, .9490, .0010, .0150, .0300, .0050, .0010, .9490}),
          1.0,
          vector({.85, .05, .04, .03, .03})};
}

/// Evans et al. (2005), (30): B = diag(sqrt(.1), sqrt(.1), .1, .1) and sqrt(10) B while manoeuvring.
ModeBank as_printed() {
  const State b(std::sqrt(0.1), std::sqrt(0.1), 0.1, 0.1);
  return {{{"cruise", ConstantVelocity{}, DiagonalNoise{b}},
           {"manoeuvre", ConstantVelocity{}, DiagonalNoise{std::sqrt(10.0) * b}}},
          matrix(2, {.95, .05, .3, .7}),
          1.0,
          vector({.9, .1})};
}

/// as_printed's chain on noise that covers its 500 m/s change of velocity in 3 s.
ModeBank evans_practical() {
  return {{{"cruise", ConstantVelocity{}, PiecewiseAcceleration{0.3}},
           {"manoeuvre", ConstantVelocity{}, PiecewiseAcceleration{100.0}}},
          matrix(2, {.95, .05, .3, .7}),
          1.0,
          vector({.9, .1})};
}

/// Liu, Hwang (2011), (22)-(24): left turn, right turn at 10 deg/s, and constant velocity.
ModeBank liu_hwang() {
  const double rate = 10.0 * kDegree;
  return {{{"left_turn", CoordinatedTurn{rate}, PiecewiseAcceleration{1.0}},
           {"right_turn", CoordinatedTurn{-rate}, PiecewiseAcceleration{1.0}},
           {"constant_velocity", ConstantVelocity{}, PiecewiseAcceleration{1.0}}},
          matrix(3, {.6, .2, .2, .2, .6, .2, .2, .2, .6}),
          1.0,
          vector({1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0})};
}

struct NamedBank {
  std::string_view name;
  ModeBank (*make)();
};

constexpr std::array kBanks{
    NamedBank{"as_printed", as_printed},           NamedBank{"cruise_and_turn", cruise_and_turn},
    NamedBank{"evans_practical", evans_practical}, NamedBank{"liu_hwang", liu_hwang},
    NamedBank{"manoeuvring", manoeuvring},
};

}  // namespace

std::optional<ModeBank> named_bank(std::string_view name) {
  for (const NamedBank& bank : kBanks) {
    if (bank.name == name) return bank.make();
  }
  return std::nullopt;
}

std::string bank_names() {
  std::string names;
  for (const NamedBank& bank : kBanks) names += (names.empty() ? "" : ", ") + std::string(bank.name);
  return names;
}

}  // namespace dwell
