#pragma once

#include "bandit/policy_settings.hpp"
#include "bandit/track_path.hpp"

namespace dwell {

/// The price of a look at which a track would be looked at just now: an index of the track alone, without a table.
///
///   index(P, s) = [F(idle first) - F(look with s first)] / max(.05, W(look first) - W(idle first))
///
/// F is the discounted cost, weight tr(W P) a scan and gamma a look, and W the discounted number of looks along one
/// orbit each, on the path of the track (TrackPath), in which after the first scan the track is looked at, with the
/// sensor that leaves the least, whenever its cost without a look is at least that of now. 150 scans cover what the
/// discount leaves; the path is laid as far.
/// For one axis that is a scalar, one mode, P_d = 1 and enough steps this is Whittle's discounted index; for more
/// states it is a heuristic whose cost is some percent above the best known (bandit/restless/README.md). Source
/// bandit/restless/orbit_index.hpp, with the tracks' own motion and radars in place of fixed ones.
class OrbitIndex {
 public:
  explicit OrbitIndex(const OrbitSettings& settings) : settings_(settings) {}

  /// Lays the orbit that begins without a look.
  void start(const Situation& situation, std::size_t track);
  /// Of the track that was started: m^2 times its weight.
  double index(std::size_t sensor);
  /// What the look alone gains in this scan, likewise.
  double gain_now(std::size_t sensor);

 private:
  struct Orbit {
    double cost = 0.0;
    double looks = 0.0;
  };
  double cost(const StateMatrix& p) const { return weight_ * (p(kX, kX) + p(kY, kY)); }
  StateMatrix expected(int scan, std::size_t sensor, const StateMatrix& predicted);
  StateMatrix best_look(int scan, const StateMatrix& predicted, double& usage);
  Orbit follow(StateMatrix after, Orbit first);

  OrbitSettings settings_;
  TrackPath path_;
  const Situation* situation_ = nullptr;
  StateMatrix now_ = StateMatrix::Zero();
  double weight_ = 1.0;
  double level_ = 0.0;
  Orbit idle_;
};

/// The pair of largest orbit index.
class OrbitPolicy final : public Policy {
 public:
  explicit OrbitPolicy(const OrbitSettings& settings) : orbit_(settings) {}

  std::string_view name() const override { return "orbit"; }

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;

  OrbitIndex orbit_;
};

/// Scores the candidates by their orbit index, with its parts.
void score_by_orbit(OrbitIndex& orbit, const Situation& situation, std::span<Candidate> candidates);

}  // namespace dwell
