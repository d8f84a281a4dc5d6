#pragma once

namespace dwell {

/// How much of a certain plot's information a look among false plots keeps on average: q2 of the modified Riccati step
///
///   E P = P - q2 K S K'
///
/// of a PDA update of a Gaussian with a two-dimensional measurement and a 16-gate, over all plots that the look may
/// return; q2 = P_d without clutter, and less with it.
///
///   p_detect           P_d, in the footprint, 0 .. 1
///   false_plots        mean number of false plots in the 16-gate, 16 pi lambda |S|^1/2, >= 0
///
/// From a table of 1 - q2 / P_d over P_d .3 .. .99 and .001 .. 10 false plots, log-linear in both. Beyond it: the
/// nearest P_d; with fewer false plots the power law of the first two points; with more, q2 falls with their number, as
/// the information of a weak signal in Poisson noise does. The table is by simulation of the update's weights, 400 000
/// to 1 500 000 draws a point: q2 = E |sum beta_i S^-1/2 nu_i|^2 / 2, its standard error under 1e-3.
///
/// Error    of the expected covariance, measured in tests/bandit/information_reduction_test.cpp where a certain plot
///          leaves a tenth of the variance: under 3 % for P_d .5 .. .99 and up to one false plot, 1 to 3 % too small at
///          two. The closed form of Kershaw and Evans (1997), .997 P_d / (1 + .37 P_d^-1.57 m), is off by up to 25 % in
///          1 - q2 at P_d = .99.
/// Source   Fortmann, Bar-Shalom, Scheffe, Gelfand (1985), IEEE T-AC 30(3); Evans et al. (2005), IV-D.
double information_reduction(double p_detect, double false_plots);

}  // namespace dwell
