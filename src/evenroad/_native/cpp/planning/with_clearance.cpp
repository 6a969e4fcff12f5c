// The shortest paths touch obstacles.  The smoothing of a path that keeps away gives one that touches in a short time.
#include "planning/with_clearance.hpp"

#include <utility>

#include "space/all_distances.hpp"

namespace evenroad::planning {

namespace {

/// Each of the two smoothings is shorter than a full one, which saves half of the time for 0.2 % of the length.  Where
/// the first one ends by what its batches gain, it saves a fifteenth of both for another 0.2 %.  The second one begins
/// with the result of the first.
Sliding first_time(std::int64_t most_batches) { return {most_batches, 8, 3, 2e-4}; }
Sliding second_time(std::int64_t most_batches) { return {most_batches, 8, 2}; }

/// Largest share by which a path that keeps away from obstacles may be longer.
constexpr double LONGER = 0.02;

/// Return whether both ends of a path are free.
bool are_terminals_free(const Path& path, MotionChecks& checks) {
  for (std::size_t lane = 0; lane < LANES; lane++) {
    const ConstConfiguration end = path[lane == 0 ? 0 : path.size() - 1];
    for (std::size_t k = 0; k < end.size(); k++) checks.state(k, lane) = end[k];
  }
  return checks.touching().lanes == 0;
}

}  // namespace

double length_of(const std::vector<double>& points, const robot::Joints& joints) {
  const std::size_t dim = joints.size(), motions = points.size() / dim - 1;
  const std::vector<double> scale(dim, 1.0);
  double length = 0.0;
  for (const double each :
       space::row_distances({points.data(), motions, dim}, {points.data() + dim, motions, dim}, scale, joints.period)) {
    length += each;
  }
  return length;
}

bool smooth_with_clearance(Path& path, const Guides& guides, std::int64_t most_batches, MotionChecks& checks,
                           MotionChecks& roomier) {
  const Sliding sliding = first_time(most_batches);
  Path clear = path;
  if (path.size() < 3 || !are_terminals_free(path, roomier) || !smooth(clear, guides, sliding, false, roomier)) {
    smooth(path, guides, sliding, true, checks);
    return false;
  }
  path = std::move(clear);
  const double longest = length_of(path.points(), checks.joints) / (1.0 + LONGER);
  std::vector<double> direction(checks.joints.size());
  const double straight = write_direction(path[0], path[path.size() - 1], checks.joints, direction);
  return straight >= longest || !smooth_further(path, guides, second_time(most_batches), longest, checks);
}

}  // namespace evenroad::planning
