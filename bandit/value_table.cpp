#include "bandit/value_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bandit/restless/priced_arm.hpp"

namespace dwell {
namespace {

constexpr double kLowPrice = 1.0;
constexpr double kPriceStep = 16.0;
constexpr std::size_t kMostAsked = 4096;  // not built yet
constexpr std::size_t kMostDue = 4096;    // in a scan, without an allocation

}  // namespace

PricedBucket solve_bucket(const BucketKey& key) try {
  restless::PricedArmSettings settings;
  settings.maximum_points = 500;
  settings.improvements = 12;
  settings.same_point_of_many_states = 0.03;
  const restless::Arm arm = arm_of(key);
  restless::PricedArm priced(arm, 1.0, settings);
  for (double scale = 100.0; scale <= 1e6; scale *= 100.0) priced.add_seed(scale * arm.p0);
  // From prices at which every scan has its look upwards: each value begins the search for the next.
  const double price = price_of(key);
  for (double lower = std::max(price * std::pow(kPriceStep, -40.0), kLowPrice); lower < price; lower *= kPriceStep) {
    (void)priced.solve(lower);
  }
  const restless::PricedValue value = priced.solve(price);
  return {priced.value(), price, value.cost, value.usage};
} catch (const std::domain_error&) {
  // Far below any tracking index of aircraft two radars in turn do not settle to rounding. One does.
  if (key.size == BucketKey::kAlone) throw;
  BucketKey alone = key;
  alone.size = BucketKey::kAlone;
  alone.other_flat = alone.angle = 0;
  return solve_bucket(alone);
}

ValueTable::ValueTable(OnDue on_due) : on_due_(on_due) {
  asked_.reserve(kMostAsked);
  late_.reserve(kMostDue);
  outcomes_.reserve(kMostDue);
}

void ValueTable::ask(const BucketKey& key) {
  if (on_due_ == OnDue::kBuild) return;  // whoever takes it builds it
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || asked_.size() == kMostAsked) return;
  const std::uint64_t wanted = key.packed();
  if (entries_.contains(wanted) || std::find(asked_.begin(), asked_.end(), wanted) != asked_.end()) return;
  asked_.push_back(wanted);
  changed_.notify_all();
}

SharedBucket ValueTable::due(const BucketKey& key) {
  const std::uint64_t wanted = key.packed();
  if (std::find(expected_late_.begin(), expected_late_.end(), wanted) != expected_late_.end()) return nullptr;
  if (on_due_ == OnDue::kBuild) {
    std::unique_lock lock(mutex_);
    return build(lock, wanted);
  }
  const auto known =
      std::find_if(outcomes_.begin(), outcomes_.end(), [&](const Outcome& o) { return o.key == wanted; });
  if (known != outcomes_.end()) return known->set;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  SharedBucket set = lock ? find(wanted) : nullptr;
  if (!set) late_.push_back(wanted);
  outcomes_.push_back({wanted, set});
  return set;
}

std::vector<std::uint64_t> ValueTable::take_late() {
  std::vector<std::uint64_t> taken = late_;
  late_.clear();
  return taken;
}

SharedBucket ValueTable::find(std::uint64_t key) {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return nullptr;
  found->second.used = ++uses_;
  return found->second.set;
}

/// The set, built here where nobody has begun; without the lock while it is solved.
SharedBucket ValueTable::build(std::unique_lock<std::mutex>& lock, std::uint64_t key) {
  for (;;) {
    if (SharedBucket set = find(key)) return set;
    if (entries_.try_emplace(key).second) break;
    changed_.wait(lock);
  }
  lock.unlock();
  auto set = std::make_shared<const PricedBucket>(solve_bucket(BucketKey::unpacked(key)));
  lock.lock();
  entries_[key] = {set, ++uses_};
  make_room();
  changed_.notify_all();
  return set;
}

/// Forgets the set that nobody holds and that was not used for the longest time, where there are too many.
void ValueTable::make_room() {
  if (entries_.size() <= kMostSets) return;
  auto oldest = entries_.end();
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (entry->second.set.use_count() != 1) continue;
    if (oldest == entries_.end() || entry->second.used < oldest->second.used) oldest = entry;
  }
  if (oldest != entries_.end()) entries_.erase(oldest);
}

std::size_t ValueTable::waiting() {
  const std::scoped_lock lock(mutex_);
  return asked_.size() - next_;
}

bool ValueTable::build_next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || next_ < asked_.size(); });
  if (stopped_) return false;
  const std::uint64_t key = asked_[next_++];
  if (next_ == asked_.size()) {
    asked_.clear();
    next_ = 0;
  }
  build(lock, key);
  return true;
}

void ValueTable::stop() {
  const std::scoped_lock lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

}  // namespace dwell
