#pragma once

#include <vector>

#include "radar/guard.hpp"
#include "radar/random.hpp"
#include "radar/trajectory.hpp"

namespace dwell {

/// A jump Markov linear system over one scan period: x' = F_r' x + L_r' w, r' that of the first guard of mode r that
/// holds at x, and where none does drawn from row r of `transition`.
struct JumpMarkovSystem {
  std::vector<StateMatrix> transition_matrix;   ///< F of each mode
  std::vector<StateMatrix> process_noise_root;  ///< L of each mode, L L' = Q
  Eigen::MatrixXd transition;                   ///< M x M, rows sum to one
  std::vector<Guard> guards{};
};

/// Where a target turns back: outside the circle and still leaving, it turns left or right towards the centre. Where
/// it has become faster than at its start it slows down there, by as much as it turns: the speeds that white-noise
/// accelerations add up to grow without limit, 2000 m/s in a day.
/// Requires a turning circle (speed / rate) inside the area; a wider one is flown round the area, outside it.
struct Area {
  Vector2 centre_m = Vector2::Zero();
  double radius_m = 0.0;
  double turn_rate_radps = 0.0;
};

struct JumpMarkovScript {
  State initial = State::Zero();
  int initial_mode = 0;
  TimePoint start;
  TimePoint end = TimePoint::max();
  Duration scan_period{};
  double altitude_m = 0.0;
  std::optional<Area> area;
};

/// A random target. The mode at the start is `initial_mode`; the mode of each later scan moves the target there.
/// While it turns back its mode still moves on, but the turn replaces the mode's motion.
class JumpMarkovTrajectory final : public Trajectory {
 public:
  JumpMarkovTrajectory(JumpMarkovSystem system, JumpMarkovScript script, RandomStream stream);

  std::optional<State> advance(TimePoint time) override;
  bool ended(TimePoint time) const override { return time > script_.end; }
  double altitude_m() const override { return script_.altitude_m; }
  std::optional<int> mode() const override { return mode_; }

 private:
  void step();
  int next_mode();
  bool holds(const Guard& guard);
  std::optional<double> turn_back_rate() const;

  JumpMarkovSystem system_;
  JumpMarkovScript script_;
  RandomStream stream_;
  State state_;
  int mode_;
  TimePoint now_;
};

/// An index drawn with the given probabilities (summing to one). Takes a row of a matrix without copying it.
int draw_index(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& probability, RandomStream& stream);

}  // namespace dwell
