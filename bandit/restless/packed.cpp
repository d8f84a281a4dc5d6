#include "bandit/restless/packed.hpp"

namespace dwell::restless {

Packed pack_state(const Matrix& p) {
  Packed packed(packed_size(p.rows()));
  Eigen::Index at = 0;
  for (Eigen::Index j = 0; j < p.cols(); ++j) {
    for (Eigen::Index i = j; i < p.rows(); ++i) packed[at++] = p(i, j);
  }
  return packed;
}

Packed pack_weight(const Matrix& l) {
  Packed packed(packed_size(l.rows()));
  Eigen::Index at = 0;
  for (Eigen::Index j = 0; j < l.cols(); ++j) {
    for (Eigen::Index i = j; i < l.rows(); ++i) packed[at++] = i == j ? l(i, i) : l(i, j) + l(j, i);
  }
  return packed;
}

Matrix unpack_state(const Packed& p, Eigen::Index n) {
  Matrix m(n, n);
  Eigen::Index at = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) m(i, j) = m(j, i) = p[at++];
  }
  return m;
}

PackedMap congruence(const Matrix& g) {
  const Eigen::Index n = g.rows();
  PackedMap map(packed_size(n), packed_size(n));
  Eigen::Index column = 0;
  for (Eigen::Index l = 0; l < n; ++l) {
    for (Eigen::Index k = l; k < n; ++k) {
      // The image of the unit symmetric matrix with ones at (k, l) and (l, k).
      Matrix image = g.col(k) * g.col(l).transpose();
      if (k != l) image += g.col(l) * g.col(k).transpose();
      map.col(column++) = pack_state(image);
    }
  }
  return map;
}

}  // namespace dwell::restless
