#include "bandit/lti/loewner_cover.hpp"

#include <algorithm>
#include <numeric>

#include <ClpSimplex.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dwell::lti {
namespace {

/// min t: columns lambda_1 .. lambda_K and t; a row for the simplex and one for each cut.
class CutProgram {
 public:
  explicit CutProgram(Eigen::Index members) : columns_(static_cast<std::size_t>(members) + 1) {
    std::iota(columns_.begin(), columns_.end(), 0);
    const int t = columns_.back();
    model_.setLogLevel(0);
    model_.setPrimalTolerance(1e-10);  // under the cover's own tolerance
    model_.setDualTolerance(1e-10);
    model_.resize(0, t + 1);
    model_.setColumnBounds(t, -COIN_DBL_MAX, COIN_DBL_MAX);
    model_.setObjectiveCoefficient(t, 1.0);
    const std::vector<double> ones(static_cast<std::size_t>(members), 1.0);
    model_.addRow(t, columns_.data(), ones.data(), 1.0, 1.0);
  }

  /// sum_k lambda_k values[k] - t <= limit.
  void add(const Eigen::VectorXd& values, double limit) {
    Eigen::VectorXd row(values.size() + 1);
    row << values, -1.0;
    model_.addRow(static_cast<int>(row.size()), columns_.data(), row.data(), -COIN_DBL_MAX, limit);
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
  for (const int n : sizes_) {
    offsets_.push_back(size_);
    size_ += n * n;
  }
}

void LoewnerCover::add(std::span<const double> member) {
  members_.insert(members_.end(), member.begin(), member.end());
}

Eigen::Map<const Eigen::MatrixXd> LoewnerCover::block(std::span<const double> covariance, std::size_t b) const {
  return {covariance.data() + offsets_[b], sizes_[b], sizes_[b]};
}

double LoewnerCover::scale(std::span<const double> candidate, std::size_t b) const {
  const double trace = block(candidate, b).trace();
  return trace > 0.0 ? 1.0 / trace : 1.0;
}

LoewnerCover::Cut LoewnerCover::cut(std::span<const double> candidate, std::size_t b, const Eigen::VectorXd& v) const {
  const Eigen::MatrixXd weights = scale(candidate, b) * v * v.transpose();
  return {offsets_[b], weights.reshaped()};
}

/// The first cuts: the diagonal entries.
std::vector<LoewnerCover::Cut> LoewnerCover::axes(std::span<const double> candidate) const {
  std::vector<Cut> cuts;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    for (int i = 0; i < sizes_[b]; ++i) cuts.push_back(cut(candidate, b, Eigen::VectorXd::Unit(sizes_[b], i)));
  }
  return cuts;
}

/// Of every block where the mixture is not below the candidate, the direction where it is most above.
std::vector<LoewnerCover::Cut> LoewnerCover::violated(std::span<const double> candidate, const Eigen::VectorXd& lambda,
                                                      double tolerance) const {
  const Eigen::Map<const Eigen::MatrixXd> members(members_.data(), size_, lambda.size());
  const Eigen::VectorXd mixture = members * lambda;
  std::vector<Cut> cuts;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    const Eigen::MatrixXd excess = block({mixture.data(), candidate.size()}, b) - block(candidate, b);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(excess);
    const Eigen::Index top = excess.rows() - 1;
    if (!(scale(candidate, b) * solver.eigenvalues()[top] <= tolerance)) {
      cuts.push_back(cut(candidate, b, solver.eigenvectors().col(top)));
    }
  }
  return cuts;
}

/// Whether one member alone is below the candidate, in every block.
bool LoewnerCover::below(Eigen::Index member, std::span<const double> candidate, double tolerance) const {
  const std::span<const double> x(members_.data() + member * size_, candidate.size());
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    const double slack = tolerance * block(candidate, b).trace();
    if (((block(x, b) - block(candidate, b)).diagonal().array() > slack).any()) return false;
  }
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    const double slack = tolerance * block(candidate, b).trace();
    if (slack == 0.0) continue;  // both are zero
    Matrix gap = block(candidate, b) - block(x, b);
    gap.diagonal().array() += slack;
    if (Eigen::LLT<Eigen::Ref<Matrix>>(gap).info() != Eigen::Success) return false;
  }
  return true;
}

bool LoewnerCover::covers(std::span<const double> candidate, double tolerance) const {
  const Eigen::Index count = static_cast<Eigen::Index>(members_.size()) / size_;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (below(k, candidate, tolerance)) return true;
  }
  return count > 1 && mixture_covers(candidate, tolerance);
}

bool LoewnerCover::mixture_covers(std::span<const double> candidate, double tolerance) const {
  const Eigen::Index count = std::min(kMixed, static_cast<Eigen::Index>(members_.size()) / size_);
  const Eigen::Map<const Eigen::MatrixXd> members(members_.data(), size_, count);
  const Eigen::Map<const Eigen::VectorXd> u(candidate.data(), size_);
  CutProgram program(count);
  std::vector<Cut> cuts = axes(candidate);
  for (int round = 0; round < kRounds && !cuts.empty(); ++round) {
    for (const Cut& cut : cuts) {
      const auto rows = members.middleRows(cut.offset, cut.weights.size());
      program.add(rows.transpose() * cut.weights, cut.weights.dot(u.segment(cut.offset, cut.weights.size())));
    }
    if (!program.solve() || program.t() > tolerance) return false;
    cuts = violated(candidate, program.lambda(), tolerance);
  }
  return cuts.empty();
}

}  // namespace dwell::lti
