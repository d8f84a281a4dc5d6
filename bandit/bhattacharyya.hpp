#pragma once

#include "bandit/policy.hpp"
#include "bandit/policy_settings.hpp"

namespace dwell {

/// A bound on the probability of taking a wrong mode for the likeliest after a look, from the predicted measurements
/// of the modes and their probabilities c:
///
///   B = sum_{i<j} sqrt(c_i c_j) exp(-k_ij)
///   k_ij = (z_i - z_j)' (S_i + S_j)^-1 (z_i - z_j) / 4 + ln( |(S_i + S_j) / 2| / sqrt(|S_i| |S_j|) ) / 2
///
/// Without a look every k is 0. B may exceed one. Source: Liu, Hwang (2011), (13), with the determinant of the mean
/// (the printed |S_i + S_j| / 2 is no bound). Bearings are subtracted the short way round.
double bhattacharyya_bound(const Sensor& sensor, UpdateForm form, const Eigen::VectorXd& probability,
                           const std::vector<PredictedMeasurement>& measurements);

/// The look that lowers the bound on mode errors most: score = weight P_d (B without - B with).
///
/// It is a criterion on *modes*: it does not minimise the position error, and on Liu and Hwang's own example round
/// robin has a third of its position error. SaImm's beta trades the two.
class Bhattacharyya final : public Policy {
 public:
  explicit Bhattacharyya(const BhattacharyyaSettings& /*settings*/) {}

  std::string_view name() const override { return "bhattacharyya"; }

 private:
  void score(const Situation& situation, std::span<Candidate> candidates) override;

  std::vector<PredictedMeasurement> measurements_;
};

}  // namespace dwell
