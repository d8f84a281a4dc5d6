#include "tests/bandit/hmm_bandit/gittins_on_grid.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "radar/assert.hpp"

namespace dwell::hmm_bandit {
namespace {

/// The regular grid of the simplex, and where a belief lies in it.
///
/// In the coordinates x_i = m sum_{j >= i} pi_j (m divisions), i = 1 .. n - 1, the grid is the whole numbers with
/// m >= x_1 >= .. >= x_{n-1} >= 0. Freudenthal: x lies in the simplex of floor(x) and the steps in order of falling
/// fractional parts.
class SimplexGrid {
 public:
  using Place = std::vector<int>;

  SimplexGrid(int states, int divisions) : states_(states), divisions_(divisions) {
    Place place;
    enumerate(place, divisions);
  }

  int size() const { return static_cast<int>(places_.size()); }

  Eigen::VectorXd belief(int index) const {
    const Place& x = places_[static_cast<std::size_t>(index)];
    Eigen::VectorXd pi(states_);
    int above = divisions_;
    for (int i = 0; i + 1 < states_; ++i) {
      pi[i] = static_cast<double>(above - x[static_cast<std::size_t>(i)]) / divisions_;
      above = x[static_cast<std::size_t>(i)];
    }
    pi[states_ - 1] = static_cast<double>(above) / divisions_;
    return pi;
  }

  /// Adds share x (barycentric weights of the belief) to a row.
  void spread(const Eigen::VectorXd& pi, double share, Eigen::Ref<Eigen::RowVectorXd> row) const {
    const auto dimensions = static_cast<std::size_t>(states_ - 1);
    Place base(dimensions);
    std::vector<double> part(dimensions);
    double tail = 0.0;
    for (std::size_t i = dimensions; i-- > 0;) {
      tail += pi[static_cast<Eigen::Index>(i) + 1];
      const double x = std::clamp(tail * divisions_, 0.0, static_cast<double>(divisions_));
      base[i] = static_cast<int>(x);
      part[i] = x - base[i];
    }
    std::vector<std::size_t> order(dimensions);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return part[a] > part[b]; });
    double left = 1.0;
    for (std::size_t step = 0; step <= dimensions; ++step) {
      const double next = step < dimensions ? part[order[step]] : 0.0;
      if (left > next) row[at(base)] += share * (left - next);
      left = next;
      if (step < dimensions) ++base[order[step]];
    }
  }

 private:
  void enumerate(Place& place, int most) {
    if (static_cast<int>(place.size()) == states_ - 1) {
      index_.emplace(place, size());
      places_.push_back(place);
      return;
    }
    for (int x = 0; x <= most; ++x) {
      place.push_back(x);
      enumerate(place, x);
      place.pop_back();
    }
  }

  int at(const Place& place) const {
    const auto found = index_.find(place);
    DWELL_ASSERT(found != index_.end());
    return found->second;
  }

  int states_;
  int divisions_;
  std::vector<Place> places_;
  std::map<Place, int> index_;
};

/// The index of the last state of a chain: states of larger index are played on and eliminated one by one.
double index_of_last(Eigen::MatrixXd p, Eigen::VectorXd reward) {
  Eigen::VectorXd time = Eigen::VectorXd::Ones(reward.size());
  const Eigen::Index last = reward.size() - 1;
  std::vector<Eigen::Index> left(static_cast<std::size_t>(last) + 1);
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  while (true) {
    const auto best = std::max_element(left.begin(), left.end(), [&](Eigen::Index a, Eigen::Index b) {
      return reward[a] * time[b] < reward[b] * time[a];
    });
    const Eigen::Index x = *best;
    if (reward[x] * time[last] <= reward[last] * time[x]) return reward[last] / time[last];
    left.erase(best);
    const double stay = 1.0 / (1.0 - p(x, x));
    for (const Eigen::Index i : left) {
      const double through = p(i, x) * stay;
      if (through == 0.0) continue;
      reward[i] += through * reward[x];
      time[i] += through * time[x];
      p.row(i) += through * p.row(x);
    }
  }
}

}  // namespace

double gittins_index_on_grid(const Arm& arm, const Eigen::VectorXd& belief, double discount, int divisions) {
  const SimplexGrid grid(arm.states(), divisions);
  const std::vector<Eigen::MatrixXd> maps = update_maps(arm);
  const Eigen::Index count = grid.size() + 1;
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd reward(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd pi = i + 1 < count ? grid.belief(static_cast<int>(i)) : belief;
    reward[i] = arm.reward.dot(pi);
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(count);
    for (const Eigen::MatrixXd& map : maps) {
      const Eigen::VectorXd unnormalised = map * pi;
      const double s = unnormalised.sum();
      if (s > 0.0) grid.spread(unnormalised / s, discount * s, row);
    }
    p.row(i) = row;
  }
  return index_of_last(std::move(p), std::move(reward));
}

}  // namespace dwell::hmm_bandit
