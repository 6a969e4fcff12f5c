// Distances of spheres and capsules are computed.  For other shapes only a test within a margin exists, so the margin
// is bisected, but only if the bodies around the shape are nearer than all before.
#include "robot/distance.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "robot/obstacle_distance.hpp"

namespace evenroad::robot {

namespace {

/// Largest error of a bisected distance, which is too small; nearer bodies count as touching [m].
constexpr float TOLERANCE = 1e-6F;

/// The least distances so far at sixteen configurations, and the bodies that have them.
struct Nearest {
  Floats16 least;
  std::array<Contact, LANES> contacts;

  Mask nearer(Floats16 distance) const { return below_zero(distance - least); }

  void offer(Floats16 distance, const Contact& contact) {
    for (Mask lanes = nearer(distance); lanes != 0; lanes &= lanes - 1) contacts[std::countr_zero(lanes)] = contact;
    least = min(distance, least);
  }

  /// Bisect the distance in lanes that are not nearer than `low`; `meet(near, lane)` returns a contact within a margin,
  /// or none.
  template <class Meet>
  void bisect(Mask lanes, Floats16 low, Meet&& meet) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      float near = std::max(low[lane], 0.0F), far = least[lane];
      const auto is_within = [&](float margin) {
        const Contact found = meet(margin, Mask{1} << lane);
        if (found.with != Contact::With::NOTHING) contacts[lane] = found;
        return found.with != Contact::With::NOTHING;
      };
      if (!is_within(far)) continue;
      if (is_within(near)) far = near;
      while (far - near > TOLERANCE) {
        const float middle = 0.5F * (near + far);
        (is_within(middle) ? far : near) = middle;
      }
      least[lane] = near;
    }
  }
};

/// Return the distances of a capsule from an obstacle, by the spheres that cover it.
Floats16 distance_of(const PlacedCapsule& capsule, std::span<const float> samples, float radius,
                     const Obstacle& obstacle) {
  return sqrt(squared_distance(obstacle, capsule, samples)) - (radius + obstacle.rounding);
}

void offer_obstacles(const Robot& robot, const Layer& layer, const PlacedRobot& placed, Nearest& nearest) {
  const std::span<const float> samples = robot.samples;
  for (int b = static_cast<int>(robot.bodies.size()) - 1; b >= robot.fixed_bodies; b--) {
    const Body& body = robot.bodies[b];
    for (int k = 0; k < static_cast<int>(layer.obstacles->rows.size()); k++) {
      const Obstacle& obstacle = layer.obstacles->rows[k];
      Floats16 distance = nearest.least;
      for (int i = body.capsules.first; i < body.capsules.end; i++) {
        if ((layer.tested(i, k / LANES) >> (k % LANES) & 1) == 0) continue;
        const Range of = robot.capsules[i].samples;
        distance = min(distance, distance_of(placed.capsules[i], samples.subspan(of.first, of.size()),
                                             robot.lengths.capsules[i], obstacle));
      }
      const Contact contact{Contact::With::OBSTACLE, body.capsules.first, obstacle.number};
      if (body.shape < 0) {
        nearest.offer(distance, contact);
        continue;
      }
      nearest.bisect(nearest.nearer(distance), distance, [&](float near, Mask lane) {
        near += robot.lengths.shapes[b];
        const Mask meeting = shape_meeting(robot, placed, body, *layer.obstacles, k, near, lane, Wanted::ALL);
        return meeting != 0 ? contact : Contact{};
      });
    }
  }
}

void offer_surfaces(const Robot& robot, const Scene& scene, const PlacedRobot& placed, Nearest& nearest) {
  if (scene.surfaces.empty()) return;
  nearest.bisect(ALL_LANES, Floats16{}, [&](float near, Mask lane) {
    Contact found;
    meeting_surfaces(robot, robot.lengths.enlarged(near), scene, placed, ALL_LANES & ~lane, Wanted::FIRST, &found);
    return found;
  });
}

void offer_itself(const Robot& robot, const PlacedRobot& placed, Nearest& nearest) {
  const int by_hulls = robot.first_hull_pair();
  for (int p = 0; p < static_cast<int>(robot.body_pairs.size()); p++) {
    const auto& [a, b, pairs] = robot.body_pairs[p];
    Floats16 distance = nearest.least;
    for (int k = pairs.first; k < pairs.end; k++) {
      const CapsulePair& pair = robot.pairs[k];
      const Floats16 squared = squared_distance(placed.capsules[pair.first], placed.capsules[pair.second], pair);
      distance = min(distance, sqrt(squared) - robot.lengths.pairs[k].reach);
    }
    const Contact contact{Contact::With::ITSELF, -1, pairs.first};
    if (p < by_hulls) {
      nearest.offer(distance, contact);
      continue;
    }
    const PlacedHulls first{robot.hulls, robot.bodies[a].hulls, placed.frames[robot.bodies[a].frame]};
    const PlacedHulls second{robot.hulls, robot.bodies[b].hulls, placed.frames[robot.bodies[b].frame]};
    nearest.bisect(nearest.nearer(distance), distance, [&](float near, Mask lane) {
      near += robot.lengths.hull_margins[p - by_hulls];
      return hulls_meeting(first, second, near, lane, Wanted::ALL) != 0 ? contact : Contact{};
    });
  }
}

}  // namespace

void write_distances(const Checker& checker, Matrix<const double> rows, double most, bool to_itself,
                     std::span<double> metres, std::span<Contact> nearest) {
  const Robot& robot = checker.robot();
  const Scene& scene = checker.scene();
  const Borrowed workspace = checker.borrow();
  for (std::size_t first = 0; first < rows.rows; first += LANES) {
    const std::size_t count = std::min<std::size_t>(LANES, rows.rows - first);
    const Mask outside = take_rows(*workspace, rows, first, count);
    workspace->placed.move_to(robot, robot.lengths, workspace->states);
    Nearest found{spread(static_cast<float>(most)), {}};
    offer_obstacles(robot, scene.obstacles, workspace->placed, found);
    if (scene.changed.obstacles != nullptr) offer_obstacles(robot, scene.changed, workspace->placed, found);
    if (to_itself) offer_itself(robot, workspace->placed, found);
    offer_surfaces(robot, scene, workspace->placed, found);
    for (std::size_t lane = 0; lane < count; lane++) {
      const float least = found.least[lane];
      metres[first + lane] = (outside >> lane & 1) != 0 ? std::numeric_limits<double>::quiet_NaN()
                             : least < TOLERANCE        ? 0.0
                                                        : static_cast<double>(least);
      nearest[first + lane] = found.contacts[lane];
    }
  }
}

}  // namespace evenroad::robot
