#include "bandit/restless/concave_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <ClpSimplex.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "radar/assert.hpp"

namespace dwell::restless {
namespace {

using Matrix2 = Eigen::Matrix2d;
using Mixture = Certificate::Mixture;

/// Scans between looks of the orbits that the points start with.
constexpr int kPeriods[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
/// Of what looks with every sensor in every scan settle at: below what covariances come to. All are above the first.
constexpr double kLeast[] = {0.0, 0.5, 0.999};
/// A successor that the best policy meets more rarely needs no better mixture.
constexpr double kRare = 1e-9;
constexpr int kFollowedARound = 12;
constexpr int kLongestWalk = 80;
/// Points so close are one; a walk ends so close to another, at first; that is halved when a round gains less.
/// Relative.
constexpr double kSame = 1e-9;
constexpr double kNear = 0.02;
constexpr double kSlow = 1e-3;

double smallest_eigenvalue(const Matrix2& m) {
  return Eigen::SelfAdjointEigenSolver<Matrix2>(m, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

/// max sum w v:  sum w P + sum c u u' = P',  sum w = 1,  w, c >= 0. Only P' changes from one program to the next, so
/// the last basis is a start.
class MixtureProgram {
 public:
  MixtureProgram(const std::vector<Matrix2>& points, const std::vector<double>& values, int directions)
      : points_(points) {
    model_.setLogLevel(0);
    model_.setPrimalTolerance(1e-9);
    model_.setDualTolerance(1e-9);
    model_.setOptimizationDirection(-1.0);
    model_.resize(kRows, 0);
    for (std::size_t k = 0; k < points.size(); ++k) add(points[k], 1.0, values[k]);
    for (int d = 0; d < directions; ++d) {
      const double angle = std::numbers::pi * d / directions;
      const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
      add(u * u.transpose(), 0.0, 0.0);
    }
  }

  Mixture below(const Matrix2& successor) {
    const double sides[kRows] = {successor(0, 0), successor(1, 0), successor(1, 1), 1.0};
    for (int row = 0; row < kRows; ++row) model_.setRowBounds(row, sides[row], sides[row]);
    model_.dual();
    Mixture mixture;
    double sum = 0.0;
    if (model_.status() == 0) {
      for (std::size_t k = 0; k < points_.size(); ++k) {
        const double weight = model_.primalColumnSolution()[k];
        if (weight > 1e-12) mixture.push_back({static_cast<int>(k), weight}), sum += weight;
      }
    }
    if (sum <= 0.0) return {{kLeastPoint, 1.0}};
    for (Certificate::Share& share : mixture) share.weight /= sum;
    return made_good(std::move(mixture), successor);
  }

  /// Of the points: zero, below everything.
  static constexpr int kLeastPoint = 1;

 private:
  static constexpr int kRows = 4;

  void add(const Matrix2& m, double one, double value) {
    const int rows[kRows] = {0, 1, 2, 3};
    const double column[kRows] = {m(0, 0), m(1, 0), m(1, 1), one};
    model_.addColumn(kRows, rows, column, 0.0, COIN_DBL_MAX, value);
  }

  Mixture made_good(Mixture mixture, const Matrix2& successor) const {
    Matrix2 left = successor;
    for (const Certificate::Share& share : mixture) {
      left -= share.weight * points_[static_cast<std::size_t>(share.point)];
    }
    const double lowest = smallest_eigenvalue(left);
    if (lowest >= 0.0) return mixture;
    const double room = smallest_eigenvalue(successor - points_[kLeastPoint]);
    const double part = std::min(1.0, -lowest / (room - lowest) * (1.0 + 1e-6));
    for (Certificate::Share& share : mixture) share.weight *= 1.0 - part;
    mixture.push_back({kLeastPoint, part});
    return mixture;
  }

  const std::vector<Matrix2>& points_;
  ClpSimplex model_;
};

/// The finite problem of the points.
class ConcaveMesh {
 public:
  ConcaveMesh(const Arm& arm, double discount, double price, const ValueSet& guess, const CertificateSettings& settings)
      : arm_(arm), discount_(discount), guess_(guess), settings_(settings) {
    const Matrix least = all_looks(arm).covariance;
    const Matrix2 root = least.llt().matrixL();
    whiten_ = root.inverse();
    certificate_.price = price;
    add(arm.p0);
    for (const double part : kLeast) {
      Matrix p = part * least;
      for (int t = 0; t < kPeriods[std::size(kPeriods) - 1]; ++t) {
        add(p);
        p = predict(arm, p);
      }
    }
    for (std::size_t s = 0; s < arm.sensors.size(); ++s) add_orbits(s, least);
    walk(arm.p0);
  }

  Certificate find() {
    Certificate best;
    best.value = -std::numeric_limits<double>::infinity();
    mix([](std::size_t, std::size_t) { return true; });
    double last = best.value;
    for (int round = 0; round < settings_.rounds; ++round) {
      solve();
      if (certificate_.value > best.value) best = certificate_;
      if (best.value >= settings_.enough || static_cast<int>(points_.size()) >= settings_.points) break;
      if (best.value - last < kSlow * std::abs(best.value)) near_ *= 0.5;
      last = best.value;
      improve();
    }
    return best;
  }

 private:
  struct Point {
    std::vector<Matrix> successors;  // by outcome
    std::vector<double> costs;       // of the scan, by outcome
  };

  Matrix2 whitened(const Matrix& p) const { return whiten_ * Matrix2(p) * whiten_.transpose(); }

  /// Two points nearly on one another would only slow the programs down.
  bool near_a_point(const Matrix2& p, double distance) const {
    return std::any_of(whitened_.begin(), whitened_.end(),
                       [&](const Matrix2& other) { return (other - p).norm() < distance * p.norm(); });
  }

  bool add(const Matrix& p) {
    const Matrix2 white = whitened(p);
    if (static_cast<int>(points_.size()) >= settings_.points || near_a_point(white, kSame)) return false;
    certificate_.points.push_back(p);
    certificate_.values.push_back(guess_.value(p));
    whitened_.push_back(white);
    Point point;
    point.successors.push_back(predict(arm_, p));
    point.costs.push_back(scan_cost(arm_, p));
    for (const Sensor& sensor : arm_.sensors) {
      const Matrix after = look_update(sensor, p).covariance;
      point.successors.push_back(predict(arm_, after));
      point.costs.push_back(scan_cost(arm_, after));
    }
    points_.push_back(std::move(point));
    return true;
  }

  void add_orbits(std::size_t sensor, const Matrix& start) {
    constexpr int kToSettle = 60;
    for (const int period : kPeriods) {
      Matrix p = start;
      for (int turn = 0; turn <= kToSettle; ++turn) {
        p = predict(arm_, look_update(arm_.sensors[sensor], p).covariance);
        for (int t = 1; t < period; ++t) {
          if (turn == kToSettle) add(p);
          p = predict(arm_, p);
        }
        if (turn == kToSettle) add(p);
      }
    }
  }

  /// From a covariance the way that the guess says is best, all looks detected, until a point is met.
  void walk(Matrix p) {
    for (int n = 0; n < kLongestWalk; ++n) {
      const bool arrived = n > 0 && near_a_point(whitened(p), near_);
      if (!add(p) || arrived) return;
      const double idle = idle_cost(arm_, guess_, discount_, p);
      double least = idle;
      Matrix next = predict(arm_, p);
      for (std::size_t s = 0; s < arm_.sensors.size(); ++s) {
        const double look = look_cost(arm_, s, guess_, discount_, certificate_.price, p, idle);
        if (look >= least) continue;
        least = look;
        next = predict(arm_, look_update(arm_.sensors[s], p).covariance);
      }
      p = next;
    }
  }

  /// The mixtures of the new points, and those that `wanted` names, for the present v.
  template <class Wanted>
  void mix(const Wanted& wanted) {
    MixtureProgram program(whitened_, certificate_.values, settings_.directions);
    const std::size_t old = certificate_.below.size();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const auto& successors = points_[k].successors;
      if (k >= old) certificate_.below.emplace_back(successors.size());
      for (std::size_t outcome = 0; outcome < successors.size(); ++outcome) {
        if (k < old && !wanted(k, outcome)) continue;
        certificate_.below[k][outcome] = program.below(whitened(successors[outcome]));
      }
    }
  }

  double mean(const Mixture& mixture) const {
    double sum = 0.0;
    for (const auto& [point, weight] : mixture) sum += weight * certificate_.values[static_cast<std::size_t>(point)];
    return sum;
  }

  /// One step at a point; `best` becomes the sensor, -1 idle.
  double step(std::size_t k, int& best) const {
    const Point& point = points_[k];
    const auto& mixtures = certificate_.below[k];
    const double idle = point.costs[0] + discount_ * mean(mixtures[0]);
    double least = idle;
    best = -1;
    for (std::size_t s = 0; s < arm_.sensors.size(); ++s) {
      const double p_d = arm_.sensors[s].p_detect;
      const double seen = point.costs[s + 1] + discount_ * mean(mixtures[s + 1]);
      const double look = p_d * seen + (1.0 - p_d) * idle + certificate_.price * arm_.dwell;
      if (look < least) {
        least = look;
        best = static_cast<int>(s);
      }
    }
    return least;
  }

  /// v by value iteration, lazy for the average cost; what is proved by it.
  void solve() {
    constexpr int kMost = 4000;
    const bool average = discount_ == 1.0;
    const double mix = average ? 0.5 : 1.0;
    std::vector<double>& v = certificate_.values;
    std::vector<double> change(v.size());
    best_.resize(v.size());
    for (int sweep = 0; sweep < kMost; ++sweep) {
      for (std::size_t k = 0; k < v.size(); ++k) change[k] = step(k, best_[k]) - v[k];
      const auto [low, high] = std::minmax_element(change.begin(), change.end());
      const double scale = average ? std::abs(*low) : (1.0 - discount_) * std::abs(v[0]);
      certificate_.value = average ? *low : v[0] + *low / (1.0 - discount_);
      const double apart = average ? *high - *low : std::max(-*low, *high);
      if (apart <= 1e-9 * scale) break;
      for (std::size_t k = 0; k < v.size(); ++k) v[k] += mix * change[k];
      if (average) {
        const double shift = v[0];
        for (double& value : v) value -= shift;
      }
    }
  }

  /// How often the best policy is at each point: in the long run, starting anywhere; discounted, from p0.
  std::vector<double> occupation() const {
    constexpr int kSteps = 3000;
    const bool average = discount_ == 1.0;
    const double stay = average ? 0.5 : 0.0;  // lazy: the policy is periodic
    const double move = average ? 0.5 : discount_;
    std::vector<double> now(points_.size(), average ? 1.0 / static_cast<double>(points_.size()) : 0.0);
    if (!average) now[0] = 1.0;
    std::vector<double> sum(now.size(), 0.0);
    std::vector<double> next;
    for (int n = 0; n < kSteps; ++n) {
      next.assign(now.size(), 0.0);
      for (std::size_t k = 0; k < now.size(); ++k) {
        sum[k] += now[k];
        if (now[k] < 1e-12) continue;
        next[k] += stay * now[k];
        for (std::size_t outcome = 0; outcome < certificate_.below[k].size(); ++outcome) {
          spread(certificate_.below[k][outcome], move * chance(k, outcome) * now[k], next);
        }
      }
      now.swap(next);
    }
    return average ? now : sum;
  }

  static void spread(const Mixture& mixture, double mass, std::vector<double>& to) {
    for (const auto& [point, weight] : mixture) to[static_cast<std::size_t>(point)] += weight * mass;
  }

  /// How often an outcome happens where the best policy is at a point.
  double chance(std::size_t k, std::size_t outcome) const {
    const double p_d = best_[k] < 0 ? 0.0 : arm_.sensors[static_cast<std::size_t>(best_[k])].p_detect;
    return outcome == 0 ? 1.0 - p_d : best_[k] + 1 == static_cast<int>(outcome) ? p_d : 0.0;
  }

  /// Where the best policy lives: walks from the successors that mixtures serve worst, and better mixtures.
  void improve() {
    struct Served {
      double loss;
      std::size_t point, outcome;
    };
    const std::vector<double> share = occupation();
    std::vector<Served> worst;
    for (std::size_t k = 0; k < share.size(); ++k) {
      for (std::size_t outcome = 0; outcome < points_[k].successors.size(); ++outcome) {
        const double mass = share[k] * chance(k, outcome);
        if (mass <= kRare) continue;
        const double loss = guess_.value(points_[k].successors[outcome]) - guess_of(certificate_.below[k][outcome]);
        worst.push_back({mass * std::abs(loss), k, outcome});
      }
    }
    std::sort(worst.begin(), worst.end(), [](const Served& a, const Served& b) {
      return a.loss != b.loss ? a.loss > b.loss : std::pair(a.point, a.outcome) < std::pair(b.point, b.outcome);
    });
    if (worst.size() > kFollowedARound) worst.resize(kFollowedARound);
    const std::size_t before = points_.size();
    for (const Served& served : worst) walk(points_[served.point].successors[served.outcome]);
    // The guess is of another zero than v.
    const double shift = certificate_.values[0] - guess_.value(certificate_.points[0]);
    for (std::size_t k = before; k < points_.size(); ++k) certificate_.values[k] += shift;
    mix([&](std::size_t k, std::size_t outcome) { return share[k] * chance(k, outcome) > kRare; });
  }

  double guess_of(const Mixture& mixture) const {
    double sum = 0.0;
    for (const auto& [point, weight] : mixture) {
      sum += weight * guess_.value(certificate_.points[static_cast<std::size_t>(point)]);
    }
    return sum;
  }

  const Arm& arm_;
  double discount_;
  const ValueSet& guess_;
  CertificateSettings settings_;
  Matrix2 whiten_;
  double near_ = kNear;
  Certificate certificate_;
  std::vector<Matrix2> whitened_;
  std::vector<Point> points_;
  std::vector<int> best_;
};

}  // namespace

Certificate certify(const Arm& arm, double discount, double price, const ValueSet& guess,
                    const CertificateSettings& settings) {
  DWELL_ASSERT(arm.states() == 2);
  return ConcaveMesh(arm, discount, price, guess, settings).find();
}

}  // namespace dwell::restless
