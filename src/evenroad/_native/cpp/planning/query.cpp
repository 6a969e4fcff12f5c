// Compiled code answers a query in one call.  Python reads the query before, and continues if there is no path.
#include "planning/query.hpp"

#include "common/time_limit.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path_proof.hpp"
#include "planning/with_clearance.hpp"

namespace evenroad::planning {

namespace {

/// Batches of sixteen checks after which trees pause to look at the clock.
constexpr std::int64_t NO_PAUSE = std::int64_t{1} << 60;

/// Batches after which waypoints stop sliding.
constexpr std::int64_t SLIDING = 500;

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(SteadyClock::now() - began_).count(); }

 private:
  SteadyClock::time_point began_ = SteadyClock::now();
};

/// Divide a straight path into a number of equal motions.
void divide(Path& path, std::int64_t motions, const robot::Joints& joints) {
  path.measure();
  const double length = path.length();
  std::vector<double> between(joints.size());
  for (std::int64_t i = motions - 1; i > 0; i--) {
    path.write_position(0, length * static_cast<double>(i) / static_cast<double>(motions), between);
    path.insert(1, between);
  }
}

/// Grow trees until they meet or a limit is reached.
Growth grown(TreePlanner& trees, QueryLimits limits) {
  const TimeLimit time(limits.search_seconds);
  try {
    return trees.grow(limits.motions, NO_PAUSE);
  } catch (const TimeIsOver&) {
    return Growth::PAUSED;
  }
}

/// Run an optional step; return whether there was time for it.
template <class Work>
bool is_done_in_time(Work work) {
  try {
    work();
    return true;
  } catch (const TimeIsOver&) {
    return false;
  }
}

/// Write the path of an answer, smoothed in both worlds.
void smooth_in_both(Answer& answer, std::shared_ptr<const robot::Checker> checker,
                    std::shared_ptr<const robot::Checker> roomier, const Drivers& drivers) {
  MotionChecks checks(std::move(checker));
  Path path(answer.raw, checks.joints);
  const bool is_straight = path.size() == 2;
  bool is_new = !is_straight;
  if (roomier->is_never_free()) {
    smooth(path, drivers.guides, {SLIDING}, true, checks);
  } else {
    MotionChecks wider(std::move(roomier));
    if (!is_straight || !is_proved(path, 0, 2, wider)) {
      if (is_straight) divide(path, answer.nodes - 1, checks.joints);
      // A straight path is the shortest.  It stays, unless another one keeps away from obstacles.
      is_new |= smooth_with_clearance(path, drivers.guides, SLIDING, checks, wider);
    }
    answer.smoothing_motions += wider.counts.motions;
  }
  if (is_new) {
    answer.path = path.points();
    answer.length = length_of(answer.path, checks.joints);
  }
  answer.smoothing_motions += checks.counts.motions;
}

}  // namespace

Answer answer(std::shared_ptr<const robot::Checker> checker, Matrix<const double> terminals, const Drivers& drivers,
              QueryLimits limits, Smoothing smoothing) {
  const Clock clock;
  Answer found;
  if (checker->is_never_free()) return found;
  MotionChecks checks(std::move(checker));
  TreePlanner trees(terminals, drivers.sequences, checks);
  found.growth = grown(trees, limits);
  found.raw = found.path = trees.path();
  found.nodes = trees.tree(0).size() + trees.tree(1).size();
  found.configurations = checks.counts.configurations, found.motions = checks.counts.motions;
  found.search_seconds = clock.seconds();
  if (found.growth != Growth::SOLVED) return found;
  found.raw_length = found.length = length_of(found.raw, checks.joints);
  const bool is_smoothed = smoothing == Smoothing::QUICK || smoothing == Smoothing::FULL;
  if (!is_smoothed || found.raw.size() <= 2 * terminals.columns) return found;
  found.is_cut = !is_done_in_time([&] {
    Path path(found.raw, checks.joints);
    if (smoothing == Smoothing::QUICK) {
      shorten(path, drivers.guides.pairs, MOST_SHORTCUTS, checks);
    } else {
      smooth(path, drivers.guides, {SLIDING}, true, checks);
    }
    found.path = path.points();
    found.length = length_of(found.path, checks.joints);
  });
  found.smoothing_motions = checks.counts.motions - found.motions;
  found.smoothing_seconds = clock.seconds() - found.search_seconds;
  return found;
}

void smooth_with_clearance(Answer& answer, std::shared_ptr<const robot::Checker> checker,
                           std::shared_ptr<const robot::Checker> roomier, const Drivers& drivers) {
  // A single step of a tree is short, and is not smoothed.
  if (answer.nodes <= 2) return;
  const Clock clock;
  answer.is_cut |= !is_done_in_time([&] { smooth_in_both(answer, std::move(checker), std::move(roomier), drivers); });
  answer.smoothing_seconds += clock.seconds();
}

}  // namespace evenroad::planning
