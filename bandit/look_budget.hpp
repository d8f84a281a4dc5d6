#pragma once

#include <cstdint>
#include <vector>

namespace dwell {

struct BudgetSettings {
  enum class Span {
    kWindow,   ///< in any `scans` scans on end
    kHorizon,  ///< in scans 1 .. `scans`, and so on: each horizon has looks of its own
  };
  enum class Spread {
    kEven,  ///< the looks come due one after the other, `looks` / `scans` of one a scan
    kFree,  ///< whoever decides may take them all at once
  };
  int looks = 0;  ///< at most; 0: no limit
  int scans = 1;
  Span span = Span::kWindow;
  Spread spread = Spread::kEven;
};

/// How many looks a sensor has left: at most N in L scans.
///
/// Spread evenly, a look must also be due. By scan k of a horizon at most ceil(k N / L) looks; the same in a window,
/// where those that are due and not taken add up to N at most. (An account that gains N a scan up to N L, pays L a
/// look, and allows one while it is positive: whole numbers, nothing drifts.) What is not taken stays due, so a sensor
/// that rested may look several times on end at a manoeuvre. A myopic rule that always prefers the sensor then looks
/// every L / N scans instead of N times at the beginning: of a random walk (q = 1; 10 looks in 60 scans with R = .1,
/// others with R = 50) that leaves a mean variance of 2.2848 where the same rule, left free, leaves 5.0462.
///
/// Source  Evans et al. (2005), IV-F, for the constraints; the spread is ours.
class LookBudget {
 public:
  /// Looks of scans to come are planned for at most so many scans: bit i of a plan is a look i scans from now.
  using Plan = std::uint16_t;
  static constexpr int kPlannedScans = 16;

  LookBudget() = default;
  /// Requires looks >= 0, scans >= 1. What cannot bind (looks >= scans) is no limit.
  explicit LookBudget(const BudgetSettings& settings);

  /// The next scan begins; to be called before the first as well.
  void next_scan();
  /// A look in this scan.
  void take();

  bool limited() const { return settings_.looks > 0; }
  /// Whether a look is allowed `ahead` scans from now, the looks of `planned` before it taken.
  bool allows(int ahead = 0, Plan planned = 0) const;
  /// Looks left in the window that ends now, or in this horizon, due or not. Requires a limit.
  int left() const;
  const BudgetSettings& settings() const { return settings_; }

 private:
  /// How many scans the window or the horizon up to scan `scan` has behind it, this one included.
  std::int64_t reach(std::int64_t scan) const;
  int taken_since(std::int64_t first_scan) const;
  std::int64_t account_at(std::int64_t scan, std::int64_t account) const;

  BudgetSettings settings_;
  std::int64_t scan_ = 0;
  std::int64_t account_ = 0;         // in looks / scans, this scan's gain included
  std::vector<std::int64_t> taken_;  // scans of the last N looks, a ring
  std::size_t next_ = 0;             // its oldest place
};

/// Whether a sensor may look at all.
struct SensorState {
  bool up = true;
  LookBudget budget;
};

}  // namespace dwell
