#include "bandit/value_bucket.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include <Eigen/Eigenvalues>

namespace dwell {
namespace {

/// The other radar matters where a look of each leaves at most so much of what two of the leading one leave.
constexpr double kMatters = 0.8;
/// Information that is less than this of the larger is taken for as much: a radar that measures one axis alone.
constexpr double kLeastInformation = 1e-10;

double steps(double ratio, double width) { return std::log(std::max(ratio, 1e-300)) / std::log(width); }

std::int8_t rounded(double steps, int least, int most) {
  return static_cast<std::int8_t>(std::lround(std::clamp(steps, double(least), double(most))));
}

/// The lowest corner's coordinate in the cell that holds a place; the place is moved between `least` and `most`.
std::int8_t cell_of(double& steps, int least, int most) {
  steps = std::clamp(steps, double(least), double(most));
  return static_cast<std::int8_t>(std::min(std::floor(steps), most - 1.0));
}

/// Position noise of one look by its axes.
struct Ellipse {
  double large = 0.0;  // variances
  double small = 0.0;
  Vector2 axis;  // of the large one

  Matrix2 information() const {
    const Matrix2 along = axis * axis.transpose();
    return along / large + (Matrix2::Identity() - along) / small;
  }
};

/// Of a look with this information; no variance below `least`.
Ellipse ellipse_of(const Matrix2& information, double least) {
  Eigen::SelfAdjointEigenSolver<Matrix2> axes;
  axes.computeDirect(information);
  const double most = axes.eigenvalues()[1];
  const double large = 1.0 / std::max(axes.eigenvalues()[0], kLeastInformation * most);
  return {std::max(large, least), std::max(1.0 / most, least), axes.eigenvectors().col(0)};
}

restless::Sensor sensor_of(double large, double small, double angle_rad) {
  restless::Sensor sensor;
  sensor.h = restless::Matrix::Zero(2, kStateSize);
  sensor.h(0, kX) = sensor.h(1, kY) = 1.0;
  const Vector2 axis(std::cos(angle_rad), std::sin(angle_rad));
  const Matrix2 along = axis * axis.transpose();
  sensor.r = large * along + small * (Matrix2::Identity() - along);
  return sensor;
}

double trace_of_both(const Matrix2& one, const Matrix2& other) {
  const Matrix2 sum = one + other;
  return sum.trace() / std::max(sum.determinant(), std::numeric_limits<double>::min());
}

}  // namespace

std::uint64_t BucketKey::packed() const {
  std::uint64_t all = 1;
  for (const std::int8_t part : {q, price, flat, size, other_flat, angle}) {
    all = (all << 8U) | static_cast<std::uint8_t>(part);
  }
  return all;
}

BucketKey BucketKey::unpacked(std::uint64_t packed) {
  BucketKey key;
  for (std::int8_t* part : {&key.angle, &key.other_flat, &key.size, &key.flat, &key.price, &key.q}) {
    *part = static_cast<std::int8_t>(packed & 0xFFU);
    packed >>= 8U;
  }
  return key;
}

BucketKey corner_of(const BucketKey& lowest, int corner) {
  BucketKey key = lowest;
  key.q = static_cast<std::int8_t>(key.q + (corner & 1));
  key.price = static_cast<std::int8_t>(key.price + (corner >> 1));
  return key;
}

std::array<double, kCorners> corner_weights(const BucketPlace& place) {
  const double q = place.q - place.cell.q;
  const double price = place.price - place.cell.price;
  return {(1.0 - q) * (1.0 - price), q * (1.0 - price), (1.0 - q) * price, q * price};
}

std::optional<BucketPlace> place_of(const Situation& situation, std::size_t track, TrackPath& path,
                                    std::span<const double> prices) {
  double velocity_noise = 0.0;
  for (int scan = 1; scan < path.scans(); ++scan) {
    velocity_noise += (path.noise(scan)(kVx, kVx) + path.noise(scan)(kVy, kVy)) / (path.scans() - 1);
  }
  const double period = situation.scan_period_s;
  const double noise = 0.5 * period * period * velocity_noise;
  const double least_variance = noise * std::pow(BucketKey::kStep, -BucketKey::kMostQ);
  const auto look_of = [&](std::size_t s) { return ellipse_of(path.position_information(0, s), least_variance); };

  std::optional<std::size_t> leading;
  std::optional<std::size_t> other;
  double least = std::numeric_limits<double>::infinity();
  Matrix2 first = Matrix2::Zero();
  const auto leaves = [&](std::size_t s) {
    return trace_of_both(first, look_of(s).information()) / path.p_detect(0, s);
  };
  const auto matters = [&](std::size_t s) {
    return path.possible(0, s) && path.p_detect(0, s) > 0.0 && path.position_information(0, s).trace() > 0.0;
  };
  for (std::size_t s = 0; s < situation.sensors.size(); ++s) {
    if (!matters(s)) continue;
    const double alone = leaves(s);
    if (!(alone < least)) continue;
    least = alone;
    leading = s;
  }
  if (!leading) return std::nullopt;
  const Ellipse lead = look_of(*leading);
  first = lead.information();
  least = kMatters * leaves(*leading);
  for (std::size_t s = 0; s < situation.sensors.size(); ++s) {
    if (s == *leading || !matters(s)) continue;
    const double both = leaves(s);
    if (!(both < least)) continue;
    least = both;
    other = s;
  }

  BucketPlace place;
  place.unit_cost = situation.tracks[track].weight * lead.large;
  place.leading = *leading;
  place.p_detect = path.p_detect(0, *leading);
  place.q = steps(noise / lead.large, BucketKey::kStep);
  place.price = steps(prices[*leading] / (place.p_detect * place.unit_cost), BucketKey::kStep);
  place.cell.q = cell_of(place.q, BucketKey::kLeastQ, BucketKey::kMostQ);
  place.cell.price = cell_of(place.price, -BucketKey::kFarthest, BucketKey::kFarthest);
  const auto flatness = [](const Ellipse& e) {
    return rounded(steps(e.small / e.large, BucketKey::kStepVariance), BucketKey::kFlattest, 0);
  };
  place.cell.flat = flatness(lead);
  Vector2 x = lead.axis;
  Vector2 y(-x[1], x[0]);
  if (other) {
    const Ellipse second = look_of(*other);
    if (x.dot(second.axis) < 0.0) x = -x;
    if (y.dot(second.axis) < 0.0) y = -y;
    const double angle = std::atan2(y.dot(second.axis), x.dot(second.axis));
    place.cell.size = rounded(steps(second.large / lead.large, BucketKey::kStepVariance), -20, 20);
    place.cell.other_flat = flatness(second);
    place.cell.angle = static_cast<std::int8_t>(
        std::min(BucketKey::kAngles - 1.0, angle * BucketKey::kAngles * 2.0 / std::numbers::pi));
  }
  const double length = std::sqrt(lead.large);
  for (const auto& [row, along, across] : {std::tuple{0, kX, kY}, std::tuple{1, kVx, kVy}}) {
    const double scale = (row == 0 ? 1.0 : period) / length;
    place.to_units(along, along) = scale * x[0];
    place.to_units(along, across) = scale * x[1];
    place.to_units(across, along) = scale * y[0];
    place.to_units(across, across) = scale * y[1];
  }
  return place;
}

restless::Arm arm_of(const BucketKey& key) {
  using restless::Matrix;
  restless::Arm arm;
  arm.f = Matrix::Identity(kStateSize, kStateSize);
  arm.q = Matrix::Zero(kStateSize, kStateSize);
  arm.cost = Matrix::Zero(kStateSize, kStateSize);
  const double q = std::pow(BucketKey::kStep, key.q);
  for (const auto& [at, rate] : {std::pair{kX, kVx}, std::pair{kY, kVy}}) {
    arm.f(at, rate) = 1.0;
    arm.q(at, at) = q / 3.0;
    arm.q(at, rate) = arm.q(rate, at) = q / 2.0;
    arm.q(rate, rate) = q;
    arm.cost(at, at) = 1.0;
  }
  const auto variance = [](int steps) { return std::pow(BucketKey::kStepVariance, steps); };
  arm.sensors.push_back(sensor_of(1.0, variance(key.flat), 0.0));
  if (key.size != BucketKey::kAlone) {
    const double angle = (key.angle + 0.5) * std::numbers::pi / (2.0 * BucketKey::kAngles);
    arm.sensors.push_back(sensor_of(variance(key.size), variance(key.size + key.other_flat), angle));
  }
  arm.p0 = arm.q;
  arm.p0 = 4.0 * restless::all_looks(arm).covariance;
  return arm;
}

double price_of(const BucketKey& key) { return std::pow(BucketKey::kStep, key.price); }

}  // namespace dwell
