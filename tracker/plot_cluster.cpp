#include "tracker/plot_cluster.hpp"

#include <algorithm>

#include "tracker/footprint.hpp"

namespace dwell {

void PlotCluster::reserve(std::size_t plots, std::size_t modes) {
  plots_ = plots;
  modes_ = modes;
  plot_in_own_.reserve(plots);
  plot_in_cluster_.reserve(plots);
  factor_.reserve(plots);
  own_ratio_.reserve(plots);
  ratio_.reserve(plots * JointAssociation::kMostRivals);
  joint_.reserve(plots);
}

void PlotCluster::exclude(TrackId id, const AssociationEvents& own, std::span<const Track> rivals, const Sensor& sensor,
                          UpdateForm form, double gate, const State& pointing, std::span<const Plot> plots, bool pruned,
                          std::span<double> factor) {
  std::fill(factor.begin(), factor.end(), 1.0);
  chosen_.clear();
  if (own.size() == 0) return;
  gate_rivals(id, rivals, sensor, form, gate, pointing, plots);
  join(own, plots.size());
  choose();
  if (chosen_.empty()) return;
  ratio_.assign(chosen_.size() * plots.size(), 0.0);
  for (std::size_t s = 0; s < chosen_.size(); ++s) {
    const Rival& rival = rivals_[chosen_[s]];
    for (std::size_t i = 0; i < rival.events.size(); ++i) {
      ratio_[s * plots.size() + rival.events.plot(i)] = rival.existence * rival.events.sum(i) / rival.none;
    }
  }
  factor_.resize(plots.size());
  if (pruned) {
    own_ratio_.assign(plots.size(), 0.0);
    for (std::size_t i = 0; i < own.size(); ++i) own_ratio_[own.plot(i)] = own.sum(i) / own.none();
    joint_.solve_pruned(own_ratio_, ratio_, chosen_.size(), factor_);
  } else {
    joint_.solve(ratio_, chosen_.size(), factor_);
  }
  for (std::size_t i = 0; i < own.size(); ++i) factor[i] = factor_[own.plot(i)];
}

void PlotCluster::gate_rivals(TrackId id, std::span<const Track> rivals, const Sensor& sensor, UpdateForm form,
                              double gate, const State& pointing, std::span<const Plot> plots) {
  constexpr double kOutside = 1e-4;  // so little of it in the footprint takes no plot worth counting
  while (rivals_.size() < rivals.size()) rivals_.emplace_back().events.reserve(plots_, modes_);
  chosen_.reserve(rivals.size());
  count_ = 0;
  for (const Track& track : rivals) {
    if (track.id == id || !track.alive()) continue;
    if (footprint_probability(sensor, track.combined, pointing) < kOutside) continue;
    Rival& rival = rivals_[count_];
    if (rival.events.list(sensor, form, gate, track.estimate, pointing, plots, track.class_belief) != Numerics::kOk) {
      continue;
    }
    if (rival.events.size() == 0) continue;
    rival.existence = track.existence.value_or(1.0);
    rival.none = 1.0 - rival.existence + rival.existence * rival.events.none();
    rival.joined = false;
    ++count_;
  }
}

/// Marks the rivals whose gates share plots with the track's, or with a marked one's.
void PlotCluster::join(const AssociationEvents& own, std::size_t plots) {
  plot_in_own_.assign(plots, 0);
  for (std::size_t i = 0; i < own.size(); ++i) plot_in_own_[own.plot(i)] = 1;
  plot_in_cluster_ = plot_in_own_;
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t s = 0; s < count_; ++s) {
      Rival& rival = rivals_[s];
      bool shares = false;
      for (std::size_t i = 0; i < rival.events.size(); ++i) {
        shares = shares || plot_in_cluster_[rival.events.plot(i)] != 0;
      }
      if (rival.joined || !shares) continue;
      rival.joined = grown = true;
      for (std::size_t i = 0; i < rival.events.size(); ++i) plot_in_cluster_[rival.events.plot(i)] = 1;
    }
  }
}

void PlotCluster::choose() {
  for (std::size_t s = 0; s < count_; ++s) {
    Rival& rival = rivals_[s];
    if (!rival.joined) continue;
    chosen_.push_back(s);
    rival.weight = rival.weight_on_own = 0.0;
    for (std::size_t i = 0; i < rival.events.size(); ++i) {
      const double ratio = rival.existence * rival.events.sum(i) / rival.none;
      rival.weight += ratio;
      if (plot_in_own_[rival.events.plot(i)] != 0) rival.weight_on_own += ratio;
    }
  }
  if (chosen_.size() <= JointAssociation::kMostRivals) return;
  std::sort(chosen_.begin(), chosen_.end(), [&](std::size_t a, std::size_t b) {
    const Rival& one = rivals_[a];
    const Rival& other = rivals_[b];
    if (one.weight_on_own != other.weight_on_own) return one.weight_on_own > other.weight_on_own;
    if (one.weight != other.weight) return one.weight > other.weight;
    return a < b;
  });
  chosen_.resize(JointAssociation::kMostRivals);
}

}  // namespace dwell
