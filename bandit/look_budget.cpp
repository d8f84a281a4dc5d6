#include "bandit/look_budget.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "radar/assert.hpp"

namespace dwell {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 2;

}  // namespace

LookBudget::LookBudget(const BudgetSettings& settings) : settings_(settings) {
  DWELL_ASSERT(settings.looks >= 0 && settings.scans >= 1);
  if (settings_.looks >= settings_.scans) settings_.looks = 0;
  taken_.assign(static_cast<std::size_t>(settings_.looks), kNever);
}

void LookBudget::next_scan() {
  ++scan_;
  if (limited()) account_ = account_at(scan_, account_);
}

void LookBudget::take() {
  if (!limited()) return;
  account_ -= settings_.scans;
  taken_[next_] = scan_;
  next_ = (next_ + 1) % taken_.size();
}

bool LookBudget::allows(int ahead, Plan planned) const {
  if (!limited()) return true;
  DWELL_ASSERT(ahead >= 0 && ahead < kPlannedScans);
  const std::int64_t then = scan_ + ahead;
  const std::int64_t first = then - reach(then) + 1;
  int looks = taken_since(first);
  std::int64_t account = account_;
  for (int i = 0; i < ahead; ++i) {
    const bool look = ((planned >> i) & 1) != 0;
    if (look && scan_ + i >= first) ++looks;
    account = account_at(scan_ + i + 1, account - (look ? settings_.scans : 0));
  }
  if (looks >= settings_.looks) return false;
  return settings_.spread == BudgetSettings::Spread::kFree || account > 0;
}

int LookBudget::left() const {
  DWELL_ASSERT(limited());
  return settings_.looks - taken_since(scan_ - reach(scan_) + 1);
}

std::int64_t LookBudget::reach(std::int64_t scan) const {
  if (settings_.span == BudgetSettings::Span::kWindow) return settings_.scans;
  return (scan - 1) % settings_.scans + 1;
}

int LookBudget::taken_since(std::int64_t first_scan) const {
  return static_cast<int>(std::count_if(taken_.begin(), taken_.end(), [&](std::int64_t s) { return s >= first_scan; }));
}

/// The account as the given scan begins.
std::int64_t LookBudget::account_at(std::int64_t scan, std::int64_t account) const {
  if (settings_.span == BudgetSettings::Span::kHorizon && reach(scan) == 1) account = 0;
  return std::min(account + settings_.looks, std::int64_t{settings_.looks} * settings_.scans);
}

}  // namespace dwell
