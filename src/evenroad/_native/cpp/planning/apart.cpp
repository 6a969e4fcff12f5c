// The shortest paths touch what they pass, so this smoothing begins again from what the trees found.
#include "planning/apart.hpp"

#include "space/all_distances.hpp"

namespace evenroad::planning {

namespace {

/// After so many batches no waypoint slides any more.
constexpr std::int64_t SLIDING_APART = 200;

/// By this share a path may be longer that keeps away from obstacles.
constexpr double LONGER = 0.02;

/// Return whether both ends of a path are free.
bool are_ends_free(const Path& path, MotionChecks& checks) {
  for (std::size_t lane = 0; lane < LANES; lane++) {
    const ConstConfiguration end = path[lane == 0 ? 0 : path.size() - 1];
    for (std::size_t k = 0; k < end.size(); k++) checks.state(k, lane) = end[k];
  }
  return checks.touching().lanes == 0;
}

}  // namespace

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

bool draw_apart(Path& path, double shortest, const Guides& guides, MotionChecks& checks) {
  return are_ends_free(path, checks) && smooth(path, guides, SLIDING_APART, false, checks) &&
         length_of(path.points(), checks.joints) <= (1.0 + LONGER) * shortest;
}

}  // namespace evenroad::planning
