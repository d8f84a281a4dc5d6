#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/LU>

#include "radar/calibration/correction.hpp"
#include "radar/calibration/window.hpp"

namespace dwell::calibration {

/// One radar's parameters in the scalar of the computation: double, or a dual number that carries derivatives.
template <class T>
struct RadarParameters {
  T range_scale{1.0};
  T azimuth_scale{1.0};
  T range_bias_m{0.0};
  T azimuth_bias_rad{0.0};
  T time_bias_s{0.0};
};

/// What mode j makes of a plot.
template <class T>
struct ModeInnovation {
  T log_weight;  ///< log(c_j N(nu; 0, S))
  Eigen::Matrix<T, 2, 1> nu;
  Eigen::Matrix<T, 2, 2> s;
};

/// A track's start: so wide that nothing is left of the belief it takes its mean from (a bias is in that, too), while
/// h is linearised where the target is. 10 km and 300 m/s: an azimuth of 60 km range is left open by 10 degrees.
inline constexpr double kStartSigma_m = 10e3;
inline constexpr double kStartSpeedSigma_mps = 300.0;

/// That a plot in the gate is not the track's: the uniform component that bounds what one plot can do.
inline constexpr double kOutlierProbability = 1e-3;

/// Innovations of a window under given parameters, by the interacting multiple model filter over each track.
///
/// The filter is that of tracker/imm.hpp over the gaps between plots, with the measurement of `Correction`, and with
/// the plot an outlier of density u at probability eps:
///
///   p(z) = (1 - eps) sum_j c_j N(nu_j; 0, S_j) + eps u,        S_j = H P_j H' + R(theta)
///   x_j += w_j K_j nu_j,   w_j = (1 - eps) N_j / ((1 - eps) N_j + eps u)
///   P_j -= w_j K_j S_j K_j' - w_j (1 - w_j) K_j nu_j nu_j' K_j'
///
/// (the moments of probabilistic data association, mode by mode)
/// so that -log p summed over the plots is the prediction-error decomposition of the likelihood. It differs from the
/// tracker in two things: the chain mixes once a gap, not once a scan, and the modes' weights follow from the
/// parameters at hand. Where the truth is known there is no filter: nu = z - h(truth), S = R.
///
/// Scalar   T: + - * / exp log sqrt atan2; derivatives through all of it, the linearisation point included. Whatever of
///          dual numbers GCC leaves to calls is five times slower: hence `flatten`.
/// Cost     O(plots M^2 n^2 + plots M n^3) in T.
/// Source   Bar-Shalom, Li, Kirubarajan (2001), 11.6.6; the outliers: Bar-Shalom, Daum, Huang (2009); the
///          decomposition: Schweppe (1965).
template <class T>
class InnovationFilter {
 public:
  using Vector = Eigen::Matrix<T, 2, 1>;
  using Square = Eigen::Matrix<T, 2, 2>;
  using StateT = Eigen::Matrix<T, kStateSize, 1>;
  using CovarianceT = Eigen::Matrix<T, kStateSize, kStateSize>;

  InnovationFilter(const CalibrationWindow& window, const MotionPrior& prior)
      : window_(window), prior_(prior), modes_(static_cast<std::size_t>(prior.initial_probability.size())) {}

  /// Calls visit(plot index, span of ModeInnovation, log(eps u), log p(z)) for every plot in order.
  template <class Visit>
  void run(std::span<const RadarParameters<T>> radars, Visit&& visit) {
    for (std::size_t i = 0; i < window_.plots.size(); ++i) {
      const CalibrationPlot& plot = window_.plots[i];
      if (plot.truth) {
        place(*plot.truth, 0.0, 0.0);
      } else if (!follows(i)) {
        place(plot.predicted, kStartSigma_m, kStartSpeedSigma_mps);
      } else {
        predict(prior_.steps[plot.scan - window_.plots[i - 1].scan]);
      }
      expect(plot, radars[plot.radar]);
      const T log_outlier{std::log(kOutlierProbability * window_.outlier_density[plot.radar])};
      const T log_density = sum_of_exponentials(log_outlier);
      visit(i, std::span<const ModeInnovation<T>>(innovations_), log_outlier, log_density);
      update(log_outlier);
    }
  }

 private:
  struct Mode {
    StateT x;
    CovarianceT p;
    T probability;
    Eigen::Matrix<T, kStateSize, 2> ph = Eigen::Matrix<T, kStateSize, 2>::Zero();  // P H'
  };

  bool follows(std::size_t i) const {
    if (i == 0 || window_.plots[i].track != window_.plots[i - 1].track) return false;
    return window_.plots[i].scan - window_.plots[i - 1].scan < prior_.steps.size();
  }

  void place(const State& mean, double sigma_m, double sigma_mps) {
    const double position = sigma_m * sigma_m;
    const double speed = sigma_mps * sigma_mps;
    const StateMatrix p = make_state({position, position}, {speed, speed}).asDiagonal();
    for (std::size_t j = 0; j < modes_.size(); ++j) {
      modes_[j].x = mean.cast<T>();
      modes_[j].p = p.cast<T>();
      modes_[j].probability = T{prior_.initial_probability[static_cast<Eigen::Index>(j)]};
    }
  }

  [[gnu::flatten]] void predict(const MotionStep& step) {
    mixed_ = modes_;
    for (std::size_t j = 0; j < modes_.size(); ++j) {
      const auto to = static_cast<Eigen::Index>(j);
      const auto weight = [&](std::size_t i) {
        return T{modes_[i].probability * step.transition(static_cast<Eigen::Index>(i), to)};
      };
      T c{0.0};
      StateT x = StateT::Zero();
      for (std::size_t i = 0; i < modes_.size(); ++i) {
        c += weight(i);
        x += weight(i) * modes_[i].x;
      }
      x /= c;
      CovarianceT p = CovarianceT::Zero();
      for (std::size_t i = 0; i < modes_.size(); ++i) {
        const StateT spread = modes_[i].x - x;
        p += weight(i) * (modes_[i].p + spread * spread.transpose());
      }
      p /= c;
      mixed_[j].x = StateT::Zero();
      add_product(step.f[j], x, mixed_[j].x);
      CovarianceT moved = CovarianceT::Zero();
      add_product(step.f[j], p, moved);
      mixed_[j].p = step.q[j].template cast<T>();
      add_product(step.f[j], moved.transpose(), mixed_[j].p);
      mixed_[j].probability = c;
    }
    std::swap(modes_, mixed_);
  }

  /// sum += F m, by the elements of F that are not zero: few of a motion's, and no derivatives in them.
  template <class Matrix, class Sum>
  static void add_product(const StateMatrix& f, const Matrix& m, Sum& sum) {
    for (int i = 0; i < kStateSize; ++i) {
      for (int k = 0; k < kStateSize; ++k) {
        if (f(i, k) == 0.0) continue;
        for (Eigen::Index l = 0; l < m.cols(); ++l) sum(i, l) += m(k, l) * f(i, k);
      }
    }
  }

  /// nu, S and log(c_j N_j) of every mode.
  [[gnu::flatten]] void expect(const CalibrationPlot& plot, const RadarParameters<T>& radar) {
    using std::atan2;
    using std::log;
    using std::sqrt;
    innovations_.resize(modes_.size());
    const Vector2 origin = window_.radar_position_m[plot.radar];
    const double sine = std::sin(plot.z[1]);
    const double cosine = std::cos(plot.z[1]);
    const T sigma_range = plot.sigma[0] * radar.range_scale;
    const T sigma_azimuth = plot.sigma[1] * radar.azimuth_scale;
    for (std::size_t j = 0; j < modes_.size(); ++j) {
      Mode& mode = modes_[j];
      const T dx = mode.x[kX] + radar.time_bias_s * mode.x[kVx] - origin.x();
      const T dy = mode.x[kY] + radar.time_bias_s * mode.x[kVy] - origin.y();
      const T squared = dx * dx + dy * dy;
      const T range = sqrt(squared);
      // In axes turned to the plot's bearing the difference of bearings is an angle near zero: nothing to wrap.
      const T ahead = dx * sine + dy * cosine;
      const T aside = dx * cosine - dy * sine;
      ModeInnovation<T>& out = innovations_[j];
      out.nu = {plot.z[0] - range - radar.range_bias_m, -atan2(aside, ahead) - radar.azimuth_bias_rad};
      const Vector to_x{dx / range, dy / squared};
      const Vector to_y{dy / range, -dx / squared};
      const StateT p_x = mode.p.col(kX) + radar.time_bias_s * mode.p.col(kVx);
      const StateT p_y = mode.p.col(kY) + radar.time_bias_s * mode.p.col(kVy);
      for (int k = 0; k < 2; ++k) mode.ph.col(k) = p_x * to_x[k] + p_y * to_y[k];
      for (int k = 0; k < 2; ++k) {
        for (int l = 0; l < 2; ++l) {
          out.s(k, l) = to_x[k] * (mode.ph(kX, l) + radar.time_bias_s * mode.ph(kVx, l)) +
                        to_y[k] * (mode.ph(kY, l) + radar.time_bias_s * mode.ph(kVy, l));
        }
      }
      out.s(0, 0) += sigma_range * sigma_range;
      out.s(1, 1) += sigma_azimuth * sigma_azimuth;
      const T determinant = out.s(0, 0) * out.s(1, 1) - out.s(0, 1) * out.s(1, 0);
      const T distance = (out.s(1, 1) * out.nu[0] * out.nu[0] - 2.0 * out.s(0, 1) * out.nu[0] * out.nu[1] +
                          out.s(0, 0) * out.nu[1] * out.nu[1]) /
                         determinant;
      out.log_weight = log(mode.probability) - 0.5 * (distance + log(determinant)) -
                       std::log(2.0 * std::numbers::pi / (1.0 - kOutlierProbability));
    }
  }

  T sum_of_exponentials(const T& log_outlier) const {
    using std::exp;
    using std::log;
    T largest = log_outlier;
    for (const auto& innovation : innovations_) {
      if (innovation.log_weight > largest) largest = innovation.log_weight;
    }
    T sum = exp(log_outlier - largest);
    for (const auto& innovation : innovations_) sum += exp(innovation.log_weight - largest);
    return largest + log(sum);
  }

  [[gnu::flatten]] void update(const T& log_outlier) {
    using std::exp;
    T largest = log_outlier;
    for (const auto& innovation : innovations_) {
      if (innovation.log_weight > largest) largest = innovation.log_weight;
    }
    const T outlier = exp(log_outlier - largest);
    T density = outlier;
    for (const auto& innovation : innovations_) density += exp(innovation.log_weight - largest);
    for (std::size_t j = 0; j < modes_.size(); ++j) {
      Mode& mode = modes_[j];
      const ModeInnovation<T>& seen = innovations_[j];
      const T of_mode = exp(seen.log_weight - largest);
      const T either = of_mode + mode.probability * outlier;
      const T share = of_mode / either;
      const Eigen::Matrix<T, kStateSize, 2> gain = mode.ph * inverse(seen.s);
      const StateT move = gain * seen.nu;
      mode.x += share * move;
      const CovarianceT less = share * (gain * mode.ph.transpose() - (T{1.0} - share) * (move * move.transpose()));
      mode.p -= (less + less.transpose()) * T{0.5};
      mode.probability = either / density;
    }
  }

  static Square inverse(const Square& s) {
    const T determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
    Square result;
    result << s(1, 1) / determinant, -s(0, 1) / determinant, -s(1, 0) / determinant, s(0, 0) / determinant;
    return result;
  }

  const CalibrationWindow& window_;
  const MotionPrior& prior_;
  std::vector<Mode> modes_;
  std::vector<Mode> mixed_;
  std::vector<ModeInnovation<T>> innovations_;
};

}  // namespace dwell::calibration
