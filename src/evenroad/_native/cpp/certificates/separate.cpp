// GJK (Gilbert, Johnson, Keerthi 1988) between two nodes at both ends of a stretch.
#include "certificates/separate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evenroad::certificates {

namespace {

constexpr int MOST_ROUNDS = 60;
constexpr double NOTHING = 1e-11;  // length of a vector without a direction [m]

Vector farthest_by(const Node& node, const Vector& own, By by) {
  if (by == By::CORNERS) return node.farthest(own);
  Vector point = node.centre;
  for (const Vector& half : node.box) point = point + half * (dot(half, own) < 0.0 ? -1.0 : 1.0);
  return point;
}

struct Least {
  double along = std::numeric_limits<double>::infinity();
  Vector at{};
};

/// Find the place of the second node less that of the first one that is least along a direction, on one diagonal.
void find_least(const Moved& moved, const std::array<Screw, 2>& screws, const Vector& direction, By by, When when,
                Least& least) {
  for (int end = 0; end < (when == When::BOTH ? 2 : 1); end++) {
    const double time = when == When::MIDDLE ? 0.0 : end == 0 ? moved.half : -moved.half;
    Vector apart{};
    for (int side = 0; side < 2; side++) {
      const Moving& moving = moved.nodes[side];
      const double sign = side == 0 ? 1.0 : -1.0;
      const Screw& screw = screws[static_cast<std::size_t>(side)];
      const Vector functional = (direction + cross(direction, screw.spin) * time) * sign;
      const Vector own = farthest_by(*moving.node, as_seen(moving, functional), by);
      Vector point = placed(moving, own);
      point = point + (screw.drift + cross(screw.spin, point)) * time;
      apart = apart - point * sign;
    }
    const double along = dot(apart, direction);
    if (along < least.along) least = {along, apart};
  }
}

/// Return the same of all diagonals; in the middle all are alike.
Vector least_along(const Moved& moved, const Vector& direction, By by, When when) {
  Least least;
  find_least(moved, moved.screws(), direction, by, when, least);
  if (when == When::BOTH) {
    for (const auto& screws : moved.others) find_least(moved, screws, direction, by, when, least);
  }
  return least.at;
}

bool has(const robot::Simplex& simplex, const Vector& point) {
  for (int i = 0; i < simplex.size; i++) {
    if (squared_length(simplex.corners[i] - point) == 0.0) return true;
  }
  return false;
}

}  // namespace

Separation separate(const Moved& moved, const Vector& first, By by, When when, const Wanted& wanted) {
  constexpr double FAR = std::numeric_limits<double>::infinity();
  Separation best{{1.0, 0.0, 0.0}, -FAR, FAR};
  robot::Simplex simplex;
  Vector v = first;
  if (!(squared_length(v) > NOTHING * NOTHING)) v = {1e-9, 1e-9, 1e-9};
  for (int round = 0; round < MOST_ROUNDS; round++) {
    const double size = std::sqrt(squared_length(v));
    if (size < NOTHING) break;
    const Vector unit = v * (1.0 / size), point = least_along(moved, unit, by, when);
    const double gap = dot(point, unit);
    if (gap > best.gap) best.direction = unit, best.gap = gap;
    if (best.gap > wanted.enough || simplex.size == 4 || has(simplex, point)) break;
    if (simplex.size > 0 && size - gap < 1e-10 + wanted.error * size) break;
    simplex.corners[simplex.size++] = point;
    robot::nearest(simplex, v);
    best.most = simplex.size == 0 ? 0.0 : std::min(best.most, std::sqrt(squared_length(v)));
    if (best.most < wanted.least) break;
  }
  return best;
}

}  // namespace evenroad::certificates
