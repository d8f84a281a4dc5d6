#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tracker/process_noise.hpp"

namespace dwell {

/// One motion model of an IMM.
struct Mode {
  std::string name;
  Motion motion = ConstantVelocity{};
  ProcessNoise noise = NoProcessNoise{};
};

/// The modes of an IMM and the Markov chain between them.
/// transition(i, j) is from mode i to mode j over `transition_interval_s`: rows sum to one.
struct ModeBank {
  std::vector<Mode> modes;
  Eigen::MatrixXd transition;
  double transition_interval_s = 1.0;
  Eigen::VectorXd initial_probability;
};

/// A bank over one prediction interval: what the filter runs on.
struct DiscreteBank {
  std::vector<StateMatrix> f;  ///< F_j
  std::vector<StateMatrix> q;  ///< Q_j
  Eigen::MatrixXd transition;  ///< M x M, rows sum to one

  int size() const { return static_cast<int>(f.size()); }
};

/// The bank over dt seconds. The chain is a matrix power where dt is a whole number of intervals, else the
/// principal power Pi^(dt / interval); empty where that is no stochastic matrix (a chain of discrete time that no
/// chain of continuous time makes).
/// Requires `divides(mode.noise, dt_s)` of every mode.
std::optional<DiscreteBank> discretise(const ModeBank& bank, double dt_s);

/// Stochastic matrix over `ratio` of the interval that `transition` is given for; empty where there is none by the
/// principal power. Requires ratio >= 0. Accuracy 1e-13.
std::optional<Eigen::MatrixXd> transition_over(const Eigen::MatrixXd& transition, double ratio);

/// The named banks, tracker/named_banks.cpp. Empty for an unknown name.
std::optional<ModeBank> named_bank(std::string_view name);
/// Their names, separated by commas, for messages.
std::string bank_names();

}  // namespace dwell
