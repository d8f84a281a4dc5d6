#pragma once

#include <cstdint>
#include <vector>

#include "bandit/policy.hpp"

namespace dwell {

/// The covariances of tracks under plans of looks, before any of them is made.
///
/// The path of a track is what its IMM predicts without a look: means x_j[k], probabilities c_j[k] by the chain and the
/// guards alone, k = 0 now. On it the covariances of the modes move by a map that depends on nothing that will be
/// measured:
///
///   predict   P_j <- F_j (sum_i mu_i|j P_i) F_j' + Qs_j,  Qs_j = F_j (sum_i mu_i|j d_ij d_ij') F_j' + Q_j
///   look      P_j <- p (I - K_j H_j) P_j + (1 - p) P_j    H_j at x_j[k], R and P_d at the combined mean, p = P_d F
///   cost      weight sum_j c_j[k] tr(W P_j)
///
/// with mu_i|j the mixing probabilities, d_ij the means less their mixture (tracker/imm.hpp) and F the probability that
/// a target not looked at until k is in the footprint (tracker/footprint.hpp). Both maps are monotone and concave:
/// larger covariances lead to no smaller ones, and what holds of Riccati steps by that holds here.
///
/// Modes with trailing states (accelerations, a turn rate) are taken by what is seen of them, F and Q of DiscreteBank.
///
/// An approximation. Of a linear Gaussian track with one mode it is exact. Of an IMM the cost of the first look is the
/// exact first sum of ExpectedCost; left out are the spread of the means, which on the path is the same under every
/// plan, and what later looks tell of the mode: LookAhead has both.
///
/// Beliefs are made once and shared by all plans that give a track the same looks.
/// Errors   std::length_error where beliefs would take more than kMostCovariances.
/// Cost     `lay`: O(scans tracks sensors modes n^3). A belief: O(modes n^3). No allocation once the stores have grown.
class PredictedPaths {
 public:
  using Belief = std::uint32_t;
  static constexpr Belief kNobody = 0xffffffff;
  static constexpr int kNoLook = 0;  ///< as a choice; 1 + sensor is a look
  static constexpr int kMostScans = 8;
  static constexpr std::size_t kMostCovariances = std::size_t{1} << 20;  ///< 128 MB: more is not planned in a second

  /// `scale` multiplies process noise (with the spread that the mixing adds) and measurement noise.
  explicit PredictedPaths(double scale = 1.0) : scale_(scale) {}

  /// Forgets all beliefs and lays the paths of the situation's tracks over scans 0 (now) .. scans - 1.
  /// Requires 1 <= scans <= kMostScans; the situation outlives the paths.
  void lay(const Situation& situation, int scans);

  int scans() const { return scans_; }
  std::size_t tracks() const { return tracks_; }
  std::size_t sensors() const { return sensors_; }
  std::size_t modes() const { return modes_; }
  /// As a choice: every sensor that covers the track at once, which no single look betters.
  int every_sensor() const { return static_cast<int>(sensors_) + 1; }

  /// The track is alive, the sensor up and the track within its coverage on the path; of now: the pair is feasible.
  bool covers(std::size_t track, std::size_t sensor, int scan) const { return look(track, scan, sensor).covered; }

  /// Before scan 0.
  Belief start(std::size_t track) const { return static_cast<Belief>(track); }
  /// Never looked at, after `scan`, -1 .. scans - 1.
  Belief idle(std::size_t track, int scan);
  /// One scan after `belief`, with a look or without.
  Belief after(Belief belief, int choice);
  std::size_t track(Belief belief) const { return heads_[belief].track; }
  int scan(Belief belief) const { return heads_[belief].scan; }
  double cost(Belief belief) const { return heads_[belief].cost; }
  /// Of the modes.
  const StateMatrix* covariances(Belief belief) const { return covariances_.data() + belief * modes_; }

  /// The map of one scan under a scale of one's own: from the covariances of a belief to those after its next scan.
  void step(Belief belief, int choice, double scale, StateMatrix* to) const;
  /// Its parts: `from` and `to` may not be the same.
  void predict(std::size_t track, int scan, double scale, const StateMatrix* from, StateMatrix* to) const;
  /// In place. `rest` takes I - K_j H_j of each mode where it is not null.
  void look(std::size_t track, int scan, std::size_t sensor, double scale, StateMatrix* covariances,
            StateMatrix* rest = nullptr) const;
  /// p of a look; 0 where it is of no use.
  double detection(std::size_t track, int scan, std::size_t sensor) const;
  /// mu_i|j of the way to `scan` >= 1.
  double mixing(std::size_t track, int scan, std::size_t from, std::size_t to) const {
    return mixing_[(place(track, scan) * modes_ + to) * modes_ + from];
  }
  const StateMatrix& transition(std::size_t mode) const { return situation_->bank->f[mode]; }
  double weight(std::size_t track) const { return situation_->tracks[track].weight; }
  /// c_j.
  double probability(std::size_t track, int scan, std::size_t mode) const {
    return mode_places_[place(track, scan) * modes_ + mode].probability;
  }
  /// weight sum_j c_j tr(W P_j) of a track after `scan`.
  double cost(std::size_t track, int scan, const StateMatrix* covariances) const;

 private:
  struct Head {
    std::uint32_t track;
    int scan;
    double cost;
  };
  /// Of a mode of a track in a scan, and of the way to it.
  struct ModePlace {
    State mean = State::Zero();
    double probability = 0.0;
    StateMatrix noise = StateMatrix::Zero();  // Qs
  };
  /// Of a sensor, a track and a scan.
  struct Look {
    bool covered = false;
    bool useful = false;  // the numbers are good
    double p = 0.0;
    Matrix2 r = Matrix2::Zero();
  };

  std::size_t place(std::size_t track, int scan) const {
    return track * static_cast<std::size_t>(scans_) + static_cast<std::size_t>(scan);
  }
  const Look& look(std::size_t track, int scan, std::size_t sensor) const {
    return looks_[place(track, scan) * sensors_ + sensor];
  }
  void lay_track(std::size_t track);
  void mix(std::size_t track, int scan);
  Eigen::MatrixXd guarded_transition(std::size_t track, int scan);
  void lay_looks(std::size_t track, int scan);
  void look_with_all(std::size_t track, int scan, double scale, StateMatrix* covariances) const;
  Belief make(Belief from, int choice);

  double scale_;
  const Situation* situation_ = nullptr;
  int scans_ = 0;
  std::size_t tracks_ = 0;
  std::size_t sensors_ = 0;
  std::size_t modes_ = 0;
  std::vector<ModePlace> mode_places_;    // [track][scan][mode]
  std::vector<double> mixing_;            // [track][scan][to mode][from mode]: of the way to the scan
  std::vector<Look> looks_;               // [track][scan][sensor]
  std::vector<MeasurementJacobian> h_;    // [track][scan][sensor][mode]
  std::vector<Head> heads_;               // of beliefs; the first are the starts of the tracks
  std::vector<StateMatrix> covariances_;  // [belief][mode]
  std::vector<Belief> next_;              // [belief][choice]
  ImmEstimate on_path_;
  std::vector<PredictedMeasurement> measurements_;
};

}  // namespace dwell
