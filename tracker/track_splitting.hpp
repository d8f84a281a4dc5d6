#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "tracker/association_events.hpp"

namespace dwell {

/// One account of which plots of its looks were a track's: what the target then is, and how likely the account is.
struct TrackComponent {
  static constexpr std::size_t kScansBack = 2;
  static constexpr std::size_t kNoPlot = static_cast<std::size_t>(-1);

  double weight = 1.0;  ///< sum one over a track's
  ImmEstimate estimate;
  std::array<std::size_t, kScansBack> plots{kNoPlot, kNoPlot};  ///< by their places in the latest looks, the last first
};

/// One interval on: each component by `predict` of tracker/imm.hpp. `predicted` must not be the same object.
Numerics predict(const DiscreteBank& bank, std::span<const TrackComponent> components,
                 std::vector<TrackComponent>& predicted);

/// The components' moments and probability, mode by mode. Requires weights that sum to one.
ImmEstimate merged(std::span<const TrackComponent> components);

/// Integrated track splitting: a track is a mixture of components, and a look splits each of them into one for every
/// event of tracker/association_events.hpp.
///
///   p w_0   the component without a plot of its own, its modes weighed by w_0j
///   p w_i   updated with plot i, its modes weighed by w_ij             w_0 = sum_j w_0j,  w_i = sum_j w_ij
///
/// The sum of all is the likelihood ratio of a target that is there to none. Components that agree on the plots of the
/// last kScansBack looks are then merged, mode by mode; PDA merges after every look (kScansBack = 0). What it saves is
/// the target that manoeuvres: its next plot lies on from the one that was right, and of a mixture that is merged at
/// once the covariance takes in the false ones, its gate their successors.
///
/// kScansBack = 2: in a 3 g turn in clutter one look back loses a third more targets, three no fewer with half as many
/// components again (tests/scenarios/soak_clutter_test.cpp has the figures of two).
/// Requires a bank without trailing states. Cost that of PDA for each component; allocates.
/// Source   Musicki, La Scala, Evans (2007), IEEE T-AES 43(4); the merging: Singer, Sea, Housewright (1974), IEEE T-IT
///          20(4), N-scan filters.
class TrackSplitting {
 public:
  /// The likeliest stay. 30: four times what a look leaves of a turn at .3.
  static constexpr std::size_t kMostComponents = 30;
  /// What weighs less goes: thirty such weigh less than one miss of 300.
  static constexpr double kLeastWeight = 1e-4;

  struct Outcome {
    double likelihood_ratio = 1.0;
    std::optional<std::size_t> likeliest;  ///< the plot likelier than any other and than none
  };

  /// Splits the predicted components, at least one, by the plots of a look that points at `pointing`.
  /// Errors   as AssociationEvents::list; the components are then unchanged.
  Numerics look(const Sensor& sensor, UpdateForm form, double gate, const State& pointing, std::span<const Plot> plots,
                std::vector<TrackComponent>& components, Outcome& outcome);

 private:
  void merge_alike();
  void prune();

  AssociationEvents events_;
  std::vector<double> by_plot_;  // weight of each plot of the look, over the components
  std::vector<TrackComponent> split_;
};

}  // namespace dwell
