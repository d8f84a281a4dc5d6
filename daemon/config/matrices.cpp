#include <cmath>

#include "daemon/config/problems.hpp"
#include "daemon/config/sections.hpp"

namespace dwell {

Eigen::MatrixXd read_matrix(FieldReader& in, const char* field, const Range& range, Eigen::Index rows,
                            Eigen::Index columns) {
  const int count = in.count(field);
  const std::string size = std::to_string(rows) + " x " + std::to_string(columns);
  if (count == 0) {
    in.refuse(field, "", "is required: " + size + " values, row-major");
  } else if (count != rows * columns) {
    in.refuse(field, std::to_string(count) + " values", "must have " + size + " values, row-major");
  }
  const std::vector<double> values = in.numbers(field, range, {});
  if (static_cast<Eigen::Index>(values.size()) != rows * columns) return Eigen::MatrixXd::Zero(rows, columns);
  return row_major<Eigen::MatrixXd>(values, static_cast<int>(rows), static_cast<int>(columns));
}

void check_probabilities(FieldReader& in, const char* field, const Eigen::MatrixXd& rows) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double sum = rows.row(i).sum();
    if (std::abs(sum - 1.0) > kProbabilitySum) {
      in.refuse(field, "row " + std::to_string(i + 1) + " sums to " + number_text(sum), "rows must sum to 1");
    }
  }
}

std::optional<Eigen::MatrixXd> read_stochastic(FieldReader& in, const char* field, int n) {
  const auto values = in.numbers(field, within(0.0, 1.0), {n * n});
  if (values.empty()) return std::nullopt;
  const auto rows = row_major<Eigen::MatrixXd>(values, n, n);
  check_probabilities(in, field, rows);
  return rows.rowwise().sum().cwiseInverse().asDiagonal() * rows;
}

int side_of(const FieldReader& in, const char* field) {
  const auto side = static_cast<int>(std::lround(std::sqrt(in.count(field))));
  return side * side == in.count(field) ? side : 0;
}

}  // namespace dwell
