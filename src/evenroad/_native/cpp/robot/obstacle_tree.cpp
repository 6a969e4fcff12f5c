// Each capsule is looked up in the grid at sixteen configurations.  In lanes with a near obstacle, the tree finds the
// obstacles, and each of these is tested once for all lanes.
#include "robot/obstacle_tree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "robot/obstacle_grid.hpp"

namespace evenroad::robot {

namespace {

/// Number of cells of the grid per obstacle, and largest number.
constexpr double CELLS_EACH = 64, MOST_CELLS = 400'000;

/// Excess width of tests that may skip others, more than all rounding errors [m].
constexpr float WIDER = 4e-6F;

/// Least depth of a contact that the grid proves, more than all rounding errors [m].
constexpr float DEEPER = 2e-5F;

/// Distance between a capsule's positions up to which lanes are tested together, in parts of its radius.
constexpr float MOST_ASIDE = 0.5F;

/// A cache of obstacles that were tested for a capsule, or decided for a body, in some lanes; lost entries are tested
/// again.
class Done {
 public:
  Done() { keys_.fill(-1); }

  /// Return the lanes of an obstacle that are done; none for a new one.
  Mask& of(int part, int obstacle) {
    const std::int64_t key = (static_cast<std::int64_t>(part) << 32) + obstacle;
    const std::size_t slot = static_cast<std::size_t>(obstacle) % keys_.size();
    if (keys_[slot] != key) keys_[slot] = key, lanes_[slot] = 0;
    return lanes_[slot];
  }

 private:
  std::array<std::int64_t, 64> keys_;
  std::array<Mask, 64> lanes_;
};

Around around_block(const Block& block) {
  std::array<Around, LANES> boxes;
  int count = 0;
  for (int k = 0; k < LANES; k++) {
    if (block.half.x[k] < 0) continue;
    Around& box = boxes[count++];
    box = {{block.centre.x[k], block.centre.y[k], block.centre.z[k]},
           {block.half.x[k], block.half.y[k], block.half.z[k]},
           0};
    box.radius = std::sqrt(box.half[0] * box.half[0] + box.half[1] * box.half[1] + box.half[2] * box.half[2]);
  }
  return around_boxes({boxes.data(), static_cast<std::size_t>(count)}, WIDER);
}

/// Return which obstacles of a block are near a capsule.
EVENROAD_INLINE Mask near_of_block(const Block& block, const CapsuleAt& capsule) {
  return near_nodes({block.centre, block.half, sqrt(dot(block.half, block.half))}, capsule);
}

/// A capsule of a body.
struct Part {
  int body, capsule;
  const PlacedCapsule& placed;
  std::span<const float> samples;
  float half, radius;  // half the length of its segment; radius of its spheres
  bool shaped;         // whether the body's true shape decides
};

/// One check: its subject, and the results so far.
struct Check {
  const Robot& robot;
  const Lengths& lengths;
  const Layer& layer;
  PlacedRobot& placed;
  Wanted wanted;
  Contact* found;
  Mask blocked;
  Done tested, decided;

  /// Return the lanes in which a capsule may touch an obstacle, and those of all lanes in which it certainly does.
  NearAndSure near_lanes(const Part& of) const {
    const ObstacleGrid& grid = layer.obstacles->tree->grid;
    const auto& [centre, along, around] = of.placed;
    const float near = of.radius + WIDER;
    // The grid proves no contact if a true shape decides, or if the obstacle must be named.
    const float touching = of.shaped || found != nullptr || !layer.all[of.capsule] ? 0 : of.radius - DEEPER;
    if (of.samples.size() > 2 && (query(grid, centre, of.half + near, 0).near & ~blocked) == 0) return {};
    NearAndSure all;
    for (const float share : of.samples) {
      const auto [may, does] = query(grid, plus(centre, along, spread(share)), near, touching);
      all.near |= may, all.sure |= does;
    }
    return all;
  }

  /// Return the lanes in which a body's true shape touches an obstacle, among those in which a capsule does.
  Mask decide(int b, int obstacle, Mask asked) {
    const Body& body = robot.bodies[b];
    const Obstacle& there = layer.obstacles->rows[obstacle];
    Mask& done = decided.of(b, obstacle);
    asked &= ~(done | blocked);
    if (asked == 0) return 0;
    done |= asked;
    const Decided decided =
        decided_by(placed.kept.of(body.shape, obstacle), {robot.shapes, body.shape, placed.frames[body.frame]},
                   {layer.obstacles->hulls, obstacle, frame_of(there)}, lengths.shapes[b], asked);
    Mask surely = decided.near;
    asked &= ~decided.separated;
    const Mask open = asked & ~with_others(decided.near, wanted);
    if (open != 0 && !is_enough(surely, wanted)) {
      surely |= inside_meeting(robot, placed, body, there, lengths.shapes[b], open, wanted);
    }
    asked &= ~with_others(surely, wanted);
    if (asked == 0 || is_enough(blocked | surely, wanted)) return surely;
    return surely | shape_meeting(robot, placed, body, *layer.obstacles, obstacle, lengths.shapes[b], asked, wanted,
                                  &placed.kept);
  }

  /// Test the obstacles of a block that may be near a capsule; return whether the check is finished.
  bool meet_block(const Part& of, int number, Mask near) {
    const Obstacles& all = *layer.obstacles;
    for (near &= layer.tested(of.capsule, number); near != 0; near &= near - 1) {
      const int obstacle = number * LANES + std::countr_zero(near);
      Mask& done = tested.of(of.capsule, obstacle);
      if (done != 0) continue;
      done = ALL_LANES;
      Mask meeting = meeting_one(of.placed, of.samples, of.radius, all.rows[obstacle], ALL_LANES & ~blocked);
      if (of.shaped && meeting != 0) meeting = decide(of.body, obstacle, meeting);
      if (meeting == 0) continue;
      if (found != nullptr && blocked == 0) *found = {Contact::With::OBSTACLE, of.capsule, all.rows[obstacle].number};
      blocked |= with_others(meeting, wanted);
      if (is_enough(blocked, wanted)) return true;
    }
    return false;
  }

  /// Test the obstacles near a capsule in some lanes, in which it lies within a capsule at `at`; return whether the
  /// check is finished.
  bool meet_near(const Part& of, const CapsuleAt& at, Mask lanes) {
    const Obstacles& all = *layer.obstacles;
    Walk walk(all.tree->boxes);
    for (int number = 0; (number = walk.next([&](const BoxNode& node) { return near_nodes(node, at); })) >= 0;) {
      if (meet_block(of, number, near_of_block(all.blocks[number], at))) return true;
      if ((lanes & ~blocked) == 0) break;
    }
    return false;
  }

  /// Test a capsule against the obstacles near it in some lanes; return whether the check is finished.
  bool meet(const Part& of, Mask lanes) {
    const auto& [centre, along, around] = of.placed;
    while ((lanes &= ~blocked) != 0) {
      const int lane = std::countr_zero(lanes);
      CapsuleAt at{lane_of(centre, lane), lane_of(along, lane), robot.capsules[of.capsule].one_by_squared,
                   of.radius + WIDER};
      Mask together = Mask{1} << lane;
      if ((lanes & (lanes - 1)) != 0) {
        // Distance of its endpoints, and so of all its points, from those of this lane.
        const Vec3x16 aside = centre - spread(at.centre), turned = along - spread(at.half);
        const Vec3x16 one = aside + turned, other = aside - turned;
        const Floats16 away = max(dot(one, one), dot(other, other));
        const float most = MOST_ASIDE * of.radius;
        const Mask close = lanes & below_zero(away - most * most);
        if (close != together) together |= close, at.reach += most;
      }
      if (meet_near(of, at, together)) return true;
      lanes &= ~together;
    }
    return false;
  }
};

}  // namespace

void sort_neighbours(std::vector<std::pair<Exact, int>>& obstacles) {
  std::vector<Point3> centres;
  centres.reserve(obstacles.size());
  for (const auto& [each, _] : obstacles) {
    centres.push_back(
        {{static_cast<float>(each.centre[0]), static_cast<float>(each.centre[1]), static_cast<float>(each.centre[2])}});
  }
  std::vector<std::pair<Exact, int>> sorted;
  for (const int k : order_of(std::move(centres))) sorted.push_back(obstacles[k]);
  obstacles = std::move(sorted);
}

std::unique_ptr<const ObstacleTree> make_obstacle_tree(const Obstacles& obstacles, double reach, double widest) {
  double low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<double>::infinity()), std::fill_n(high, 3, -low[0]);
  std::vector<std::array<double, 6>> boxes;
  for (std::size_t k = 0; k < obstacles.rows.size(); k++) {
    const Block& block = obstacles.blocks[k / LANES];
    const int lane = static_cast<int>(k % LANES);
    const Vec3 centre = lane_of(block.centre, lane), half = lane_of(block.half, lane);
    const double from[3] = {centre.x, centre.y, centre.z}, wide[3] = {half.x, half.y, half.z};
    std::array<double, 6>& box = boxes.emplace_back();
    for (int axis = 0; axis < 3; axis++) {
      box[axis] = std::clamp(from[axis] - wide[axis] - WIDER, -reach, reach);
      box[3 + axis] = std::clamp(from[axis] + wide[axis] + WIDER, -reach, reach);
      low[axis] = std::min(low[axis], box[axis]), high[axis] = std::max(high[axis], box[3 + axis]);
    }
  }
  const GridLayout layout =
      grid_layout(low, high, std::min(CELLS_EACH * static_cast<double>(boxes.size()), MOST_CELLS));
  auto tree = std::make_unique<ObstacleTree>();
  tree->grid = make_obstacle_grid(obstacles, layout, boxes, static_cast<float>(widest + layout.cell));
  std::vector<Around> leaves;
  leaves.reserve(obstacles.blocks.size());
  for (const Block& block : obstacles.blocks) leaves.push_back(around_block(block));
  tree->boxes = make_box_tree(std::move(leaves), WIDER);
  return tree;
}

Mask meeting_in_tree(const Robot& robot, const Lengths& lengths, const Layer& layer, PlacedRobot& placed, Mask blocked,
                     Wanted wanted, Contact* found) {
  Check check{robot, lengths, layer, placed, wanted, found, blocked, {}, {}};
  // From the outermost bodies inwards, because those touch obstacles most often.
  for (int b = static_cast<int>(robot.bodies.size()) - 1; b >= robot.fixed_bodies; b--) {
    const Range capsules = robot.bodies[b].capsules;
    if (capsules.size() > FEW) {
      const auto [x, y, z] = lengths.bodies[b].half;
      const float near = std::sqrt(x * x + y * y + z * z) + WIDER;
      if ((query(layer.obstacles->tree->grid, placed.bodies[b].centre, near, 0).near & ~check.blocked) == 0) continue;
    }
    const bool shaped = lengths.shapes_decide && robot.bodies[b].shape >= 0;
    for (int i = capsules.end - 1; i >= capsules.first; i--) {
      const Capsule& capsule = robot.capsules[i];
      const auto samples = std::span(robot.samples).subspan(capsule.samples.first, capsule.samples.size());
      const Part of{b, i, placed.capsules[i], samples, capsule.half_length, lengths.capsules[i], shaped};
      const auto [near, sure] = check.near_lanes(of);
      check.blocked |= with_others(sure, wanted);
      if (is_enough(check.blocked, wanted) || check.meet(of, near)) return check.blocked;
    }
  }
  return check.blocked;
}

}  // namespace evenroad::robot
