#pragma once

namespace dwell {

/// How the probability that a track's target exists moves and decides (IPDA). It is not there to be seen where it is
/// not in the footprint: the likelihood ratio counts that.
struct ExistenceSettings {
  /// Probability that a target which is there still is one scan later.
  double survival = 1.0;
  /// A tentative track that is likelier than this is confirmed. By the martingale of the likelihood ratio false tracks
  /// are then at most (1 - confirm) / confirm as many as new targets are expected.
  double confirm = 0.99;
  /// A confirmed track that is less likely is lost.
  double remove = 0.005;
  /// Expected in the coverage of a radar: what a tentative track's probability begins with (tracker/initiation.hpp).
  /// 60: a busy sector.
  double new_targets_per_hour = 60.0;
};

/// The probability that the target exists, after plots that are `likelihood_ratio` times as likely with it as without:
/// Bayes' rule, 1 at 1 and 0 at 0. Source: Musicki, Evans, Stankovic (1994), IEEE T-AC 39(6), (16).
inline double existence_after(double before, double likelihood_ratio) {
  const double there = before * likelihood_ratio;
  return there / (1.0 - before + there);
}

}  // namespace dwell
