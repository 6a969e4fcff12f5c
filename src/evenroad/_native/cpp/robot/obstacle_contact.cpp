// Sixteen obstacles at once are tested against the box around all lanes of a body, if it has many capsules, and then
// of a capsule; those that are near one by one.
#include "robot/obstacle_contact.hpp"

#include <bit>

namespace evenroad::robot {

namespace {

/// The box around a body or a capsule in all lanes: made once, when the first block of obstacles is looked at.
template <class Placed>
EVENROAD_INLINE const Box16& make_around(Placed& placed, float radius) {
  placed.around = around_all(placed.centre, abs(placed.half) + spread(Vec3{radius, radius, radius}));
  return placed.around;
}

/// Return which obstacles of a block are near a box.
EVENROAD_INLINE Mask near_obstacles(const Block& block, const Box16& around) {
  return below_zero(largest(abs(block.centre - around.centre) - block.half - around.half));
}

/// Return the mask of lanes in which the box around a body or a capsule meets that around one obstacle.
template <class Placed>
EVENROAD_INLINE Mask near_one(const Placed& placed, float radius, const Block& block, int k) {
  const Vec3x16 centre = {spread(block.centre.x[k]), spread(block.centre.y[k]), spread(block.centre.z[k])};
  const Vec3x16 half = {spread(radius + block.half.x[k]), spread(radius + block.half.y[k]),
                        spread(radius + block.half.z[k])};
  return below_zero(largest(abs(placed.centre - centre) - abs(placed.half) - half));
}

/// Return the squared distances of points, as an obstacle sees them, from it without the rounding of its edges.
EVENROAD_INLINE Floats16 squared_distance(const Obstacle& obstacle, Vec3x16 point) {
  const Floats16 zero{}, z = max(abs(point.z) - obstacle.half.z, zero);
  if (obstacle.form == Form::CYLINDER) {
    const Floats16 aside = max(sqrt(fma(point.x, point.x, point.y * point.y)) - obstacle.half.x, zero);
    return fma(aside, aside, z * z);
  }
  const Vec3x16 gap = {max(abs(point.x) - obstacle.half.x, zero), max(abs(point.y) - obstacle.half.y, zero), z};
  return dot(gap, gap);
}

/// Return the mask of lanes in which a sphere along a capsule reaches into an obstacle.
Mask meeting_one(const PlacedCapsule& capsule, std::span<const float> samples, float radius, const Obstacle& obstacle) {
  // Centre and half segment as the obstacle sees them.
  Vec3x16 centre = capsule.centre - spread(obstacle.centre), half = capsule.half;
  if (obstacle.form != Form::ALIGNED) {
    const float* r = obstacle.rotation;
    const Vec3x16 x = spread(Vec3{r[0], r[3], r[6]}), y = spread(Vec3{r[1], r[4], r[7]});
    const Vec3x16 z = spread(Vec3{r[2], r[5], r[8]});
    centre = {dot(centre, x), dot(centre, y), dot(centre, z)};
    half = {dot(half, x), dot(half, y), dot(half, z)};
  }
  const float reach = radius + obstacle.rounding;
  Mask meeting = 0;
  for (const float along : samples) {
    meeting |= below_zero(squared_distance(obstacle, plus(centre, half, spread(along))) - reach * reach);
  }
  return meeting;
}

}  // namespace

Mask meeting_obstacles(const Robot& robot, const Lengths& lengths, const Scene& scene, Places& places, Wanted wanted,
                       Contact* found) {
  Mask blocked = 0;
  const int blocks = static_cast<int>(scene.blocks.size());
  const std::span<const float> samples = robot.samples;
  // From the outermost bodies inwards: those meet obstacles most often.
  for (int b = static_cast<int>(robot.bodies.size()) - 1; b >= robot.fixed_bodies; b--) {
    const Range capsules = robot.bodies[b].capsules;
    const bool many = capsules.size() > FEW;
    for (int number = 0; number < blocks; number++) {
      const Block& block = scene.blocks[number];
      Mask near_body = ALL_LANES;
      if (many) {
        PlacedBody& body = places.bodies[b];
        near_body = 0;
        for (Mask near = near_obstacles(block, number == 0 ? make_around(body, 0) : body.around); near != 0;
             near &= near - 1) {
          const int k = std::countr_zero(near);
          if ((near_one(body, 0, block, k) & ~blocked) != 0) near_body |= 1U << k;
        }
        if (near_body == 0) continue;
      }
      for (int i = capsules.end - 1; i >= capsules.first; i--) {
        const float radius = lengths.capsules[i];
        PlacedCapsule& capsule = places.capsules[i];
        Mask near = scene.tested(i, number) & near_body;
        if (!many || std::popcount(near) > 2) {
          near &= near_obstacles(block, many || number == 0 ? make_around(capsule, radius) : capsule.around);
        }
        for (; near != 0; near &= near - 1) {
          const int k = std::countr_zero(near);
          if ((near_one(capsule, radius, block, k) & ~blocked) == 0) continue;
          const Obstacle& obstacle = scene.obstacles[number * LANES + k];
          const Range of = robot.capsules[i].samples;
          const Mask meeting = meeting_one(capsule, samples.subspan(of.first, of.size()), radius, obstacle);
          if (found != nullptr && blocked == 0 && meeting != 0) *found = {Contact::With::OBSTACLE, i, obstacle.number};
          blocked |= meeting;
          if (is_enough(blocked, wanted)) return blocked;
        }
      }
    }
  }
  return blocked;
}

}  // namespace evenroad::robot
