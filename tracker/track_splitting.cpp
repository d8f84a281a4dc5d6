#include "tracker/track_splitting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "radar/assert.hpp"
#include "tracker/particle/weights.hpp"

namespace dwell {

Numerics predict(const DiscreteBank& bank, std::span<const TrackComponent> components,
                 std::vector<TrackComponent>& predicted) {
  predicted.assign(components.begin(), components.end());
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Numerics moved = predict(bank, components[i].estimate, predicted[i].estimate);
    if (moved != Numerics::kOk) return moved;
  }
  return Numerics::kOk;
}

ImmEstimate merged(std::span<const TrackComponent> components) {
  if (components.size() == 1) return components.front().estimate;
  const int modes = components.front().estimate.size();
  std::vector<WeightedGaussian> parts;
  parts.reserve(components.size() * static_cast<std::size_t>(modes));
  for (const TrackComponent& component : components) {
    for (int j = 0; j < modes; ++j) {
      parts.push_back({j, component.weight * component.estimate.probability[j],
                       component.estimate.modes[static_cast<std::size_t>(j)]});
    }
  }
  return moments_by_mode(parts, modes);
}

Numerics TrackSplitting::look(const Sensor& sensor, UpdateForm form, double gate, const State& pointing,
                              std::span<const Plot> plots, std::vector<TrackComponent>& components, Outcome& outcome) {
  DWELL_ASSERT(!components.empty());
  split_.clear();
  by_plot_.assign(plots.size(), 0.0);
  double none = 0.0;
  for (const TrackComponent& component : components) {
    const Numerics listed = events_.list(sensor, form, gate, component.estimate, pointing, plots);
    if (listed != Numerics::kOk) return listed;
    const auto split = [&](std::optional<std::size_t> event, double weight, std::size_t plot) {
      if (!(weight > 0.0)) return;
      TrackComponent& part = split_.emplace_back(component);
      part.weight *= weight;
      events_.condition(event, part.estimate);
      std::shift_right(part.plots.begin(), part.plots.end(), 1);
      part.plots.front() = plot;
    };
    none += component.weight * events_.none();
    split(std::nullopt, events_.none(), TrackComponent::kNoPlot);
    for (std::size_t i = 0; i < events_.size(); ++i) {
      by_plot_[events_.plot(i)] += component.weight * events_.sum(i);
      split(i, events_.sum(i), events_.plot(i));
    }
  }
  outcome = {none, std::nullopt};
  double most = none;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    outcome.likelihood_ratio += by_plot_[i];
    if (by_plot_[i] <= most) continue;
    most = by_plot_[i];
    outcome.likeliest = i;
  }
  if (!(outcome.likelihood_ratio > 0.0) || !std::isfinite(outcome.likelihood_ratio)) return Numerics::kNotFinite;
  merge_alike();
  prune();
  std::swap(components, split_);
  return Numerics::kOk;
}

void TrackSplitting::merge_alike() {
  std::stable_sort(split_.begin(), split_.end(),
                   [](const TrackComponent& a, const TrackComponent& b) { return a.plots < b.plots; });
  std::size_t kept = 0;
  for (std::size_t first = 0; first < split_.size();) {
    std::size_t end = first;
    double weight = 0.0;
    for (; end < split_.size() && split_[end].plots == split_[first].plots; ++end) weight += split_[end].weight;
    const auto alike = std::span(split_).subspan(first, end - first);
    for (TrackComponent& component : alike) component.weight /= weight;
    TrackComponent one{weight, merged(alike), split_[first].plots};
    split_[kept++] = std::move(one);
    first = end;
  }
  split_.resize(kept);
}

/// And the weights sum to one again.
void TrackSplitting::prune() {
  std::stable_sort(split_.begin(), split_.end(),
                   [](const TrackComponent& a, const TrackComponent& b) { return a.weight > b.weight; });
  double total = 0.0;
  for (const TrackComponent& component : split_) total += component.weight;
  std::size_t kept = 0;
  double sum = 0.0;
  while (kept < std::min(split_.size(), kMostComponents) && (kept == 0 || split_[kept].weight > kLeastWeight * total)) {
    sum += split_[kept++].weight;
  }
  split_.resize(kept);
  for (TrackComponent& component : split_) component.weight /= sum;
}

}  // namespace dwell
