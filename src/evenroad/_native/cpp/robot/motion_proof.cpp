// Proofs that a whole motion is free, not only its states.
//
// The method is that of evenroad.collision.certified, for sixteen intervals of a motion at once.  Every interval is
// tested in its middle, with bodies enlarged by their largest movement in half of it, and halved if the test fails.
// For short motions, as of a trajectory, sixteen motions are tried at once, each as one interval; those that fail are
// halved.
#include "robot/motion_check.hpp"

namespace evenroad::robot {

namespace {

/// Largest number of halvings of an interval, for any tolerance: its half is then less than 1e-13 of the motion.
constexpr int DEEPEST_INTERVAL = 40;

/// Movement in an interval above which capsules alone decide [m].  Shapes are then rarely free if capsules are not, and
/// two halves cost less than a test of shapes.
constexpr double COARSE = 0.005;

/// Motions that move no body by more than twice this are tried sixteen at once [m].
constexpr double SHORT = 0.02;

/// Largest number of halvings of each of these, before it is proved separately.
constexpr int HALVED = 3;

/// Factor that makes sums in single precision no less than the true ones.
constexpr float UP = 1.0F + 3e-7F;

/// Return a length in single precision that is no less than the sum of two [m].
float wider(float length, double margin) { return (length + static_cast<float>(margin)) * UP; }

double fastest_in(std::span<const double> speeds, Range range) {
  double most = 0;
  for (int i = range.first; i < range.end; i++) most = std::max(most, speeds[i]);
  return most;
}

/// Write all lengths of a test, enlarged by the largest movement of bodies in `half` of the motion.
void enlarge(Workspace& workspace, double half) {
  const Robot& robot = workspace.checker.robot();
  const Lengths& from = *workspace.lengths;
  Lengths& into = workspace.enlarged;
  const std::vector<double>&speeds = workspace.speeds.capsules, &pair_speeds = workspace.speeds.pairs;
  for (std::size_t i = 0; i < from.capsules.size(); i++) into.capsules[i] = wider(from.capsules[i], half * speeds[i]);
  // The ball around a body moves no farther than the fastest of its capsules.
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

/// A piece of one of many motions, and the position of its middle, as a share of it.
struct Piece {
  std::size_t row;
  double centre;
};

}  // namespace

bool motion_proved(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits,
                   bool are_states_free) {
  const Robot& robot = workspace.checker.robot();
  Motion& motion = workspace.motion;
  motion.span(a, b, robot.joints, workspace.checker.resolution());
  workspace.counts.motions++;
  workspace.speeds.take_anywhere(robot, motion.direction);
  double fastest = 0;
  std::vector<Interval>& waiting = workspace.waiting;
  int count = LANES, enlarged_for = -1;
  // The first interval is pushed last, so that it is tested first.
  for (int lane = 0; lane < LANES; lane++) waiting[lane] = {1.0 - (lane + 0.5) / LANES, 0};
  double half = 0;
  for (int batch = 0; batch < limits.most_batches; batch++) {
    const int level = waiting[count - 1].level;
    int taken = 0;
    double shares[LANES];
    for (; taken < LANES && taken < count && waiting[count - 1 - taken].level == level; taken++) {
      shares[taken] = waiting[count - 1 - taken].centre;
    }
    for (int lane = taken; lane < LANES; lane++) shares[lane] = shares[taken - 1];
    motion.share = load<Doubles16>(shares);
    motion.write_states(workspace.states);
    workspace.placed.move_to(robot, workspace.enlarged, workspace.states);
    workspace.counts.configurations += taken;
    if (level != enlarged_for) {
      half = 0.5 / static_cast<double>(std::int64_t{LANES} << level);
      if (batch == 0) {
        // These intervals are the whole motion.
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
    // Every second level, as most motions are proved before, and the poses are known.
    if (!are_states_free && near != 0 && level % 2 == 0 && blocked_where_placed(workspace, Wanted::FIRST) != 0) {
      return false;
    }
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
    // If any motion is long, it is nearly always the first.
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
        // Unused lanes repeat the last piece.
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
        // The other pieces of a motion that is given up do not matter.
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
