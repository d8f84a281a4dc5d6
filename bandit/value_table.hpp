#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "bandit/value_bucket.hpp"

namespace dwell {

/// The priced value of the target at a point of the grid, in its units.
struct PricedBucket {
  restless::ValueSet value;
  double price = 0.0;  ///< of a look
  double cost = 0.0;   ///< a scan, without what the looks cost
  double rate = 0.0;   ///< looks a scan
};
using SharedBucket = std::shared_ptr<const PricedBucket>;

/// Solves a point of the grid by bandit/restless/priced_arm.hpp: covariances within 3 % of their standard deviations
/// are one, at most 500. From covariances up to 1e6 times those of looks in every scan on: tracks begin there, and
/// manoeuvres lead there. Prices are followed upwards from one at which every scan has its look; where the points do
/// not do for waits that long, the value is that of a lower price. Some milliseconds to some hundreds.
PricedBucket solve_bucket(const BucketKey& key);

/// Value sets by grid point: asked for in one scan, due in a later one, kept while they are used.
///
/// A set is a function of its key alone, so runs and threads may share a table, and what a run does depends on nothing
/// but whether a set that was due was there. That a set is late happens in one way only, `OnDue::kGoOn` without a
/// builder that is fast enough; it is noted, and `expect_late` repeats it.
class ValueTable {
 public:
  enum class OnDue {
    kBuild,  ///< what is due and not there is built at once, by who takes it: studies, fast runs, replays
    kGoOn,   ///< it is late: the taker neither builds nor waits, not even for a lock
  };
  /// Sets that are kept beyond those in use, 10 to 50 kB each.
  static constexpr std::size_t kMostSets = 4096;

  explicit ValueTable(OnDue on_due = OnDue::kBuild);

  /// For a builder. Forgotten where a builder is at work on the table itself or too much is asked for: then it is late.
  void ask(const BucketKey& key);
  /// For kGoOn, before the first `due` of a scan: a set is there for all that ask in a scan, or late for all.
  void begin_scan() { outcomes_.clear(); }
  /// What was asked for; null: late.
  SharedBucket due(const BucketKey& key);

  /// Keys that were late since the last call, in order.
  std::vector<std::uint64_t> take_late();
  /// Are late until the next call, whether there or not.
  void expect_late(std::vector<std::uint64_t> keys) { expected_late_ = std::move(keys); }

  /// Sets that are asked for and not begun.
  std::size_t waiting();
  /// For a builder's thread: waits for a set to be asked for and builds it. False where `stop` was called.
  bool build_next();
  void stop();

 private:
  struct Entry {
    SharedBucket set;  // null: somebody builds it
    std::uint64_t used = 0;
  };
  SharedBucket find(std::uint64_t key);
  SharedBucket build(std::unique_lock<std::mutex>& lock, std::uint64_t key);
  void make_room();

  struct Outcome {
    std::uint64_t key;
    SharedBucket set;  // null: late
  };

  const OnDue on_due_;
  std::vector<std::uint64_t> expected_late_;  // of the taker's thread, as the next two
  std::vector<std::uint64_t> late_;
  std::vector<Outcome> outcomes_;  // of this scan
  std::mutex mutex_;               // of what follows
  std::condition_variable changed_;
  std::unordered_map<std::uint64_t, Entry> entries_;
  std::vector<std::uint64_t> asked_;  // in order, from `next_` on
  std::size_t next_ = 0;
  std::uint64_t uses_ = 0;
  bool stopped_ = false;
};

}  // namespace dwell
