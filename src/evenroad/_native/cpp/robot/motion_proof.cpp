// Proofs that a motion is free throughout, not at states alone.
//
// The method is that of evenroad.collision.certified, for sixteen stretches of a motion at once: every stretch is
// tested in its middle with bodies enlarged by what half of the stretch can move them, and halved where that fails.  Of
// many short motions, as of a trajectory, sixteen are tried at once, each as one stretch, and what fails is halved.
#include "robot/motion_check.hpp"

namespace evenroad::robot {

namespace {

/// A stretch is halved no more often, whatever the tolerance: its half is then less than 1e-13 of the motion.
constexpr int DEEPEST_INTERVAL = 40;

/// Where stretches move something by more than that, capsules alone decide [m]: shapes are rarely free where they are
/// not, and two halves cost less than to ask these.
constexpr double COARSE = 0.005;

/// Motions that move nothing by more than twice that are tried sixteen at once [m].
constexpr double SHORT = 0.02;

/// Each of these is halved so often at most, before it is looked at by itself.
constexpr int HALVED = 3;

/// What sums of single precision are multiplied by to be no less than the true ones.
constexpr float UP = 1.0F + 3e-7F;

/// Return a length of single precision that is no less than the sum of the two [m].
float wider(float length, double margin) { return (length + static_cast<float>(margin)) * UP; }

double fastest_in(std::span<const double> speeds, Range range) {
  double most = 0;
  for (int i = range.first; i < range.end; i++) most = std::max(most, speeds[i]);
  return most;
}

/// Write lengths that are larger by what `half` of the motion can move the bodies: all that a test is decided by.
void enlarge(Workspace& workspace, double half) {
  const Robot& robot = workspace.checker.robot();
  const Lengths& from = *workspace.lengths;
  Lengths& into = workspace.enlarged;
  const std::vector<double>&speeds = workspace.speeds.capsules, &pair_speeds = workspace.speeds.pairs;
  for (std::size_t i = 0; i < from.capsules.size(); i++) into.capsules[i] = wider(from.capsules[i], half * speeds[i]);
  // What is around a body moves no farther than the fastest of its capsules.
  for (std::size_t b = 0; b < robot.bodies.size(); b++) {
    into.shapes[b] = wider(from.shapes[b], half * workspace.speeds.shapes[b]);
    const double margin = half * fastest_in(speeds, robot.bodies[b].capsules);
    const auto& [radius, extents] = from.bodies[b];
    into.bodies[b] = {wider(radius, margin),
                      {wider(extents.x, margin), wider(extents.y, margin), wider(extents.z, margin)}};
  }
  const std::size_t pairs = from.pairs.size();
  for (std::size_t pair = 0; pair < pairs; pair++) {
    const double margin = half * pair_speeds[pair];
    into.pairs[pair] = {wider(from.pairs[pair].near, margin), wider(from.pairs[pair].reach, margin)};
  }
  for (std::size_t p = 0; p < robot.body_pairs.size(); p++) {
    into.body_pairs[p] = wider(from.body_pairs[p], half * fastest_in(pair_speeds, robot.body_pairs[p].pairs));
  }
  for (std::size_t p = 0; p < from.hull_margins.size(); p++) {
    into.hull_margins[p] = wider(from.hull_margins[p], half * pair_speeds[pairs + p]);
  }
}

/// A piece of one of many motions, and where its middle is, as a share of it.
struct Piece {
  std::size_t row;
  double centre;
};

}  // namespace

bool motion_proved(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits) {
  const Robot& robot = workspace.checker.robot();
  Motion& motion = workspace.motion;
  motion.span(a, b, robot.joints, workspace.checker.resolution());
  workspace.counts.motions++;
  workspace.speeds.take_anywhere(robot, motion.direction);
  double fastest = 0;
  std::vector<Interval>& waiting = workspace.waiting;
  int count = LANES, enlarged_for = -1;
  // The first stretch is the last to be pushed and the first to be looked at.
  for (int lane = 0; lane < LANES; lane++) waiting[lane] = {1.0 - (lane + 0.5) / LANES, 0};
  double half = 0;
  for (int batch = 0; batch < limits.most_batches; batch++) {
    const int level = waiting[count - 1].level;
    int taken = 0;
    for (; taken < LANES && taken < count && waiting[count - 1 - taken].level == level; taken++) {
      motion.share[taken] = waiting[count - 1 - taken].centre;
    }
    for (int lane = taken; lane < LANES; lane++) motion.share[lane] = motion.share[taken - 1];
    motion.write_states(workspace.states);
    workspace.placed.move_to(robot, workspace.enlarged, workspace.states);
    workspace.counts.configurations += taken;
    if (level != enlarged_for) {
      half = 0.5 / static_cast<double>(std::int64_t{LANES} << level);
      if (batch == 0) {
        // These stretches are the whole motion.
        for (std::size_t k = 0; k < motion.direction.size(); k++) {
          workspace.speeds.directions[k] = spread(static_cast<float>(motion.direction[k]));
        }
        workspace.speeds.take_here(robot, workspace.placed, motion.direction, half);
        fastest = workspace.speeds.fastest();
      }
      enlarge(workspace, half);
      workspace.enlarged.shapes_decide = half * fastest < std::max(COARSE, 2.0 * limits.tolerance);
      enlarged_for = level;
      workspace.placed.write_boxes(robot, workspace.enlarged);
    }
    const Mask near = blocked_where_placed(workspace, workspace.enlarged, Wanted::ALL) & ((1U << taken) - 1);
    count -= taken;
    const bool is_halvable =
        half * fastest >= limits.tolerance && level < DEEPEST_INTERVAL && count + 2 * LANES <= MOST_WAITING;
    if (near != 0 && !is_halvable) return false;
    for (int lane = taken - 1; lane >= 0; lane--) {
      if ((near >> lane & 1) == 0) continue;
      for (const double side : {0.5, -0.5}) waiting[count++] = {motion.share[lane] + side * half, level + 1};
    }
    if (count == 0) return true;
  }
  return false;
}

Mask proved_at_once(Workspace& workspace, Matrix<const double> a, Matrix<const double> b, double tolerance) {
  const Robot& robot = workspace.checker.robot();
  const std::size_t count = std::min<std::size_t>(a.rows, LANES), dim = a.columns;
  OwnMatrix<double> starts(count, dim), directions(count, dim);
  std::vector<double> end(dim), longest(dim);
  Mask proved = 0;
  Speeds& speeds = workspace.speeds;
  double whole = 0;
  for (std::size_t row = 0; row < count; row++) {
    if (enter(a[row], robot.joints, starts[row]) && enter(b[row], robot.joints, end)) proved |= 1U << row;
    write_direction(starts[row], end, robot.joints, directions[row]);
    for (std::size_t k = 0; k < dim; k++) longest[k] = std::max(longest[k], std::abs(directions(row, k)));
    // Of long motions nearly always the first is long.
    if (row > 0 && row + 1 < count) continue;
    speeds.take_anywhere(robot, longest);
    whole = speeds.fastest();
    if (0.5 * whole > SHORT) return 0;
  }
  std::vector<Piece> pieces, halves;
  for (std::size_t row = 0; row < count; row++) pieces.push_back({row, 0.5});
  for (int level = 0; level <= HALVED && !pieces.empty(); level++) {
    const double half = 0.5 / (1 << level);
    halves.clear();
    for (std::size_t first = 0; first < pieces.size(); first += LANES) {
      const std::size_t some = std::min<std::size_t>(LANES, pieces.size() - first);
      for (std::size_t lane = 0; lane < LANES; lane++) {
        // Lanes to spare repeat the last piece.
        const auto [row, centre] = pieces[first + std::min(lane, some - 1)];
        for (std::size_t k = 0; k < dim; k++) {
          workspace.states[k][static_cast<int>(lane)] = starts(row, k) + centre * directions(row, k);
          if (level == 0) speeds.directions[k][static_cast<int>(lane)] = static_cast<float>(directions(row, k));
        }
      }
      workspace.placed.move_to(robot, workspace.enlarged, workspace.states);
      if (first == 0) {
        if (level == 0) {
          speeds.take_here(robot, workspace.placed, longest, half);
          whole = speeds.fastest();
        }
        enlarge(workspace, half);
        workspace.enlarged.shapes_decide = half * whole < std::max(COARSE, 2.0 * tolerance);
        workspace.placed.write_boxes(robot, workspace.enlarged);
      }
      const Mask near = blocked_where_placed(workspace, workspace.enlarged, Wanted::ALL);
      for (std::size_t lane = 0; lane < some; lane++) {
        const auto [row, centre] = pieces[first + lane];
        // Of one that is given up, the other pieces do not matter.
        if ((near >> lane & 1) == 0 || (proved >> row & 1) == 0) continue;
        if (level == HALVED) proved &= ~(1U << row);
        for (const double side : {-0.5, 0.5}) halves.push_back({row, centre + side * half});
      }
    }
    std::swap(pieces, halves);
  }
  return proved;
}

}  // namespace evenroad::robot
