// Sixteen obstacles at once are tested against the box around all lanes of a body, if it has many capsules, and then of
// a capsule.  Obstacles that are near are tested one by one.
#include "robot/obstacle_contact.hpp"

#include <algorithm>
#include <bit>

#include "robot/obstacle_distance.hpp"
#include "robot/obstacle_tree.hpp"

namespace evenroad::robot {

namespace {

/// Number of obstacles up to which they are tested one by one, because the box around all lanes costs more than it
/// saves.
constexpr int FEW_OBSTACLES = 6;

/// Finds the obstacles that sixteen boxes are near to.
class Finder {
 public:
  explicit Finder(std::span<const RoughLimits> limits) : limits_(limits) {}

  /// Return which of some obstacles of a block are near in lanes that are not blocked; write those lanes of each.
  EVENROAD_INLINE Mask near(const RoughBoxes& boxes, int number, Mask asked, Mask blocked, Mask (&lanes)[LANES]) {
    const RoughLimits& block = limits_[number];
    if (are_together_ && std::popcount(asked) > FEW_OBSTACLES) {
      const int before = std::popcount(asked);
      asked &= within_limits(around_all(boxes), block.all);
      // In sixteen scattered configurations a body is near nearly everything: this pays in none of the others, then.
      are_together_ = 2 * std::popcount(asked) < before;
    }
    Mask met = 0;
    for (; asked != 0; asked &= asked - 1) {
      const int k = std::countr_zero(asked);
      lanes[k] = within_limits(boxes, block.each[k]);
      met |= static_cast<Mask>((lanes[k] & ~blocked) != 0) << k;
    }
    return met;
  }

 private:
  std::span<const RoughLimits> limits_;
  bool are_together_ = true;
};

constexpr int MOST_OPEN = 64;

/// A body and an obstacle whose true shapes decide, in some lanes.
struct Open {
  int body, obstacle, capsule;
  Mask lanes;
};

}  // namespace

Mask meeting_one(const PlacedCapsule& capsule, std::span<const float> samples, float radius, const Obstacle& obstacle,
                 Mask asked) {
  const float reach = radius + obstacle.rounding;
  if (static_cast<std::size_t>(std::popcount(asked)) >= samples.size()) {
    return asked & below_zero(squared_distance(obstacle, capsule, samples) - reach * reach);
  }
  // The spheres of one configuration after another.
  Mask meeting = 0;
  for (; asked != 0; asked &= asked - 1) {
    const int lane = std::countr_zero(asked);
    for (std::size_t first = 0; first < samples.size(); first += LANES) {
      // What follows the last are spheres of other capsules.
      const std::size_t count = std::min<std::size_t>(samples.size() - first, LANES);
      const Floats16 squared = squared_distances(obstacle, lane_of(capsule.centre, lane), lane_of(capsule.half, lane),
                                                 load<Floats16>(samples.data() + first));
      if ((below_zero(squared - reach * reach) & ((1U << count) - 1)) != 0) meeting |= 1U << lane;
    }
  }
  return meeting;
}

Mask inside_meeting(const Robot& robot, const PlacedRobot& placed, const Body& body, const Obstacle& obstacle,
                    float near, Mask asked, Wanted wanted) {
  const PlacedFrame& frame = placed.frames[body.frame];
  const Vec3x16 origin = frame.origin - spread(obstacle.centre);
  Mask meeting = 0;
  for (int i = body.inside.first; i < body.inside.end; i++) {
    const auto& [centre, radius] = robot.inside[i];
    const Vec3x16 here = origin + frame.turned(spread(centre));
    const float reach = radius + near + obstacle.rounding;
    meeting |= asked & below_zero(squared_distance(obstacle, here) - reach * reach);
    if (meeting == asked || is_enough(meeting, wanted)) break;
  }
  return meeting;
}

Mask shape_enclosing(const Robot& robot, const PlacedRobot& placed, const Body& body, Vec3x16 point, Mask asked) {
  if (!body.encloses) return 0;
  const PlacedFrame& frame = placed.frames[body.frame];
  const Vec3x16 here = frame.turned_back(point - frame.origin);
  Mask inside = 0;
  for (; asked != 0; asked &= asked - 1) {
    const int lane = std::countr_zero(asked);
    if (encloses(robot.shapes, body.shape, {here.x[lane], here.y[lane], here.z[lane]})) inside |= 1U << lane;
  }
  return inside;
}

Mask shape_meeting(const Robot& robot, const PlacedRobot& placed, const Body& body, const Obstacles& obstacles,
                   int number, float near, Mask asked, Wanted wanted, KeptOfPairs* kept) {
  const Obstacle& obstacle = obstacles.rows[number];
  const PlacedFrame there = frame_of(obstacle);
  const Mask meeting = hulls_meeting({robot.shapes, body.shape, placed.frames[body.frame]},
                                     {obstacles.hulls, number, there}, near, asked, wanted, kept);
  if (meeting != 0 && wanted == Wanted::FIRST) return meeting;
  // Only an obstacle smaller than the body can be inside it.
  const HullNode<float>& root = robot.shapes.nodes[body.shape];
  if (std::max({obstacle.half.x, obstacle.half.y, obstacle.half.z}) > root.radius) return meeting;
  return meeting | shape_enclosing(robot, placed, body, there.origin, asked & ~meeting);
}

namespace {

/// Return the same for the obstacles of one layer.
Mask meeting_layer(const Robot& robot, const Lengths& lengths, const Layer& layer, PlacedRobot& placed, Mask blocked,
                   Wanted wanted, Contact* found) {
  const Obstacles& all = *layer.obstacles;
  if (all.tree != nullptr) return meeting_in_tree(robot, lengths, layer, placed, blocked, wanted, found);
  const int blocks = static_cast<int>(all.blocks.size());
  const std::span<const float> samples = robot.samples;
  Open waiting[MOST_OPEN];
  int count = 0;
  Finder finder(all.limits);
  const auto decide = [&](std::span<const Open> open, Mask blocked) {
    Mask touching = 0;
    for (const auto& [b, obstacle, capsule, lanes] : open) {
      const Mask asked = lanes & ~(blocked | touching);
      if (asked == 0) continue;
      const Mask meeting =
          shape_meeting(robot, placed, robot.bodies[b], all, obstacle, lengths.shapes[b], asked, wanted, &placed.kept);
      if (found != nullptr && (blocked | touching) == 0 && meeting != 0) {
        *found = {Contact::With::OBSTACLE, capsule, layer.obstacles->rows[obstacle].number};
      }
      touching |= with_others(meeting, wanted);
      if (is_enough(blocked | touching, wanted)) break;
    }
    return touching;
  };
  // From the outermost bodies inwards, because those touch obstacles most often.
  for (int b = static_cast<int>(robot.bodies.size()) - 1; b >= robot.fixed_bodies; b--) {
    const Range capsules = robot.bodies[b].capsules;
    const bool many = capsules.size() > FEW, shaped = lengths.shapes_decide && robot.bodies[b].shape >= 0;
    for (int number = 0; number < blocks; number++) {
      Mask near_body = ALL_LANES, lanes[LANES];
      if (many) {
        PlacedBody& body = placed.bodies[b];
        if (number == 0) body.rough = rough_boxes(body.centre, body.half);
        near_body = finder.near(body.rough, number, ALL_LANES, blocked, lanes);
        if (near_body == 0) continue;
      }
      // By obstacle: lanes that the true shape must decide, and the first capsule that touches.
      Mask open[LANES], opened = 0;
      int first[LANES];
      for (int i = capsules.end - 1; i >= capsules.first; i--) {
        const float radius = lengths.capsules[i];
        PlacedCapsule& capsule = placed.capsules[i];
        if (many || number == 0) {
          capsule.rough = rough_boxes(capsule.centre, abs(capsule.half) + spread(Vec3{radius, radius, radius}));
        }
        Mask near = finder.near(capsule.rough, number, layer.tested(i, number) & near_body, blocked, lanes);
        for (; near != 0; near &= near - 1) {
          const int k = std::countr_zero(near);
          const bool again = (opened >> k & 1) != 0;
          const Mask asked = lanes[k] & ~(again ? blocked | open[k] : blocked);
          if (asked == 0) continue;
          const Obstacle& obstacle = layer.obstacles->rows[number * LANES + k];
          const Range of = robot.capsules[i].samples;
          const Mask meeting = meeting_one(capsule, samples.subspan(of.first, of.size()), radius, obstacle, asked);
          if (shaped) {
            if (meeting == 0) continue;
            if (!again) open[k] = 0, first[k] = i, opened |= 1U << k;
            open[k] |= meeting;
            continue;
          }
          if (found != nullptr && blocked == 0 && meeting != 0) *found = {Contact::With::OBSTACLE, i, obstacle.number};
          blocked |= with_others(meeting, wanted);
          if (is_enough(blocked, wanted)) return blocked;
        }
      }
      for (; opened != 0; opened &= opened - 1) {
        const int k = std::countr_zero(opened), obstacle = number * LANES + k;
        Mask asked = open[k] & ~blocked;
        if (asked == 0) continue;
        const Decided decided = decided_by(
            placed.kept.of(robot.bodies[b].shape, obstacle),
            {robot.shapes, robot.bodies[b].shape, placed.frames[robot.bodies[b].frame]},
            {layer.obstacles->hulls, obstacle, frame_of(layer.obstacles->rows[obstacle])}, lengths.shapes[b], asked);
        asked &= ~decided.separated;
        if (asked == 0) continue;
        const Mask open = asked & ~with_others(decided.near, wanted);
        Mask surely = decided.near;
        if (open != 0 && !is_enough(surely, wanted)) {
          surely |= inside_meeting(robot, placed, robot.bodies[b], layer.obstacles->rows[obstacle], lengths.shapes[b],
                                   open, wanted);
        }
        if (found != nullptr && blocked == 0 && surely != 0) {
          *found = {Contact::With::OBSTACLE, first[k], layer.obstacles->rows[obstacle].number};
        }
        blocked |= with_others(surely, wanted);
        if (is_enough(blocked, wanted)) return blocked;
        asked &= ~blocked;
        if (asked == 0) continue;
        if (count == MOST_OPEN) {
          blocked |= decide(waiting, blocked);
          if (is_enough(blocked, wanted)) return blocked;
          count = 0;
        }
        waiting[count++] = {b, obstacle, first[k], asked};
      }
    }
  }
  return blocked | decide({waiting, static_cast<std::size_t>(count)}, blocked);
}

}  // namespace

Mask meeting_obstacles(const Robot& robot, const Lengths& lengths, const Scene& scene, PlacedRobot& placed,
                       Mask blocked, Wanted wanted, Contact* found) {
  const Mask mask = meeting_layer(robot, lengths, scene.obstacles, placed, blocked, wanted, found);
  if (scene.changed.obstacles == nullptr || is_enough(mask, wanted)) return mask;
  return meeting_layer(robot, lengths, scene.changed, placed, mask, wanted, found);
}

}  // namespace evenroad::robot
