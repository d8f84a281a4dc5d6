#include "bandit/hmm_bandit/gittins.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

namespace dwell::hmm_bandit {
namespace {

constexpr double kSameBelief = 1e-7;
/// Change of a sweep at which it is over, relative to the largest value; and at which the rest is wavering between
/// vectors that are alike, if the index has not grown for some sweeps either.
constexpr double kSettled = 1e-14;
constexpr double kWavers = 1e-12;
constexpr int kPatience = 100;
/// What b^sweeps may leave of a value that has not been seen yet.
constexpr double kUnseen = 1e-12;
/// Of sweeps times points squared: some minutes.
constexpr double kMostWork = 2e10;
constexpr int kMostSweeps = 1'000'000;
/// Beliefs less likely than this, discounted, do not matter to the index.
constexpr double kUnlikely = 1e-15;

/// What plays may reach from `start`, the likeliest first; as columns.
Eigen::MatrixXd reachable(const std::vector<Eigen::MatrixXd>& maps, const Eigen::VectorXd& start, double discount,
                          int most) {
  struct Reached {
    double likelihood;
    Eigen::VectorXd belief;
    bool operator<(const Reached& other) const { return likelihood < other.likelihood; }
  };
  std::priority_queue<Reached> open;
  std::map<std::vector<long long>, int> seen;
  const auto key = [](const Eigen::VectorXd& belief) {
    std::vector<long long> rounded;
    for (const double p : belief) rounded.push_back(std::llround(p / kSameBelief));
    return rounded;
  };
  Eigen::MatrixXd points(start.size(), most);
  int count = 0;
  open.push({1.0, start});
  while (!open.empty() && count < most) {
    const Reached next = open.top();
    open.pop();
    if (!seen.emplace(key(next.belief), count).second) continue;
    points.col(count++) = next.belief;
    for (const Eigen::MatrixXd& map : maps) {
      const Eigen::VectorXd unnormalised = map * next.belief;
      const double s = unnormalised.sum();
      const double likelihood = discount * s * next.likelihood;
      if (likelihood > kUnlikely) open.push({likelihood, unnormalised / s});
    }
  }
  return points.leftCols(count);
}

/// The vectors of a set, as columns; the first is retirement (g = 0, k = 1).
struct Vectors {
  Eigen::MatrixXd g;
  Eigen::MatrixXd k;
};

}  // namespace

GittinsResult gittins_index(const Arm& arm, const Eigen::VectorXd& belief, double discount, int most_points) {
  const std::vector<Eigen::MatrixXd> maps = update_maps(arm);
  const Eigen::MatrixXd points = reachable(maps, belief, discount, most_points);
  const Eigen::Index n = belief.size();
  const Eigen::Index count = points.cols();
  std::vector<Eigen::MatrixXd> successors;
  for (const Eigen::MatrixXd& map : maps) successors.push_back(map * points);

  Vectors set{Eigen::MatrixXd::Zero(n, 1), Eigen::MatrixXd::Ones(n, 1)};
  Eigen::MatrixXd g(n, count), k(n, count);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(count);
  double retirement = arm.reward.dot(belief) / (1.0 - discount);
  GittinsResult result;
  double best = retirement;
  int grown = 0;  // the last sweep in which the index grew
  const double patience = kPatience + std::log(kUnseen) / std::log(discount);
  const double most_sweeps = std::min<double>(kMostSweeps, kMostWork / std::pow(static_cast<double>(count), 2));
  for (result.sweeps = 1; result.sweeps <= most_sweeps && !result.converged; ++result.sweeps) {
    g.colwise() = arm.reward;
    k.setZero();
    const Eigen::MatrixXd vectors = set.g + retirement * set.k;
    for (std::size_t y = 0; y < maps.size(); ++y) {
      const Eigen::MatrixXd values = vectors.transpose() * successors[y];
      for (Eigen::Index point = 0; point < count; ++point) {
        Eigen::Index largest = 0;
        values.col(point).maxCoeff(&largest);
        g.col(point) += discount * (maps[y].transpose() * set.g.col(largest));
        k.col(point) += discount * (maps[y].transpose() * set.k.col(largest));
      }
    }
    // The first point is the belief itself.
    retirement = g.col(0).dot(belief) / (1.0 - k.col(0).dot(belief));
    const Eigen::VectorXd value =
        (g.cwiseProduct(points).colwise().sum() + retirement * k.cwiseProduct(points).colwise().sum()).transpose();
    std::vector<Eigen::Index> kept;
    std::map<std::vector<long long>, int> seen;
    const double scale = std::max(1e-300, value.cwiseAbs().maxCoeff());
    for (Eigen::Index point = 0; point < count; ++point) {
      if (value[point] < retirement) continue;
      std::vector<long long> key;
      for (Eigen::Index i = 0; i < n; ++i) {
        key.push_back(std::llround(g(i, point) / (1e-13 * scale)));
        key.push_back(std::llround(k(i, point) / 1e-13));
      }
      if (seen.emplace(std::move(key), 0).second) kept.push_back(point);
    }
    const auto size = static_cast<Eigen::Index>(kept.size());
    set.g.setZero(n, size + 1);
    set.k.setOnes(n, size + 1);
    set.g.rightCols(size) = g(Eigen::all, kept);
    set.k.rightCols(size) = k(Eigen::all, kept);
    const Eigen::VectorXd clipped = value.cwiseMax(retirement);
    const double change = (clipped - last).cwiseAbs().maxCoeff() / std::max(1e-300, clipped.cwiseAbs().maxCoeff());
    last = clipped;
    if (retirement > best + kSettled * std::abs(best)) grown = result.sweeps;
    best = std::max(best, retirement);
    const int still = result.sweeps - grown;
    result.converged = change <= kSettled || (change <= kWavers && still > kPatience) || still > patience;
  }
  result.index = (1.0 - discount) * best;
  result.points = static_cast<int>(count);
  result.vectors = static_cast<int>(set.g.cols()) - 1;
  return result;
}

}  // namespace dwell::hmm_bandit
