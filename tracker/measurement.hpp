#pragma once

#include <span>
#include <vector>

#include "tracker/imm.hpp"

namespace dwell {

/// How a plot meets the state.
enum class UpdateForm {
  kEkf,        ///< in the sensor's own measurement, h linearised at each mode's mean
  kConverted,  ///< plot turned into x and y with `position_noise`; other sensors as kEkf
  kCubature,   ///< as kEkf, with the moments of h over each mode's Gaussian by the cubature rule of degree 3
};

/// Covariance of the position that a plot of a target at x stands for, 2 x 2, m^2, exactly symmetric.
///
///   G R G' with G = (dz / d(x, y))^-1 at x
///
/// For range and bearing the D D' of Evans et al. (2005), V. It neglects the bias of the conversion,
/// sigma_azimuth^2 range / 2 in range: 0.3 m at 100 km and 0.14 deg.
/// Requires a sensor whose measurement is a position (`position_of`).
Matrix2 position_noise(const Sensor& sensor, const State& x);

/// Predicted measurement of a sensor for every mode of a predicted estimate.
///
/// R is the sensor's at the mode-weighted predicted position x, the same for every mode.
///   kEkf         z_j = h(x_j), H_j = dh/dx at x_j
///   kConverted   z_j = (x, y) of x_j, R = position_noise at x
///   kCubature    z_j, S_j - R and C_j the mean, covariance and cross-covariance of h over the 2n points
///                x_j +- sqrt(n) (P_j^1/2)_k; H_j = C_j' P_j^-1, R_j = R + what of the covariance is not H_j P_j H_j'.
///                So S_j, the gain C_j S_j^-1 and Joseph's form are those of the cubature filter. Of a linear h it is
///                kEkf. Source: Arasaratnam, Haykin (2009), IEEE T-AC 54(6); as statistical linear regression:
///                Lefebvre, Bruyninckx, De Schutter (2002), IEEE T-AC 47(8).
/// `out` is resized to the number of modes; no allocation when it has that size.
/// Errors   kNotPositiveDefinite of S_j, and of P_j in the cubature form.
Numerics predict_measurements(const Sensor& sensor, UpdateForm form, const ImmEstimate& predicted,
                              std::vector<PredictedMeasurement>& out);

/// The plot's measurement in the space of `predict_measurements`.
Vector2 measurement_of(const Sensor& sensor, UpdateForm form, const Vector2& z);

/// z - predicted in that space; bearings the short way round.
Vector2 innovation(const Sensor& sensor, UpdateForm form, const Vector2& z, const Vector2& predicted);

/// The sensor's density of false plots in that space, per unit of its volume at x.
double clutter_density(const Sensor& sensor, UpdateForm form, const State& x);

/// The moment-matched innovation's squared distance: NIS, 2 degrees of freedom.
double mixture_squared_distance(std::span<const PredictedMeasurement> predicted, const Eigen::VectorXd& probability,
                                std::span<const Vector2> innovation);

}  // namespace dwell
