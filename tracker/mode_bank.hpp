#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "radar/guard.hpp"
#include "tracker/gaussian.hpp"
#include "tracker/process_noise.hpp"
#include "tracker/trailing_motion.hpp"

namespace dwell {

/// One motion model of an IMM.
struct Mode {
  std::string name;
  Motion motion = ConstantVelocity{};
  ProcessNoise noise = NoProcessNoise{};
  std::optional<TrailingMotion> trailing{};  ///< instead of both: a motion with states beyond [x vx y vy]
};

/// The modes of an IMM and how they change: by guards, and where no guard of its mode holds by the Markov chain.
/// transition(i, j) is from mode i to mode j over `transition_interval_s`: rows sum to one. Guards are asked once a
/// prediction, whatever its interval, and are of different modes or exclude each other.
struct ModeBank {
  std::vector<Mode> modes;
  Eigen::MatrixXd transition;
  double transition_interval_s = 1.0;
  Eigen::VectorXd initial_probability;
  std::vector<Guard> guards{};
};

/// A bank over one prediction interval: what the filter runs on. Of modes with trailing states f and q are what is seen
/// of them in [x vx y vy] while nothing is known of these: bounds and plans of several scans take them.
struct DiscreteBank {
  std::vector<StateMatrix> f;  ///< F_j
  std::vector<StateMatrix> q;  ///< Q_j
  Eigen::MatrixXd transition;  ///< M x M, rows sum to one
  std::vector<Guard> guards{};
  std::vector<std::optional<TrailingMotion>> trailing{};  ///< of each mode; no elements where no mode has any
  std::vector<Moved> from_rest{};  ///< of each such mode, from a zero state: of a linear motion its F and Q anywhere
  double interval_s = 0.0;

  int size() const { return static_cast<int>(f.size()); }
};

/// The bank over dt seconds. The chain is a matrix power where dt is a whole number of intervals, else the
/// principal power Pi^(dt / interval); empty where that is no stochastic matrix (a chain of discrete time that no
/// chain of continuous time makes).
/// Requires `divides(mode.noise, dt_s)` of every mode.
std::optional<DiscreteBank> discretise(const ModeBank& bank, double dt_s);

/// The transition probabilities of a target whose state is known as N(x_i, P_i) if its mode is i.
///
///   g_ij  = sum over the guards from i to j of Phi_v(L x_i + b, L P_i L' + E E')
///   Pi_ij = g_ij + (1 - sum_k g_ik) Pi_ij of the chain
///
/// Where guards of a mode overlap the g_ij of its row may sum to more than one: they are scaled to one.
/// Shapes   `modes` M, the result M x M, rows sum to one.
/// Requires finite means and covariances; these may be singular (tracker/normal_orthant.hpp).
/// Source   Liu, Hwang (2011), IV, step 1.
Eigen::MatrixXd transition_at(const DiscreteBank& bank, std::span<const Gaussian> modes);

/// Stochastic matrix over `ratio` of the interval that `transition` is given for; empty where there is none by the
/// principal power. Requires ratio >= 0. Accuracy 1e-13.
std::optional<Eigen::MatrixXd> transition_over(const Eigen::MatrixXd& transition, double ratio);

/// The named banks, tracker/named_banks.cpp. Empty for an unknown name.
std::optional<ModeBank> named_bank(std::string_view name);
/// Their names, separated by commas, for messages.
std::string bank_names();

}  // namespace dwell
