#include "tracker/joint_association.hpp"

#include <algorithm>
#include <tuple>

#include "radar/assert.hpp"

namespace dwell {

void JointAssociation::reserve(std::size_t plots) {
  before_.reserve((plots + 1) << kMostRivals);
  after_.reserve((plots + 1) << kMostRivals);
}

/// All events of the tracks so far, each with what the next one may take besides.
void JointAssociation::deal_out(std::span<const double> ratio, std::uint32_t track) {
  const std::size_t before = events_.size();
  for (std::size_t k = 0; k < before && events_.size() <= kMostEvents; ++k) {
    for (std::size_t bit = 0; bit < shared_.size(); ++bit) {
      const double weight = ratio[shared_[bit]];
      Event event = events_[k];
      if (weight <= 0.0 || (event.plots >> bit & 1U) != 0) continue;
      event.plots |= std::uint64_t{1} << bit;
      event.tracks |= std::uint32_t{1} << track;
      event.weight *= weight;
      if (track == 0) event.mine = shared_[bit] + 1;
      events_.push_back(event);
    }
  }
}

/// Says no where there are too many.
bool JointAssociation::list_events(std::span<const double> own, std::span<const double> ratio, std::size_t rivals) {
  const std::size_t plots = own.size();
  shared_.clear();
  for (std::size_t i = 0; i < plots; ++i) {
    bool taken = own[i] > 0.0;
    for (std::size_t s = 0; s < rivals; ++s) taken = taken || ratio[s * plots + i] > 0.0;
    if (taken) shared_.push_back(static_cast<std::uint32_t>(i));
  }
  if (shared_.size() > 64) return false;
  events_.assign(1, Event{});
  deal_out(own, 0);
  for (std::size_t s = 0; s < rivals; ++s) deal_out(ratio.subspan(s * plots, plots), static_cast<std::uint32_t>(s + 1));
  return events_.size() <= kMostEvents;
}

void JointAssociation::solve_pruned(std::span<const double> own, std::span<const double> ratio, std::size_t rivals,
                                    std::span<double> factor) {
  DWELL_ASSERT(rivals <= kMostRivals && own.size() == factor.size() && ratio.size() == rivals * factor.size());
  if (!list_events(own, ratio, rivals)) return solve(ratio, rivals, factor);
  const auto who = [](const Event& event) { return std::tie(event.tracks, event.plots); };
  std::sort(events_.begin(), events_.end(), [&](const Event& a, const Event& b) {
    return who(a) != who(b) ? who(a) < who(b) : std::tie(b.weight, a.mine) < std::tie(a.weight, b.mine);
  });
  std::fill(factor.begin(), factor.end(), 0.0);
  double none = 0.0;
  for (std::size_t k = 0; k < events_.size(); ++k) {
    const Event& event = events_[k];
    if (k > 0 && who(event) == who(events_[k - 1])) continue;
    (event.mine == 0 ? none : factor[event.mine - 1]) += event.weight;
  }
  for (std::size_t i = 0; i < factor.size(); ++i) factor[i] = own[i] > 0.0 ? factor[i] / (own[i] * none) : 1.0;
}

void JointAssociation::solve(std::span<const double> ratio, std::size_t rivals, std::span<double> factor) {
  DWELL_ASSERT(rivals <= kMostRivals && ratio.size() == rivals * factor.size());
  const std::size_t plots = factor.size();
  const std::size_t sets = std::size_t{1} << rivals;
  before_.assign((plots + 1) * sets, 0.0);
  after_.assign((plots + 1) * sets, 0.0);
  before_[0] = 1.0;
  for (std::size_t i = 0; i < plots; ++i) {
    const double* from = &before_[i * sets];
    double* to = &before_[(i + 1) * sets];
    for (std::size_t set = 0; set < sets; ++set) {
      to[set] += from[set];
      for (std::size_t s = 0; s < rivals; ++s) {
        const std::size_t taken = set | (std::size_t{1} << s);
        if (taken != set) to[taken] += from[set] * ratio[s * plots + i];
      }
    }
  }
  for (std::size_t set = 0; set < sets; ++set) after_[plots * sets + set] = 1.0;
  for (std::size_t i = plots; i-- > 0;) {
    const double* from = &after_[(i + 1) * sets];
    double* to = &after_[i * sets];
    for (std::size_t set = 0; set < sets; ++set) {
      to[set] = from[set];
      for (std::size_t s = 0; s < rivals; ++s) {
        const std::size_t taken = set | (std::size_t{1} << s);
        if (taken != set) to[set] += from[taken] * ratio[s * plots + i];
      }
    }
  }
  const double all = after_[0];
  for (std::size_t i = 0; i < plots; ++i) {
    double free = 0.0;
    for (std::size_t set = 0; set < sets; ++set) free += before_[i * sets + set] * after_[(i + 1) * sets + set];
    factor[i] = free / all;
  }
}

}  // namespace dwell
