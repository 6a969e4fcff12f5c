// A bend passes beside the middle of a motion, at the distance of two of its states.
#include "planning/path_proof.hpp"

#include <vector>

namespace evenroad::planning {

namespace {

/// Largest number of bent motions of a path, and number of points to try for the middle waypoint; about half of them
/// succeed.
constexpr int MOST_BENT = 2;
constexpr std::size_t BENDS = 8;

bool is_free_with_margin(ConstConfiguration a, ConstConfiguration there, ConstConfiguration b, double margin,
                         MotionChecks& checks) {
  checks.keep_away(margin);
  const bool is_free = checks.is_free(a, there, Known::NO_ENDPOINT) && checks.is_free(there, b, Known::BOTH_ENDPOINTS);
  checks.keep_away(0.0);
  return is_free;
}

/// Write a waypoint with proved motions on both sides; return whether there is one.
bool write_bend(ConstConfiguration a, ConstConfiguration b, double margin, Matrix<const double> directions,
                MotionChecks& checks, Configuration there) {
  std::vector<double> whole(a.size());
  for (std::size_t number = 0; number < BENDS; number++) {
    write_direction(a, b, checks.joints, whole);
    const ConstConfiguration direction = directions[number % directions.rows];
    for (std::size_t k = 0; k < a.size(); k++) there[k] = a[k] + 0.5 * whole[k] + checks.resolution * direction[k];
    const bool is_within = enter(there, checks.joints);
    bring_inside(there, checks.joints);
    if (is_within && is_free_with_margin(a, there, b, margin, checks) && checks.is_proved(a, there, PATH_PROOF) &&
        checks.is_proved(there, b, PATH_PROOF)) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool is_proved(const Path& path, std::size_t first, std::size_t last, MotionChecks& checks) {
  for (std::size_t i = first; i + 1 < last; i++) {
    if (!checks.is_proved(path[i], path[i + 1], PATH_PROOF)) return false;
  }
  return true;
}

bool prove_or_bend(Path& path, double margin, Matrix<const double> directions, MotionChecks& checks) {
  std::vector<double> there(checks.joints.size());
  int bent = 0;
  for (std::size_t i = 0; i + 1 < path.size(); i++) {
    if (checks.is_proved(path[i], path[i + 1], PATH_PROOF)) continue;
    if (bent == MOST_BENT || !write_bend(path[i], path[i + 1], margin, directions, checks, there)) return false;
    path.insert(i + 1, there);
    // Both of its motions are proved.
    bent++, i++;
  }
  return true;
}

}  // namespace evenroad::planning
