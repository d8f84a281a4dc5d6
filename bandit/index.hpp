#pragma once

#include <memory>
#include <vector>

#include "bandit/best_looks.hpp"
#include "bandit/orbit.hpp"
#include "bandit/policy_settings.hpp"
#include "bandit/value_table.hpp"

namespace dwell {

/// The Lagrangian index: what a look gains now and later, less what it costs elsewhere.
///
/// The scans' looks are relaxed to so many on average, at a price. A track is then a problem of its own (TrackPath),
/// its priced value V taken from a table of targets like it (BucketKey), and
///
///   A(s)       = cost(P) + V(P') - E [ cost(M) + V(M') ] - price - gamma_s          depth 1; ' is the next scan
///   score(s)   = the same with the best looks of the next scan in place of none,    depth 2
///                over what this look may see
///
/// Depth 2 is worked out for the eight best pairs by A, and the next scan's looks go to their tracks; the other pairs
/// keep their A, lowered so that they stay behind.
///
/// The price is that at which the tracks' sets would be looked at `looks` times a scan in all, each rate taken to
/// change with the fourth root of the price (what a position-velocity target's does when looks are rare),
///   price = correction (sum_i rate_i price_i^1/4 / looks)^4,    rate_i at price_i from the set,
/// where the correction rises by up to 3 % in a scan whose last look by A is worth more than it costs, and falls where
/// it is worth less: sets know nothing of how manoeuvres come and go. Where every radar that is up has a look in every
/// scan each has a correction, and so a price, of its own, by the best A of its looks. A set counts the looks of both
/// its radars at the leading one's price. Before there is any set the price is the best orbit index.
///
/// The sets about a track's place on the grid (BucketKey) are asked for when it comes into a new cell and due `kDelay`
/// scans later; where one is late it is asked for again. Until then the track stays where it was last in a cell whose
/// sets it has, with the units of that place; it keeps those of `kCells` cells. While a track has none at all every
/// pair is scored by its orbit index, and the decision says so. Several looks of a scan are those of the greatest total
/// score. They have one price: those of single radars are not worked out. Source   bandit/restless/README.md; Brown,
/// Smith (2020) for Lagrangian indices; depth 2, grid and price: ours.
class Index final : public Policy {
 public:
  static constexpr int kDelay = 4;
  static constexpr std::size_t kCells = 6;
  static constexpr std::size_t kFinalists = 8;
  static constexpr int kMostDepth = 2;

  explicit Index(const IndexSettings& settings);

  std::string_view name() const override { return "index"; }
  void decide(const Situation& situation, Decision& decision) override;

 private:
  /// A cell of the grid with its sets.
  struct Cell {
    BucketPlace place;  // of the track, when it was last there
    std::array<double, kCorners> weights{};
    std::array<SharedBucket, kCorners> sets;
    int used = 0;  // scan
  };
  /// What is kept of a track from scan to scan.
  struct Held {
    TrackId track;
    std::vector<Cell> cells;
    std::size_t current = 0;  // in `cells`, where that is not empty
    BucketPlace asked;
    int due = 0;  // scan; 0: nothing is asked for
  };

  void score(const Situation& situation, std::span<Candidate> candidates) override;
  void choose(const Situation& situation, Decision& decision) override { best_looks_.add(situation, decision); }
  void follow_tracks(const Situation& situation);
  void take_sets(const Situation& situation, ValueTable& table);
  void take_due(Held& held, ValueTable& table);
  void place_track(Held& held, const BucketPlace& place, ValueTable& table);
  void find_price(const Situation& situation);
  void correct_prices(const Situation& situation, std::span<const Candidate> candidates);
  void set_prices(const Situation& situation);
  double mean_price() const;
  bool all_have_sets(std::span<const Candidate> candidates) const;
  void score_advantages(const Situation& situation, std::span<Candidate> candidates);
  void look_ahead(const Situation& situation, std::span<Candidate> candidates);

  double cost(std::size_t track, const StateMatrix& p) const;
  double value(std::size_t track, const StateMatrix& p) const;
  double best_gain(std::size_t track, TrackPath& path, const StateMatrix& predicted) const;
  double gain_of_two(const Candidate& candidate, double next_if_idle, double best_of_others);

  int depth_;
  int scan_ = 0;
  double price_ = 0.0;              // before its correction
  std::vector<double> correction_;  // of each sensor's price
  std::vector<double> prices_;      // of each sensor
  double reference_ = 0.0;
  bool by_orbit_ = false;
  OrbitIndex orbit_;
  BestLooks best_looks_;
  ValueTable own_table_;
  const Situation* situation_ = nullptr;
  std::vector<Held> held_, before_;
  std::vector<const Cell*> cells_;  // of each track; null: none yet
  std::vector<TrackPath> paths_;    // of each track
  std::vector<std::size_t> finalists_;
  std::vector<double> next_gain_;  // of each finalist's track, in the next scan where nobody looks now
  std::vector<double> ranked_;
};

}  // namespace dwell
