#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "daemon/config/field_reader.hpp"
#include "daemon/engine_config.hpp"

namespace dwell {

/// The sections of a config, one file each in this folder. Each reads its message into the domain struct and leaves
/// what is wrong with it in the reader's violations.

TargetClasses read_classes(FieldReader in);

SensorConfig read_radar(FieldReader in, Duration scan_period, const TargetClasses& classes);
SensorConfig read_linear_sensor(FieldReader in, Duration scan_period, const TargetClasses& classes);
/// Of either sensor; empty where its plots declare no class.
std::optional<Declaration> read_emission(FieldReader& in, const TargetClasses& classes);
/// Of a target, from 0; empty where none is given.
std::optional<int> read_target_class(FieldReader& in, const TargetClasses& classes);

/// Simulation only: a radar's truth and faults.
void read_radar_truth(FieldReader radar, SensorConfig& sensor);
void read_calibration(FieldReader in, CalibrationSettings& settings);

/// A bank by name or spelled out; checked against the scan period. `fallback` where the message is empty.
ModeBank read_bank(FieldReader in, Duration scan_period, const ModeBank& fallback);
ProcessNoise read_process_noise(FieldReader in, Duration scan_period);

/// Tracker settings, bank and loss rule into `config`.
void read_tracker(FieldReader in, EngineConfig& config);

/// Recordings are read once each, however many targets come from them.
class RecordingShelf {
 public:
  explicit RecordingShelf(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Empty where the file cannot be read: then `problems` says why.
  const std::vector<RecordedFlight>* flights(const std::string& file, std::vector<Violation>& problems);

 private:
  std::filesystem::path directory_;
  std::map<std::string, std::vector<RecordedFlight>> flights_;
  std::set<std::string> bad_;
};

TargetConfig read_target(FieldReader in, const EngineConfig& config, RecordingShelf& shelf,
                         std::vector<Violation>& violations);

/// What a number may be, far beyond anything that flies or looks: more is a mistake in the units, and the squares and
/// products of a run could overflow.
inline Range place_m() { return within(-1e9, 1e9); }  // the Moon is nearer
inline Range length_m() { return above(0.0, 1e9); }
inline Range speed_mps() { return within(-1e6, 1e6); }
inline Range variance() { return within(-1e18, 1e18); }  // elements of a covariance: the square of a length
inline Range cost() { return within(0.0, 1e12); }

/// Whether a time is a whole number of scan periods.
bool is_multiple(Duration time, Duration scan_period);

/// Row-major values as a matrix.
template <class Matrix>
Matrix row_major(const std::vector<double>& values, int rows, int columns) {
  Matrix matrix(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) matrix(i, j) = values[static_cast<std::size_t>(i * columns + j)];
  }
  return matrix;
}

/// How far from one the sum of probabilities may be: printed ones are rounded.
inline constexpr double kProbabilitySum = 1e-6;

/// n x n probabilities, row-major, each row scaled to sum to one, which it does already but for rounding; empty where
/// they are absent or refused.
std::optional<Eigen::MatrixXd> read_stochastic(FieldReader& in, const char* field, int n);
/// Refuses rows that do not sum to one.
void check_probabilities(FieldReader& in, const char* field, const Eigen::MatrixXd& rows);

/// Symmetric to 1e-9 of its largest element, and with a Cholesky factor.
template <class Matrix>
bool is_covariance(const Matrix& matrix) {
  const double scale = matrix.cwiseAbs().maxCoeff();
  return (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * scale && matrix.llt().info() == Eigen::Success;
}

}  // namespace dwell
