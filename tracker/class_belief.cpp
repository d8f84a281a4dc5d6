#include "tracker/class_belief.hpp"

#include <algorithm>

#include "radar/assert.hpp"

namespace dwell {
namespace {

/// B(., d) of the class that the plot declares; null where it says nothing.
const Declaration* declared_by(const Sensor& sensor, const Plot& plot, const Eigen::VectorXd& belief) {
  if (belief.size() == 0 || !plot.declared || sensor.declaration() == nullptr) return nullptr;
  DWELL_ASSERT(sensor.declaration()->classes() == belief.size());
  DWELL_ASSERT(*plot.declared >= 0 && *plot.declared < belief.size());
  return sensor.declaration();
}

double emission(const Declaration& declaration, Eigen::Index k, int declared) {
  return std::max(declaration.emission(k, declared), kLeastEmission);
}

/// sum_k pi_k B(k, d).
double likelihood(const Declaration& declaration, int declared, const Eigen::VectorXd& belief) {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < belief.size(); ++k) sum += belief[k] * emission(declaration, k, declared);
  return sum;
}

}  // namespace

void move_class(const TargetClasses& classes, Eigen::VectorXd& belief) {
  if (belief.size() == 0 || !classes.move()) return;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, TargetClasses::kMost, 1> before = belief;
  belief.noalias() = classes.transition.transpose() * before;
}

double declaration_ratio(const Sensor& sensor, const Plot& plot, const Eigen::VectorXd& belief) {
  const Declaration* declaration = declared_by(sensor, plot, belief);
  if (declaration == nullptr) return 1.0;
  return static_cast<double>(belief.size()) * likelihood(*declaration, *plot.declared, belief);
}

void add_class_posterior(const Sensor& sensor, const Plot& plot, double weight, const Eigen::VectorXd& belief,
                         Eigen::VectorXd& mixture) {
  const Declaration* declaration = declared_by(sensor, plot, belief);
  if (declaration == nullptr) {
    mixture += weight * belief;
    return;
  }
  const double scale = weight / likelihood(*declaration, *plot.declared, belief);
  for (Eigen::Index k = 0; k < belief.size(); ++k) {
    mixture[k] += scale * belief[k] * emission(*declaration, k, *plot.declared);
  }
}

}  // namespace dwell
