#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace dwell {

/// The assignment of rows to columns of the least total cost, each row to one column and no column twice: the column of
/// each row.
///
/// Requires rows <= columns and finite costs. Exact, by shortest augmenting paths with potentials.
/// Cost     O(rows^2 columns).
/// Source   Jonker, Volgenant (1987), Computing 38.
inline std::vector<Eigen::Index> assign(const Eigen::MatrixXd& cost) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::Index rows = cost.rows();
  const Eigen::Index columns = cost.cols();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(rows + 1);  // potentials; index 0 stands for none
  Eigen::VectorXd v = Eigen::VectorXd::Zero(columns + 1);
  std::vector<Eigen::Index> row_of(static_cast<std::size_t>(columns + 1), 0);
  std::vector<Eigen::Index> way(static_cast<std::size_t>(columns + 1), 0);
  for (Eigen::Index row = 1; row <= rows; ++row) {
    row_of[0] = row;
    Eigen::Index column = 0;
    Eigen::VectorXd least = Eigen::VectorXd::Constant(columns + 1, kInfinity);
    std::vector<bool> used(static_cast<std::size_t>(columns + 1), false);
    do {
      used[static_cast<std::size_t>(column)] = true;
      const Eigen::Index here = row_of[static_cast<std::size_t>(column)];
      double delta = kInfinity;
      Eigen::Index next = 0;
      for (Eigen::Index j = 1; j <= columns; ++j) {
        if (used[static_cast<std::size_t>(j)]) continue;
        const double reduced = cost(here - 1, j - 1) - u[here] - v[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[static_cast<std::size_t>(j)] = column;
        }
        if (least[j] < delta) {
          delta = least[j];
          next = j;
        }
      }
      for (Eigen::Index j = 0; j <= columns; ++j) {
        if (used[static_cast<std::size_t>(j)]) {
          u[row_of[static_cast<std::size_t>(j)]] += delta;
          v[j] -= delta;
        } else {
          least[j] -= delta;
        }
      }
      column = next;
    } while (row_of[static_cast<std::size_t>(column)] != 0);
    for (; column != 0; column = way[static_cast<std::size_t>(column)]) {
      row_of[static_cast<std::size_t>(column)] =
          row_of[static_cast<std::size_t>(way[static_cast<std::size_t>(column)])];
    }
  }
  std::vector<Eigen::Index> column_of(static_cast<std::size_t>(rows), 0);
  for (Eigen::Index j = 1; j <= columns; ++j) {
    const Eigen::Index row = row_of[static_cast<std::size_t>(j)];
    if (row != 0) column_of[static_cast<std::size_t>(row - 1)] = j - 1;
  }
  return column_of;
}

}  // namespace dwell
