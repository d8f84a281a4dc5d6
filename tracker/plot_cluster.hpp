#pragma once

#include <span>
#include <vector>

#include "tracker/association_events.hpp"
#include "tracker/joint_association.hpp"
#include "tracker/track.hpp"

namespace dwell {

/// The tracks that share plots with one track, directly or by way of others, and what they leave of them.
///
/// At most JointAssociation::kMostRivals are counted. Where there are more, those that weigh most on the plots in the
/// track's own gate are, then those that weigh most at all; what the others would take counts as false plots.
class PlotCluster {
 public:
  /// Room for looks of so many plots.
  void reserve(std::size_t plots, std::size_t modes);

  /// Fills `factor` with e_i of each plot in the gate of `own` (events of the track `id`, in this look). Rivals that
  /// are lost or whose numbers fail are passed over, as are those outside the footprint. `pruned`:
  /// JointAssociation::solve_pruned.
  void exclude(TrackId id, const AssociationEvents& own, std::span<const Track> rivals, const Sensor& sensor,
               UpdateForm form, double gate, const State& pointing, std::span<const Plot> plots, bool pruned,
               std::span<double> factor);

  /// Rivals counted in the last call.
  std::size_t rivals() const { return chosen_.size(); }

 private:
  struct Rival {
    AssociationEvents events;
    double none = 1.0;  // 1 - existence + existence w_0
    double existence = 1.0;
    bool joined = false;
    double weight_on_own = 0.0;
    double weight = 0.0;
  };
  void gate_rivals(TrackId id, std::span<const Track> rivals, const Sensor& sensor, UpdateForm form, double gate,
                   const State& pointing, std::span<const Plot> plots);
  void join(const AssociationEvents& own, std::size_t plots);
  void choose();

  std::vector<Rival> rivals_;  // room for every track: the first count_ are of this look
  std::size_t count_ = 0;
  std::size_t plots_ = 0;  // room in each rival's events
  std::size_t modes_ = 0;
  std::vector<std::size_t> chosen_;
  std::vector<char> plot_in_cluster_;  // by place in the look
  std::vector<char> plot_in_own_;
  std::vector<double> own_ratio_;
  std::vector<double> ratio_;
  std::vector<double> factor_;
  JointAssociation joint_;
};

}  // namespace dwell
