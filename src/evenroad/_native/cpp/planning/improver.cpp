// Trees may find a path that is longer than the best by a share that changes from round to round, because smoothing
// makes it shorter.  The share repeatedly comes near 0, so in the end no better path is missed.
#include "planning/improver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/time_limit.hpp"
#include "planning/shortcuts.hpp"

namespace evenroad::planning {

namespace {

/// Largest share by which paths of trees may be longer than the best path.  It is multiplied by the square of the
/// fractional part of a multiple of the golden ratio.
constexpr double LOOSEST = 3.0;

/// Every third round begins with start and goals alone.  The others also begin with both ends of the best path, so that
/// they need not find the way out of a narrow passage again.  The cuts are even in the plane: powers of 1 / 1.3247...
constexpr std::int64_t ANEW = 3;
constexpr double PLASTIC = 0.7548776662466927;

/// Limit on the motions of a round's trees: the larger of a number and a multiple of the first path's motions, times 1,
/// 1, 2, 1, 1, 2, 4 ...
constexpr std::int64_t LEAST_MOTIONS = 400, TIMES_FIRST = 2;

/// Number of rounds without a better path after which the best one is polished, repeatedly while it gets shorter.
constexpr std::int64_t WAIT = 3;
constexpr std::size_t MOST_POLISHED = 4;

/// Share of excess over the best path below which another path is polished, too.
constexpr double PROMISING = 0.01;

/// Batches of sixteen checks after which waypoints stop sliding before a path is polished.
constexpr std::int64_t SMOOTHING = 2000;

/// Share of excess over the straight distance below which a path counts as the shortest.
constexpr double STRAIGHT = 1e-9;

/// Return term i >= 1 of 1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8 ... (M. Luby, A. Sinclair, D. Zuckerman, 1993).
std::int64_t luby(std::int64_t i) {
  std::int64_t power = 1;
  while (power < i + 1) power *= 2;
  return power == i + 1 ? power / 2 : luby(i - power / 2 + 1);
}

}  // namespace

Improver::Improver(Matrix<const double> terminals, const Sequences& sequences, const Guides& guides, First first,
                   bool is_smoothing, MotionChecks& checks)
    : terminals_(terminals),
      sequences_(sequences),
      guides_(guides),
      checks_(checks),
      is_smoothing_(is_smoothing),
      bound_(terminals, checks.joints),
      best_(first.path),
      along_trees_(std::move(first.path)),
      goal_(first.goal),
      round_motions_(std::max(LEAST_MOTIONS, TIMES_FIRST * std::min(first.motions, MOST_MOTIONS))),
      is_polished_(!is_smoothing) {
  best_.measure();
}

Progress Improver::improve(Effort most, std::int64_t batches) {
  const std::int64_t pause = checks_.counts.batches + batches;
  while (length() > (1.0 + STRAIGHT) * least()) {
    look_at_clock();
    if (motions_ >= most.motions) return Progress::SPENT;
    if (checks_.counts.batches >= pause) return Progress::PAUSED;
    TreePlanner* trees = trees_ ? &*trees_ : nullptr;
    if (trees == nullptr) {
      const bool is_last = rounds_ >= most.rounds;
      if (!is_polished_ && (is_last || rounds_ - best_round_ >= WAIT)) {
        polish_best();
        continue;
      }
      if (is_last) return Progress::SPENT;
      trees = &begin_round();
    }
    switch (grow(*trees, most, pause)) {
      case Growth::PAUSED:
        return Progress::PAUSED;
      case Growth::SOLVED:
        take(trees->path(), trees->goal());
        break;
      case Growth::SPENT:
      case Growth::NOT_FREE:
        if (left_ > 0 && motions_ >= most.motions) return Progress::SPENT;
    }
    nodes_ += trees->tree(0).size() + trees->tree(1).size();
    trees_.reset();
  }
  return Progress::SHORTEST;
}

TreePlanner& Improver::begin_round() {
  rounds_++;
  const double share = std::fmod(static_cast<double>(rounds_) * GOLDEN, 1.0);
  bound_.longest = is_smoothing_ ? length() * (1.0 + LOOSEST * share * share) : length();
  left_ = round_motions_ * luby(rounds_);
  TreePlanner& trees = trees_.emplace(terminals_, sequences_, checks_, &bound_, static_cast<std::size_t>(rounds_));
  if (is_smoothing_ && rounds_ % ANEW != 0) {
    const double one = position_of_round(PLASTIC), other = position_of_round(PLASTIC * PLASTIC);
    trees.begin_along(best_, goal_, std::min(one, other), std::max(one, other));
  }
  return trees;
}

/// Return a place along the best path, even over the rounds.
double Improver::position_of_round(double step) const {
  return length() * std::fmod(static_cast<double>(rounds_) * step, 1.0);
}

Growth Improver::grow(TreePlanner& trees, Effort most, std::int64_t pause) {
  const std::int64_t before = checks_.counts.motions;
  const std::int64_t some = std::min(left_, most.motions - motions_);
  const Growth growth = trees.grow(before + some, pause - checks_.counts.batches);
  const std::int64_t checked = checks_.counts.motions - before;
  motions_ += checked, left_ -= checked;
  return growth;
}

/// Take a path of the trees if it is the best once it is drawn tight.
void Improver::take(const std::vector<double>& points, std::int64_t goal) {
  Path path{points, checks_.joints};
  if (is_smoothing_) smooth(path, guides_, {SMOOTHING}, true, checks_);
  path.measure();
  if (is_smoothing_ && path.length() < (1.0 + PROMISING) * length() && path.length() >= length()) {
    polish(path, guides_, 0, checks_);
    path.measure();
  }
  if (path.length() >= length()) return;
  best_ = std::move(path), along_trees_ = Path{points, checks_.joints}, goal_ = goal;
  is_polished_ = !is_smoothing_, polished_ = 0, best_round_ = rounds_;
}

void Improver::polish_best() {
  const bool is_shorter = polish(best_, guides_, polished_, checks_);
  polished_++;
  is_polished_ = !is_shorter || polished_ >= MOST_POLISHED;
  best_.measure();
}

}  // namespace evenroad::planning
