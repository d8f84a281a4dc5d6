#include "bandit/lti/loewner_cover.hpp"

#include <numeric>

#include <ClpSimplex.hpp>
#include <Eigen/Eigenvalues>

namespace dwell::lti {
namespace {

/// min t: columns lambda_1 .. lambda_K and t; a row for the simplex and one for each cut.
class CutProgram {
 public:
  explicit CutProgram(std::size_t members) : columns_(members + 1) {
    std::iota(columns_.begin(), columns_.end(), 0);
    const int t = columns_.back();
    model_.setLogLevel(0);
    model_.setPrimalTolerance(1e-10);  // under the cover's own tolerance
    model_.setDualTolerance(1e-10);
    model_.resize(0, t + 1);
    model_.setColumnBounds(t, -COIN_DBL_MAX, COIN_DBL_MAX);
    model_.setObjectiveCoefficient(t, 1.0);
    const std::vector<double> ones(members, 1.0);
    model_.addRow(t, columns_.data(), ones.data(), 1.0, 1.0);
  }

  /// sum_k lambda_k values[k] - t <= limit.
  void add(std::vector<double> values, double limit) {
    values.push_back(-1.0);
    model_.addRow(static_cast<int>(values.size()), columns_.data(), values.data(), -COIN_DBL_MAX, limit);
  }

  bool solve() {
    model_.dual();
    return model_.status() == 0;
  }
  double t() const { return model_.objectiveValue(); }
  /// On the simplex, whatever the tolerances of the program left.
  Eigen::VectorXd lambda() const {
    const auto members = static_cast<Eigen::Index>(columns_.size()) - 1;
    const Eigen::VectorXd positive =
        Eigen::Map<const Eigen::VectorXd>(model_.primalColumnSolution(), members).cwiseMax(0.0);
    return positive / positive.sum();
  }

 private:
  ClpSimplex model_;
  std::vector<int> columns_;
};

}  // namespace

LoewnerCover::LoewnerCover(std::vector<int> block_sizes) : sizes_(std::move(block_sizes)) {
  std::size_t offset = 0;
  for (const int n : sizes_) {
    offsets_.push_back(offset);
    offset += static_cast<std::size_t>(n * n);
  }
}

void LoewnerCover::add(std::span<const double> member) { members_.emplace_back(member.begin(), member.end()); }

Eigen::Map<const Eigen::MatrixXd> LoewnerCover::block(std::span<const double> covariance, std::size_t b) const {
  return {covariance.data() + offsets_[b], sizes_[b], sizes_[b]};
}

double LoewnerCover::scale(std::span<const double> candidate, std::size_t b) const {
  const double trace = block(candidate, b).trace();
  return trace > 0.0 ? 1.0 / trace : 1.0;
}

double LoewnerCover::Cut::of(const LoewnerCover& cover, std::span<const double> covariance) const {
  return scale * v.dot(cover.block(covariance, block) * v);
}

/// The first cuts: the diagonal entries.
std::vector<LoewnerCover::Cut> LoewnerCover::axes(std::span<const double> candidate) const {
  std::vector<Cut> cuts;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    for (int i = 0; i < sizes_[b]; ++i) {
      cuts.push_back({b, Eigen::VectorXd::Unit(sizes_[b], i), scale(candidate, b)});
    }
  }
  return cuts;
}

/// Of every block where the mixture is not below the candidate, the direction where it is most above.
std::vector<LoewnerCover::Cut> LoewnerCover::violated(std::span<const double> candidate, const Eigen::VectorXd& lambda,
                                                      double tolerance) const {
  std::vector<Cut> cuts;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    Eigen::MatrixXd excess = -block(candidate, b);
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const double share = lambda[static_cast<Eigen::Index>(k)];
      if (share > 0.0) excess += share * block(members_[k], b);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(excess);
    const Eigen::Index top = excess.rows() - 1;
    if (!(scale(candidate, b) * solver.eigenvalues()[top] <= tolerance)) {
      cuts.push_back({b, solver.eigenvectors().col(top), scale(candidate, b)});
    }
  }
  return cuts;
}

bool LoewnerCover::covers(std::span<const double> candidate, double tolerance) const {
  if (members_.empty()) return false;
  const auto count = static_cast<Eigen::Index>(members_.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    if (violated(candidate, Eigen::VectorXd::Unit(count, k), tolerance).empty()) return true;
  }
  CutProgram program(members_.size());
  std::vector<Cut> cuts = axes(candidate);
  for (int round = 0; round < kRounds && !cuts.empty(); ++round) {
    for (const Cut& cut : cuts) {
      std::vector<double> values;
      for (const std::vector<double>& member : members_) values.push_back(cut.of(*this, member));
      program.add(std::move(values), cut.of(*this, candidate));
    }
    if (!program.solve() || program.t() > tolerance) return false;
    cuts = violated(candidate, program.lambda(), tolerance);
  }
  return cuts.empty();
}

}  // namespace dwell::lti
