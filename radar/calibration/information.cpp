#include "radar/calibration/information.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include <ceres/jet.h>

#include "radar/calibration/innovations.hpp"

namespace dwell {
namespace {

using calibration::InnovationFilter;
using calibration::ModeInnovation;
using calibration::RadarParameters;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Derivatives by one radar's parameters; the others' follow in passes of their own, for any number of radars.
using Dual = ceres::Jet<double, kCorrectionSize>;

/// Noise a thousand times from its figure is no noise figure: ends a line search that runs away.
constexpr double kLargestLogScale = 7.0;

template <class T>
RadarParameters<T> parameters_of(const Eigen::Matrix<T, kCorrectionSize, 1>& theta) {
  using std::exp;
  return {exp(theta[0]), exp(theta[1]), theta[2], theta[3], theta[4]};
}

int radars_of(const CalibrationWindow& window) { return static_cast<int>(window.radar_position_m.size()); }

/// The parameters with derivatives by those of radar `active`.
std::vector<RadarParameters<Dual>> dual_parameters(const VectorXd& theta, int active) {
  std::vector<RadarParameters<Dual>> parameters;
  for (int radar = 0; radar * kCorrectionSize < theta.size(); ++radar) {
    Eigen::Matrix<Dual, kCorrectionSize, 1> dual;
    for (int k = 0; k < kCorrectionSize; ++k) {
      dual[k] = Dual(theta[radar * kCorrectionSize + k]);
      if (radar == active) dual[k].v[k] = 1.0;
    }
    parameters.push_back(parameters_of<Dual>(dual));
  }
  return parameters;
}

/// Derivatives of one mode's innovation by all parameters.
struct Sensitivity {
  Eigen::Matrix2Xd nu;
  Eigen::Matrix3Xd s;   // s00, s01, s11
  double weight = 0.0;  // given the plot
  Matrix2 covariance;
};

/// Of one plot.
MatrixXd information_of(std::span<const Sensitivity> modes, Eigen::Index size) {
  MatrixXd information = MatrixXd::Zero(size, size);
  for (const Sensitivity& mode : modes) {
    if (mode.weight < 1e-12) continue;
    const Matrix2 root = mode.covariance.llt().matrixL();
    const Matrix2 whiten = root.inverse();
    const Eigen::Matrix2Xd nu = whiten * mode.nu;
    // The columns of W dS W' as vectors, the off-diagonal element twice: their products are tr(S^-1 dS S^-1 dS).
    Eigen::Matrix3Xd s(3, size);
    for (Eigen::Index k = 0; k < size; ++k) {
      Matrix2 ds;
      ds << mode.s(0, k), mode.s(1, k), mode.s(1, k), mode.s(2, k);
      const Matrix2 white = whiten * ds * whiten.transpose();
      s.col(k) << white(0, 0), std::sqrt(2.0) * white(0, 1), white(1, 1);
    }
    information += mode.weight * (nu.transpose() * nu + 0.5 * s.transpose() * s);
  }
  return information;
}

MatrixXd information(const CalibrationWindow& window, const MotionPrior& motion, const VectorXd& theta) {
  const auto modes = static_cast<std::size_t>(motion.initial_probability.size());
  std::vector<Sensitivity> all(window.plots.size() * modes);
  InnovationFilter<Dual> filter(window, motion);
  for (int active = 0; active < radars_of(window); ++active) {
    const int first = active * kCorrectionSize;
    const auto keep = [&](std::size_t plot, std::span<const ModeInnovation<Dual>> innovations, const Dual&,
                          const Dual& log_density) {
      for (std::size_t j = 0; j < modes; ++j) {
        Sensitivity& out = all[plot * modes + j];
        const ModeInnovation<Dual>& in = innovations[j];
        if (active == 0) {
          out.nu.resize(2, theta.size());
          out.s.resize(3, theta.size());
        }
        for (int k = 0; k < 2; ++k) out.nu.row(k).segment<kCorrectionSize>(first) = in.nu[k].v.transpose();
        out.s.row(0).segment<kCorrectionSize>(first) = in.s(0, 0).v.transpose();
        out.s.row(1).segment<kCorrectionSize>(first) = in.s(0, 1).v.transpose();
        out.s.row(2).segment<kCorrectionSize>(first) = in.s(1, 1).v.transpose();
        out.weight = std::exp(in.log_weight.a - log_density.a);
        out.covariance << in.s(0, 0).a, in.s(0, 1).a, in.s(1, 0).a, in.s(1, 1).a;
      }
    };
    filter.run(dual_parameters(theta, active), keep);
  }
  MatrixXd sum = MatrixXd::Zero(theta.size(), theta.size());
  for (std::size_t plot = 0; plot < window.plots.size(); ++plot) {
    sum += information_of(std::span(all).subspan(plot * modes, modes), theta.size());
  }
  return sum;
}

}  // namespace

void sort_plots(std::vector<CalibrationPlot>& plots) {
  std::sort(plots.begin(), plots.end(), [](const CalibrationPlot& a, const CalibrationPlot& b) {
    return std::pair(a.track, a.scan) < std::pair(b.track, b.scan);
  });
}

VectorXd stacked(std::span<const Correction> corrections) {
  VectorXd theta(std::ssize(corrections) * kCorrectionSize);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    theta.segment<kCorrectionSize>(static_cast<Eigen::Index>(i) * kCorrectionSize) = to_vector(corrections[i]);
  }
  return theta;
}

std::vector<Correction> unstacked(const VectorXd& theta) {
  std::vector<Correction> corrections;
  for (Eigen::Index first = 0; first < theta.size(); first += kCorrectionSize) {
    corrections.push_back(to_correction(theta.segment<kCorrectionSize>(first)));
  }
  return corrections;
}

bool in_bounds(const VectorXd& theta) {
  for (int radar = 0; radar * kCorrectionSize < theta.size(); ++radar) {
    const auto scales = theta.segment<2>(radar * kCorrectionSize);
    if (!theta.allFinite() || scales.cwiseAbs().maxCoeff() > kLargestLogScale) return false;
  }
  return true;
}

bool is_finite(const CalibrationWindow& window) {
  return std::all_of(window.plots.begin(), window.plots.end(), [](const CalibrationPlot& plot) {
    return plot.z.allFinite() && plot.sigma.allFinite() && plot.sigma.minCoeff() > 0.0 && plot.predicted.allFinite() &&
           (!plot.truth || plot.truth->allFinite());
  });
}

bool negative_log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, const VectorXd& theta,
                             double& cost, VectorXd& gradient) {
  if (!in_bounds(theta)) return false;
  InnovationFilter<Dual> filter(window, motion);
  gradient.resize(theta.size());
  for (int active = 0; active < radars_of(window); ++active) {
    Dual sum(0.0);
    filter.run(dual_parameters(theta, active),
               [&](std::size_t, auto, const Dual&, const Dual& log_density) { sum -= log_density; });
    cost = sum.a;
    gradient.segment<kCorrectionSize>(active * kCorrectionSize) = sum.v;
  }
  return std::isfinite(cost) && gradient.allFinite();
}

std::optional<MatrixXd> complete_information(const CalibrationWindow& window, const MotionPrior& motion,
                                             std::span<const Correction> theta) {
  if (!is_finite(window)) return std::nullopt;
  MatrixXd result = information(window, motion, stacked(theta));
  if (!result.allFinite()) return std::nullopt;
  return result;
}

std::optional<MatrixXd> observed_information(const CalibrationWindow& window, const MotionPrior& motion,
                                             std::span<const Correction> theta, const VectorXd& sigma) {
  constexpr double kStep = 0.1;  // standard errors, of the least that they can be
  const auto complete = complete_information(window, motion, theta);
  if (!complete) return std::nullopt;
  const VectorXd least = (complete->diagonal() + sigma.cwiseAbs2().cwiseInverse()).cwiseSqrt().cwiseInverse();
  const VectorXd at = stacked(theta);
  MatrixXd second(at.size(), at.size());
  double cost = 0.0;
  VectorXd ahead;
  VectorXd behind;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const double step = kStep * least[k];
    const VectorXd move = step * VectorXd::Unit(at.size(), k);
    if (!negative_log_likelihood(window, motion, at + move, cost, ahead) ||
        !negative_log_likelihood(window, motion, at - move, cost, behind)) {
      return std::nullopt;
    }
    second.col(k) = (ahead - behind) / (2.0 * step);
  }
  return 0.5 * (second + second.transpose());
}

std::vector<double> mean_nis(const CalibrationWindow& window, const MotionPrior& motion,
                             std::span<const Correction> theta) {
  std::vector<RadarParameters<double>> parameters;
  for (const Correction& correction : theta) parameters.push_back(parameters_of<double>(to_vector(correction)));
  std::vector<double> sum(theta.size(), 0.0);
  std::vector<int> count(theta.size(), 0);
  InnovationFilter<double> filter(window, motion);
  filter.run(parameters, [&](std::size_t plot, std::span<const ModeInnovation<double>> modes, double, double) {
    const std::uint32_t radar = window.plots[plot].radar;
    double largest = modes[0].log_weight;
    for (const ModeInnovation<double>& mode : modes) largest = std::max(largest, mode.log_weight);
    double total = 0.0;
    double nis = 0.0;
    for (const ModeInnovation<double>& mode : modes) {
      const double weight = std::exp(mode.log_weight - largest);
      total += weight;
      nis += weight * mode.nu.dot(mode.s.ldlt().solve(mode.nu));
    }
    sum[radar] += nis / total;
    ++count[radar];
  });
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(count[i], 1);
  return sum;
}

double log_likelihood(const CalibrationWindow& window, const MotionPrior& motion, std::span<const Correction> theta) {
  std::vector<RadarParameters<double>> parameters;
  for (const Correction& correction : theta) parameters.push_back(parameters_of<double>(to_vector(correction)));
  double sum = 0.0;
  InnovationFilter<double> filter(window, motion);
  filter.run(parameters, [&](std::size_t, auto, double, double log_density) { sum += log_density; });
  return sum;
}

}  // namespace dwell
