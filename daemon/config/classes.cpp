#include <algorithm>
#include <cmath>

#include "daemon/config/sections.hpp"

namespace dwell {
namespace {

void read_class(FieldReader in, int k, TargetClasses& classes) {
  std::string& name = classes.names[static_cast<std::size_t>(k)];
  in.required("name");
  in.text("name", name);
  const auto end = classes.names.begin() + k;
  if (!name.empty() && std::find(classes.names.begin(), end, name) != end) {
    in.refuse("name", in.value("name"), "must be unique among the classes");
  }
  in.number("prior", within(0.0, 1.0), 1.0, classes.prior[k]);
  in.number("weight", within(1e-9, 1e9), 1.0, classes.weight[k]);
}

}  // namespace

TargetClasses read_classes(FieldReader in) {
  TargetClasses classes;
  const int n = in.count("class");
  if (n < 2 || n > TargetClasses::kMost) {
    in.refuse("class", std::to_string(n) + " classes", "must be from 2 to " + std::to_string(TargetClasses::kMost));
    return classes;
  }
  classes.names.resize(static_cast<std::size_t>(n));
  classes.prior.setConstant(n, 1.0 / n);
  classes.weight.setOnes(n);
  classes.transition.setIdentity(n, n);
  for (int k = 0; k < n; ++k) read_class(in.element("class", k), k, classes);
  const double sum = classes.prior.sum();
  if (std::abs(sum - 1.0) > kProbabilitySum) {
    in.refuse("class", "priors sum to " + number_text(sum), "priors must sum to 1");
  }
  classes.prior /= sum;
  if (const auto transition = read_stochastic(in, "transition", n)) classes.transition = *transition;
  return classes;
}

std::optional<Declaration> read_emission(FieldReader& in, const TargetClasses& classes) {
  if (in.count("emission") == 0) return std::nullopt;
  if (classes.size() == 0) {
    in.refuse("emission", std::to_string(in.count("emission")) + " values", "needs classes");
    return std::nullopt;
  }
  const auto emission = read_stochastic(in, "emission", classes.size());
  return emission ? std::optional(Declaration{*emission}) : std::nullopt;
}

std::optional<int> read_target_class(FieldReader& in, const TargetClasses& classes) {
  if (!in.has("class")) return std::nullopt;
  std::string name;
  in.text("class", name);
  const auto found = std::find(classes.names.begin(), classes.names.end(), name);
  if (found != classes.names.end()) return static_cast<int>(found - classes.names.begin());
  std::string names;
  for (const std::string& known : classes.names) names += (names.empty() ? "" : ", ") + known;
  in.refuse("class", in.value("class"), names.empty() ? "needs classes" : "must be one of: " + names);
  return std::nullopt;
}

}  // namespace dwell
