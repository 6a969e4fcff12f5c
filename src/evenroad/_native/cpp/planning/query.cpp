// The shortest paths touch what they pass, so the last smoothing begins again from what the trees found.
#include "planning/query.hpp"

#include <chrono>
#include <span>

#include "planning/native_checks.hpp"
#include "planning/path_proof.hpp"
#include "space/all_distances.hpp"

namespace evenroad::planning {

namespace {

/// Batches of sixteen checks between two looks at the clock: about 10 ms.
constexpr std::int64_t SLICE = 1000;

/// After so many batches no waypoint slides any more.
constexpr std::int64_t SLIDING = 500, SLIDING_APART = 200;

/// By this share a path may be longer that keeps away from obstacles.
constexpr double LONGER = 0.02;

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count(); }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

/// Return whether both ends of a path are free.
bool are_ends_free(const Path& path, MotionChecks& checks) {
  for (std::size_t lane = 0; lane < LANES; lane++) {
    const ConstConfiguration end = path[lane == 0 ? 0 : path.size() - 1];
    for (std::size_t k = 0; k < end.size(); k++) checks.state(k, lane) = end[k];
  }
  return checks.touching().lanes == 0;
}

/// Return the length of a path as the space of the joints measures it.
double length_of(const std::vector<double>& points, const Joints& joints) {
  const std::size_t dim = joints.size(), motions = points.size() / dim - 1;
  const std::vector<double> scale(dim, 1.0);
  double length = 0.0;
  for (const double each :
       space::row_distances({points.data(), motions, dim}, {points.data() + dim, motions, dim}, scale, joints.period)) {
    length += each;
  }
  return length;
}

/// Divide a straight path into so many equal motions.
void divide(Path& path, std::int64_t motions, const Joints& joints) {
  path.measure();
  const double length = path.length();
  std::vector<double> between(joints.size());
  for (std::int64_t i = motions - 1; i > 0; i--) {
    path.write_place(0, length * static_cast<double>(i) / static_cast<double>(motions), between);
    path.insert(1, between);
  }
}

}  // namespace

Answer answer(std::shared_ptr<const robot::Checker> checker, Matrix<const double> ends, const Drivers& drivers,
              QueryLimits limits, Smoothing smoothing) {
  const Clock clock;
  Answer found;
  if (checker->is_never_free()) return found;
  NativeChecks checks(std::move(checker));
  TreePlanner trees(ends, drivers.sequences, checks);
  do {
    found.growth = trees.grow(limits.motions, SLICE);
  } while (found.growth == Growth::PAUSED && clock.seconds() < limits.seconds);
  found.raw = found.path = trees.path();
  found.nodes = trees.tree(0).size() + trees.tree(1).size();
  found.configurations = checks.counts.configurations, found.motions = checks.counts.motions;
  found.search_seconds = clock.seconds();
  if (found.growth != Growth::SOLVED) return found;
  found.raw_length = found.length = length_of(found.raw, checks.joints);
  if (smoothing == Smoothing::NONE || found.raw.size() <= 2 * ends.columns) return found;
  Path path(found.raw, checks.joints);
  if (smoothing == Smoothing::QUICK) {
    shorten(path, drivers.guides.pairs, MOST_SHORTCUTS, checks);
  } else {
    smooth(path, drivers.guides, SLIDING, true, checks);
  }
  found.path = path.points();
  found.length = length_of(found.path, checks.joints);
  found.smoothing_motions = checks.counts.motions - found.motions;
  found.smoothing_seconds = clock.seconds() - found.search_seconds;
  return found;
}

void keep_apart(Answer& answer, std::shared_ptr<const robot::Checker> roomier, const Drivers& drivers) {
  if (roomier->is_never_free()) return;
  const Clock clock;
  NativeChecks checks(std::move(roomier));
  Path path(answer.raw, checks.joints);
  const bool is_straight = path.size() == 2;
  // One step of a tree is short: it stays as it is.
  if (answer.nodes > 2 && are_ends_free(path, checks) && !(is_straight && is_proved(path, 0, 2, checks))) {
    if (is_straight) divide(path, answer.nodes - 1, checks.joints);
    const bool holds = smooth(path, drivers.guides, SLIDING_APART, false, checks);
    const double length = length_of(path.points(), checks.joints);
    if (holds && length <= (1.0 + LONGER) * answer.length) answer.path = path.points(), answer.length = length;
  }
  answer.smoothing_motions += checks.counts.motions;
  answer.smoothing_seconds += clock.seconds();
}

}  // namespace evenroad::planning
