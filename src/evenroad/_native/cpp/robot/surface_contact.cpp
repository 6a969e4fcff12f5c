// The grid first, all lanes at once; then the tree, lane by lane.
#include "robot/surface_contact.hpp"

#include <bit>
#include <cmath>

#include "robot/grid_contact.hpp"
#include "robot/leaf_contact.hpp"

namespace evenroad::robot {

namespace {

/// Number of covering spheres up to which a capsule is not looked up as a whole, because that costs as much.
constexpr int FEW_SPHERES = 2;

/// A capsule in sixteen lanes: its length, and the distances of its surface and of its spheres' surface from its
/// segment.
struct Asked {
  const PlacedCapsule& capsule;
  std::span<const float> samples;
  float half, covering, slack;  // spheres are larger than the capsule by the slack
};

/// The goal of a lookup: lanes in which a capsule is near, or also those in which it certainly touches.
enum class Sought : std::uint8_t { NEAR, SURE };

/// Look up a long capsule in a grid as a whole first, then the spheres that cover it, until all open lanes are
/// known.
NearAndSure query(const Surface& surface, const Asked& of, Sought sought, Mask open) {
  const float wide = of.covering + surface.radius, reach = wide - of.slack;
  const Vec3x16 centre = of.capsule.centre, along = of.capsule.half;
  if (static_cast<int>(of.samples.size()) > FEW_SPHERES) {
    open &= query(surface.grid, centre, of.half + reach, reach).near;
    if (open == 0) return {};
  }
  NearAndSure all;
  for (const float share : of.samples) {
    const NearAndSure here = query(surface.grid, plus(centre, along, spread(share)), wide, reach);
    all.near |= here.near, all.sure |= here.sure;
    if ((open & ~(sought == Sought::NEAR ? all.near : all.sure)) == 0) break;
  }
  return all;
}

/// Return whether the box around a capsule in all lanes meets that around a leaf.
bool reaches(const Surface& surface, const PlacedCapsule& capsule, float reach) {
  const Box16 around = around_all(capsule.centre, abs(capsule.half) + spread(Vec3{reach, reach, reach}));
  const auto near = [&](const BoxNode& node) {
    return below_zero(largest(abs(node.centre - around.centre) - node.half - around.half));
  };
  return Walk(surface.tree).next(near) >= 0;
}

/// Return which points touch a capsule.
Mask near_points(Vec3x16 points, const CapsuleAt& capsule) {
  const Vec3x16 along = spread(capsule.half);
  Vec3x16 offset = points - spread(capsule.centre);
  offset = minus(offset, along, clamp(dot(offset, along) * capsule.one_by_squared, spread(-1), spread(1)));
  return below_zero(dot(offset, offset) - capsule.reach * capsule.reach);
}

/// Return whether a point or triangle touches a capsule.
bool touches(const Surface& surface, const CapsuleAt& capsule) {
  const bool is_mesh = !surface.triangles.empty();
  Walk walk(surface.tree);
  for (int leaf = 0; (leaf = walk.next([&](const BoxNode& node) { return near_nodes(node, capsule); })) >= 0;) {
    if (is_mesh) {
      if (near_triangles(surface.triangles[leaf], capsule) != 0) return true;
      continue;
    }
    if (near_points(surface.points[leaf].points, capsule) != 0) return true;
  }
  return false;
}

/// Return whether the true shape of a body touches or contains the part of a surface near a capsule.
bool shape_touches(const ShapeNear& of, const Surface& surface, const CapsuleAt& capsule, int lane) {
  ShapeAt shape(of.robot.shapes, of.body.shape, of.placed.frames[of.body.frame], lane, surface.radius, of.near);
  const bool is_mesh = !surface.triangles.empty();
  // A point is a triangle without size, and not connected to others.
  TriangleLeaf points{};
  Walk walk(surface.tree);
  const auto query = [&](const BoxNode& node) { return near_nodes(node, capsule) & shape.near(node); };
  for (int leaf = 0; (leaf = walk.next(query)) >= 0;) {
    if (!is_mesh) points.corner = surface.points[leaf].points;
    const TriangleLeaf& all = is_mesh ? surface.triangles[leaf] : points;
    const Mask near = is_mesh ? near_triangles(all, capsule) : near_points(all.corner, capsule);
    if (near == 0) continue;
    if (shape.meets(all, near)) return true;
    if (of.body.encloses && shape.encloses_corner(all, is_mesh ? near & surface.firsts[leaf] : near)) return true;
  }
  return false;
}

/// Return the first of some lanes in which a capsule touches a surface or is inside, or all if all are wanted.
Mask touching_lanes(const Surface& surface, const Asked& of, float one_by_squared, Mask near, Wanted wanted) {
  const float reach = of.covering - of.slack + surface.radius;
  const bool alone = (near & (near - 1)) == 0;
  const bool close = near != 0 && (alone || reaches(surface, of.capsule, reach));
  Mask meeting = 0;
  if (!close && surface.windings.empty()) return meeting;
  for (; near != 0; near &= near - 1) {
    const int lane = std::countr_zero(near);
    const Vec3 centre = lane_of(of.capsule.centre, lane);
    if ((close && touches(surface, {centre, lane_of(of.capsule.half, lane), one_by_squared, reach})) ||
        (!surface.windings.empty() && is_inside(surface, centre))) {
      meeting |= 1U << lane;
      if (wanted == Wanted::FIRST) return meeting;
    }
  }
  return meeting;
}

/// Return the lanes in which the grid proves a contact of a ball inside a true shape.
Mask inside_touching(const ShapeNear& of, const Surface& surface, Mask asked) {
  const PlacedFrame& frame = of.placed.frames[of.body.frame];
  Mask touching = 0;
  for (int i = of.body.inside.first; i < of.body.inside.end && (asked & ~touching) != 0; i++) {
    const auto& [centre, radius] = of.robot.inside[i];
    const float reach = radius + of.near + surface.radius;
    // The cells prove no contact of smaller balls.
    if (reach <= surface.grid.excess) continue;
    const Vec3x16 here = frame.origin + frame.turned(spread(centre));
    touching |= asked & query(surface.grid, here, 0, reach).sure;
  }
  return touching;
}

}  // namespace

Mask shape_touching(const ShapeNear& of, const Surface& surface, float reach, Mask asked, Wanted wanted) {
  Mask meeting = inside_touching(of, surface, asked);
  if (is_enough(meeting, wanted)) return meeting;
  const Capsule& capsule = of.robot.capsules[of.capsule];
  const PlacedCapsule& there = of.placed.capsules[of.capsule];
  for (Mask left = asked & ~meeting; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const CapsuleAt at{lane_of(there.centre, lane), lane_of(there.half, lane), capsule.one_by_squared, reach};
    if (!shape_touches(of, surface, at, lane)) continue;
    meeting |= 1U << lane;
    if (is_enough(meeting, wanted)) return meeting;
  }
  if (surface.windings.empty()) return meeting;
  const PlacedFrame& frame = of.placed.frames[of.body.frame];
  for (const Vec3& point : of.body.points) {
    const Vec3x16 at = frame.origin + frame.turned(spread(point));
    for (Mask left = asked & ~meeting; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      if (is_inside(surface, lane_of(at, lane))) meeting |= 1U << lane;
    }
  }
  return meeting;
}

Mask meeting_surfaces(const Robot& robot, const Lengths& lengths, const Scene& scene, const PlacedRobot& placed,
                      Mask blocked, Wanted wanted, Contact* found) {
  const std::span<const float> samples = robot.samples;
  const bool many = scene.surfaces.size() > 1;
  Mask meeting = 0;
  // From the outermost capsules inwards, because those touch most often.
  for (int i = static_cast<int>(robot.capsules.size()) - 1; i >= robot.fixed_capsules(); i--) {
    if (scene.surfaces_tested[i] == 0) continue;
    const Capsule& capsule = robot.capsules[i];
    const Body& body = robot.bodies[capsule.body];
    const bool shaped = lengths.shapes_decide && body.shape >= 0;
    const Asked of{placed.capsules[i], samples.subspan(capsule.samples.first, capsule.samples.size()),
                   capsule.half_length, lengths.capsules[i], capsule.slack};
    Mask open = ~(blocked | meeting) & ALL_LANES;
    if (scene.around != nullptr && scene.surfaces_tested[i] > 1) {
      open &= query(*scene.around, of, Sought::NEAR, open).near;
      if (open == 0) continue;
    }
    for (const SurfaceObstacle& each : scene.surfaces) {
      if (!each.tested[i]) continue;
      const Surface& surface = *each.surface;
      const float reach = of.covering - of.slack + surface.radius;
      if (many && (beside(surface.grid, of.capsule.centre, of.half + reach) & open) == 0) continue;
      const NearAndSure bounds = query(surface, of, Sought::SURE, open & ~meeting);
      Mask here = bounds.sure & ~blocked;
      if ((meeting | here) == 0 || wanted != Wanted::FIRST || shaped) {
        const Mask near = bounds.near & open & ~(blocked | meeting | bounds.sure);
        here |= touching_lanes(surface, of, capsule.one_by_squared, near, shaped ? Wanted::ALL : wanted);
      }
      if (shaped)
        here = shape_touching({robot, placed, body, i, lengths.shapes[capsule.body]}, surface, reach, here, wanted);
      if (found != nullptr && (meeting & ~blocked) == 0 && here != 0) *found = {Contact::With::SURFACE, i, each.number};
      meeting |= here;
      if (meeting != 0 && wanted == Wanted::FIRST) return meeting;
    }
    if ((blocked | meeting) == ALL_LANES) return meeting;
  }
  return meeting;
}

Contact fixed_surface_contact(const Robot& robot, const Scene& scene, const PlacedRobot& placed) {
  for (const SurfaceObstacle& each : scene.surfaces) {
    const Surface& surface = *each.surface;
    for (int i = robot.fixed_capsules() - 1; i >= 0; i--) {
      if (!each.tested[i]) continue;
      const Capsule& capsule = robot.capsules[i];
      const Vec3 centre = lane_of(placed.capsules[i].centre, 0);
      // Not enlarged: a fixed capsule is placed without rounding, and may stand on a surface that it nearly touches.
      const auto radius = static_cast<float>(robot.lengths.capsules[i] - robot.padding - capsule.slack);
      const CapsuleAt at{centre, lane_of(placed.capsules[i].half, 0), capsule.one_by_squared, radius + surface.radius};
      const Body& body = robot.bodies[capsule.body];
      const ShapeNear shape{robot, placed, body, i,
                            static_cast<float>(robot.lengths.shapes[capsule.body] - robot.padding)};
      if ((touches(surface, at) || (!surface.windings.empty() && is_inside(surface, centre))) &&
          (body.shape < 0 || shape_touching(shape, surface, at.reach, 1, Wanted::FIRST) != 0)) {
        return {Contact::With::SURFACE, i, each.number};
      }
    }
  }
  return {};
}

}  // namespace evenroad::robot
