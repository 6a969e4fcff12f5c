// Sixteen states of a motion at a time, until one touches something.
#include "robot/motion_check.hpp"

#include <bit>

namespace evenroad::robot {

namespace {

/// Least number of motions for which a common batch pays.
constexpr std::size_t LEAST_AT_ONCE = 4;

/// Return whether the states of the workspace's motion from number `first` to `last` are free, or sixteen of them.
bool are_free(Workspace& workspace, int first, int last, bool sixteen_do) {
  Motion& motion = workspace.motion;
  const int count = last - first + 1;
  if (count <= 0) return true;
  const int rest = std::max(count - LANES, 0), intervals = (rest + LANES - 1) / LANES;
  const int level = std::bit_width(static_cast<unsigned>(std::max(intervals - 1, 0)));
  const double segments = std::max(motion.segments, 1);
  double numbers[LANES];
  if (rest > 0) {
    for (int lane = 0; lane < LANES; lane++) {
      const std::int64_t along = static_cast<std::int64_t>(lane) * (count - 1) / (LANES - 1);
      numbers[lane] = static_cast<double>(first + along);
    }
  } else {
    for (int lane = 0; lane < LANES; lane++) numbers[lane] = first + std::min(lane, count - 1);
  }
  motion.share = load<Doubles16>(numbers) / segments;
  motion.write_states(workspace.states);
  if (last == motion.segments) {
    // The exact endpoint, so that a motion is free only if its endpoint is.
    workspace.set(LANES - 1, motion.end);
  }
  workspace.counts.configurations += std::min(count, LANES);
  if (blocked(workspace, Wanted::FIRST) != 0) return false;
  if (rest == 0 || sixteen_do) return true;
  for (int number = 0; number < 1 << level; number++) {
    int interval = 0;
    for (int bit = 0; bit < level; bit++) interval |= (number >> bit & 1) << (level - 1 - bit);
    if (interval >= intervals) continue;
    // The r-th of these has number r + 1 + gap, where gap counts the spread ones passed since the first.
    std::int64_t gap = 0;
    for (int lane = 0; lane < LANES; lane++) {
      const std::int64_t rank = std::min(interval * LANES + lane, rest - 1);
      while ((gap + 1) * (count - 1) / (LANES - 1) - (gap + 1) <= rank) gap++;
      numbers[lane] = static_cast<double>(first + rank + 1 + gap);
    }
    motion.share = load<Doubles16>(numbers) / segments;
    workspace.counts.configurations += std::min(LANES, rest - interval * LANES);
    motion.write_states(workspace.states);
    if (blocked(workspace, Wanted::FIRST) != 0) return false;
  }
  return true;
}

/// Store a motion in the workspace.
void take(Workspace& workspace, std::span<const double> a, std::span<const double> b) {
  workspace.motion.span(a, b, workspace.checker.robot().joints, workspace.checker.resolution());
  workspace.counts.motions++;
}

}  // namespace

bool motion_free(Workspace& workspace, std::span<const double> a, std::span<const double> b, Known known) {
  take(workspace, a, b);
  const Motion& motion = workspace.motion;
  const bool first_known = known == Known::BOTH_ENDPOINTS || (known == Known::START && !motion.exchanged);
  const bool last_known = known == Known::BOTH_ENDPOINTS || (known == Known::START && motion.exchanged);
  return are_free(workspace, first_known ? 1 : 0, motion.segments - (last_known ? 1 : 0), false);
}

bool is_shortcut(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits) {
  take(workspace, a, b);
  return are_free(workspace, 1, workspace.motion.segments - 1, true) && motion_proved(workspace, a, b, limits);
}

void motions_free(const Checker& checker, Matrix<const double> a, Matrix<const double> b, double tolerance,
                  std::span<bool> free) {
  if (a.rows == 0 || checker.is_never_free()) {
    std::fill(free.begin(), free.end(), false);
    return;
  }
  // A motion that needs more batches, about ten milliseconds, is not proved; usual motions need a few.
  const ProofLimits limits{tolerance, 1 << 11};
  const Borrowed workspace = checker.borrow();
  const Robot& robot = checker.robot();
  // What is proved is free at its states, too.  But larger hulls cost so much that states come first there.
  const bool are_states_first = tolerance <= 0 || !robot.hulls.nodes.empty() || !robot.shapes.nodes.empty();
  const Joints& joints = robot.joints;
  std::vector<double> start(a.columns), end(a.columns);
  Mask proved = 0;
  for (std::size_t row = 0; row < a.rows; row++) {
    const std::size_t lane = row % LANES, left = a.rows - row;
    if (lane == 0 && tolerance > 0 && left >= LEAST_AT_ONCE) {
      proved =
          proved_at_once(*workspace, {a[row].data(), left, a.columns}, {b[row].data(), left, b.columns}, tolerance);
    } else if (lane == 0) {
      proved = 0;
    }
    free[row] = (proved >> lane & 1) != 0;
    if (free[row]) continue;
    free[row] = enter(a[row], joints, start) && enter(b[row], joints, end) &&
                (!are_states_first || motion_free(*workspace, start, end, Known::NO_ENDPOINT)) &&
                (tolerance <= 0 || motion_proved(*workspace, start, end, limits, are_states_first));
  }
}

}  // namespace evenroad::robot
