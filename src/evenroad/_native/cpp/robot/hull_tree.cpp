// Contact of two bodies of convex hulls in double precision: a tree over the hulls of each, and GJK below.
//
// Bodies count as separated only if a plane separates them.  Its gap is computed from all corners, so neither rounding
// nor an early end of the search calls touching bodies free.  The search is that of E. Gilbert, D. Johnson and S.
// Keerthi (1988).
#include "robot/hull_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "robot/simplex.hpp"

namespace evenroad::robot {

namespace {

constexpr int MOST_STEPS = 40;
constexpr double SAME = 1e-9;     // lengths that differ by less are equal [m]
constexpr double SURER = 2e-6;    // a search that begins with a cached plane must decide by more, in parts of a margin
constexpr double THICKER = 1e-4;  // half extents of boxes are enlarged by this [m]
constexpr int FEW_POINTS = 4;     // so few points are tested one by one, in double precision

/// Return the vector from the middle of the second node to that of the first, in the first's frame.
template <class T>
Vector between_middles(const HullNode<T>& a, const HullNode<T>& b, const RelativePose& pose) {
  Vector direction;
  for (int axis = 0; axis < 3; axis++) {
    direction[axis] = a.centre[axis] - pose.translation[axis];
    for (int entry = 0; entry < 3; entry++) direction[axis] -= pose.rotation[3 * axis + entry] * b.centre[entry];
  }
  return direction;
}

/// The extent of a leaf's hull and disc along a direction, and the farthest point.
struct Farthest {
  double along;
  Vector point;
};

/// Return by how much less than another a point found in single precision may reach along a unit direction: six
/// roundings of it.
template <class T>
double slack_of(const HullNode<T>& leaf) {
  if (leaf.blocks.size() == 0) return 0.0;
  return 8e-7 * (std::abs(leaf.centre[0]) + std::abs(leaf.centre[1]) + std::abs(leaf.centre[2]) + leaf.radius);
}

/// Return the number of a point that is farthest along a unit direction, but for a slack.
template <class T>
int farthest_of_many(const HullTree<T>& tree, const HullNode<T>& leaf, const Vector& direction) {
  const Vec3x16 along = spread(
      Vec3{static_cast<float>(direction[0]), static_cast<float>(direction[1]), static_cast<float>(direction[2])});
  Floats16 most = dot(tree.blocks[leaf.blocks.first], along);
  Ints16 block{};
  for (int i = leaf.blocks.first + 1; i < leaf.blocks.end; i++) {
    const Floats16 here = dot(tree.blocks[i], along);
    block = here > most ? Ints16{} + (i - leaf.blocks.first) : block;
    most = max(here, most);
  }
  const std::uint32_t farthest = ~below_zero(most - spread(largest(most))) & ALL_LANES;
  const int lane = std::countr_zero(farthest);
  return std::min(leaf.points.first + LANES * block[lane] + lane, leaf.points.end - 1);
}

template <class T>
Farthest farthest(const HullTree<T>& tree, const HullNode<T>& leaf, const Vector& direction) {
  double most = -std::numeric_limits<double>::infinity();
  int corner = leaf.points.first;
  if (leaf.blocks.size() > 0) {
    corner = farthest_of_many(tree, leaf, direction);
    const auto& [x, y, z] = tree.points[corner];
    most = x * direction[0] + y * direction[1] + z * direction[2];
  } else {
    for (int i = leaf.points.first; i < leaf.points.end; i++) {
      const auto& [x, y, z] = tree.points[i];
      const double along = x * direction[0] + y * direction[1] + z * direction[2];
      corner = along > most ? i : corner, most = std::max(along, most);
    }
  }
  const auto& [x, y, z] = tree.points[corner];
  Farthest found{most, {x, y, z}};
  for (int axis = 0; axis < 3; axis++) {
    const double extent = leaf.extents[axis];
    found.along += extent * std::abs(direction[axis]);
    found.point[axis] += std::copysign(extent, direction[axis]);
  }
  if (leaf.disc > 0) {
    const double upright = leaf.axis[0] * direction[0] + leaf.axis[1] * direction[1] + leaf.axis[2] * direction[2];
    Vector aside;
    for (int axis = 0; axis < 3; axis++) aside[axis] = direction[axis] - upright * leaf.axis[axis];
    const double length = std::sqrt(squared_length(aside)), share = length > 0.0 ? leaf.disc / length : 0.0;
    found.along += leaf.disc * length;
    for (int axis = 0; axis < 3; axis++) found.point[axis] += share * aside[axis];
  }
  return found;
}

/// Return the direction with which a search begins: of a plane, or about across where the boxes of both are thin.
template <class T>
Vector first_direction(const HullNode<T>& a, const HullNode<T>& b, const RelativePose& pose, const PlaneNormal& plane) {
  const double *m = pose.rotation, *normal = plane.at;
  Vector direction{};
  if (normal[0] != 0 || normal[1] != 0 || normal[2] != 0) {
    for (int axis = 0; axis < 3; axis++, m += 3)
      direction[axis] = m[0] * normal[0] + m[1] * normal[1] + m[2] * normal[2];
    return direction;
  }
  const Vector between = between_middles(a, b, pose);
  double most = 0.0;
  for (int axis = 0; axis < 3; axis++, m += 3) {
    double thick = a.half[axis] + THICKER;
    for (int entry = 0; entry < 3; entry++) thick += std::abs(m[entry]) * b.half[entry];
    direction[axis] = between[axis] / thick, most = std::max(most, std::abs(direction[axis]));
  }
  if (most == 0.0) return direction;
  // Cubes of shares of the largest: no number leaves its range.
  for (int axis = 0; axis < 3; axis++)
    direction[axis] = direction[axis] / most * (direction[axis] / most) * (direction[axis] / most);
  return direction;
}

enum class Answer : std::uint8_t { SEPARATED, NEAR, OPEN };

/// A search for a plane between two leaves.
template <class T>
struct Search {
  const HullTree<T>& tree;
  const HullNode<T>& a;
  const HullTree<T>& other;
  const HullNode<T>& b;
  const RelativePose& pose;
  PlaneNormal& plane;
  Vec3& point;
  Simplex simplex;
  Vector direction;
  double length = 0.0;
  int count = 0;  // of points that corners are made of, which are not written before they are known
  Vector firsts[MOST_STEPS + 4], others[MOST_STEPS + 4];

  Search(const HullTree<T>& tree, const HullNode<T>& a, const HullTree<T>& other, const HullNode<T>& b,
         const RelativePose& pose, PlaneNormal& plane, Vec3& point)
      : tree(tree), a(a), other(other), b(b), pose(pose), plane(plane), point(point) {}

  /// Add a corner: a point of the first less one of the second.
  void add(const Vector& p, const Vector& q) {
    firsts[count] = p, others[count] = q;
    simplex.numbers[simplex.size] = count++;
    Vector& corner = simplex.corners[simplex.size++];
    for (int axis = 0; axis < 3; axis++) {
      const double* row = pose.rotation + 3 * axis;
      const double turned = row[0] * q[0] + row[1] * q[1] + row[2] * q[2];
      corner[axis] = p[axis] - turned - pose.translation[axis];
    }
  }

  /// Set the direction from the nearest point of the corners; return whether they surround the point where the two
  /// would touch.
  bool turn() {
    nearest(simplex, direction);
    length = std::sqrt(squared_length(direction));
    return simplex.size <= 0;
  }

  void write(Ended* ended, int size) const {
    if (ended == nullptr || size == 0) return;
    ended->size = size;
    for (int i = 0; i < size; i++) {
      ended->first[i] = firsts[simplex.numbers[i]], ended->second[i] = others[simplex.numbers[i]];
    }
  }

  /// The farthest points along the direction, and the gap of a plane perpendicular to it.
  struct Across {
    Farthest p, q;
    double gap;
    Vector normal;  // in the frame of the second
  };

  Across look() const {
    const double *m = pose.rotation, *shift = pose.translation;
    const double x = direction[0] / length, y = direction[1] / length, z = direction[2] / length;
    const Vector turned_back = {m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z,
                                m[2] * x + m[5] * y + m[8] * z};
    const Farthest p = farthest(tree, a, {-x, -y, -z}), q = farthest(other, b, turned_back);
    return {p, q, -p.along - q.along - (shift[0] * x + shift[1] * y + shift[2] * z), turned_back};
  }

  Answer separated(const Across& seen) {
    for (int axis = 0; axis < 3; axis++) plane.at[axis] = seen.normal[axis];
    return Answer::SEPARATED;
  }

  /// Go on from where another search ended, but first with the plane that is given, if there is one.
  Answer go_on(double separated_by, double near_by, Ended& ended) {
    if (plane.at[0] != 0 || plane.at[1] != 0 || plane.at[2] != 0) {
      direction = first_direction(a, b, pose, plane), length = std::sqrt(squared_length(direction));
      const Across seen = look();
      if (seen.gap > separated_by) return separated(seen);
    }
    for (int i = 0; i < ended.size; i++) add(ended.first[i], ended.second[i]);
    point = {static_cast<float>(firsts[0][0]), static_cast<float>(firsts[0][1]), static_cast<float>(firsts[0][2])};
    return turn() || length <= near_by ? Answer::NEAR : steps(separated_by, near_by, &ended);
  }

  Answer go(double separated_by, double near_by, Ended* ended) {
    simplex.size = count = 0;
    direction = first_direction(a, b, pose, plane), length = std::sqrt(squared_length(direction));
    return length == 0.0 ? Answer::NEAR : steps(separated_by, near_by, ended);
  }

  Answer steps(double separated_by, double near_by, Ended* ended) {
    for (int step = 0; step < MOST_STEPS; step++) {
      const Across seen = look();
      if (seen.gap > separated_by) {
        write(ended, simplex.size);
        return separated(seen);
      }
      const Vector &p = seen.p.point, &q = seen.q.point;
      point = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
      if (simplex.size > 0 && length - seen.gap < 1e-6 * length + SAME) return Answer::OPEN;
      add(p, q);
      if (turn() || length <= near_by) {
        write(ended, simplex.size <= 0 ? 4 : simplex.size);
        return Answer::NEAR;
      }
    }
    return Answer::OPEN;
  }
};

}  // namespace

template <class T>
void HullTree<T>::take_points(HullNode<T>& leaf, Range of) {
  leaf.points = of;
  if (std::is_same_v<T, double> || leaf.points.size() <= FEW_POINTS) return;
  leaf.blocks.first = static_cast<int>(blocks.size());
  for (int i = of.first; i < of.end; i += LANES) {
    Vec3x16 block{};
    for (int lane = 0; lane < LANES; lane++) {
      const auto& [x, y, z] = points[std::min(i + lane, of.end - 1)];
      block.x[lane] = static_cast<float>(x), block.y[lane] = static_cast<float>(y);
      block.z[lane] = static_cast<float>(z);
    }
    blocks.push_back(block);
  }
  leaf.blocks.end = static_cast<int>(blocks.size());
}

template void HullTree<float>::take_points(HullNode<float>&, Range);
template void HullTree<double>::take_points(HullNode<double>&, Range);

template <class T>
HullContact find_hull_contact(const HullTree<T>& tree, int first, int second, const RelativePose& pose, double margin) {
  HullContact waiting[DEEPEST];
  waiting[0] = {first, second};
  for (int count = 1; count > 0;) {
    const auto [a, b] = waiting[--count];
    const HullNode<T>&p = tree.nodes[a], &q = tree.nodes[b];
    const Vector direction = between_middles(p, q, pose);
    const double near = p.radius + margin, other_near = q.radius + margin;
    if (squared_length(direction) > (near + q.radius) * (near + q.radius)) continue;
    // The box of the one and the ball of the other.
    double aside = 0, other_aside = 0;
    for (int axis = 0; axis < 3; axis++) {
      const double* m = pose.rotation + axis;
      const double turned = m[0] * direction[0] + m[3] * direction[1] + m[6] * direction[2];
      const double gap = std::max(std::abs(direction[axis]) - p.half[axis], 0.0);
      const double other_gap = std::max(std::abs(turned) - q.half[axis], 0.0);
      aside += gap * gap, other_aside += other_gap * other_gap;
    }
    if (aside > other_near * other_near || other_aside > near * near) continue;
    if (p.is_leaf() && q.is_leaf()) {
      PlaneNormal none;
      Vec3 nowhere;
      if (leaves_near(tree, a, tree, b, pose, margin, none, nowhere)) return {a, b};
    } else if (q.is_leaf() || (!p.is_leaf() && p.radius >= q.radius)) {
      for (int child : p.children) waiting[count++] = {child, b};
    } else {
      for (int child : q.children) waiting[count++] = {a, child};
    }
  }
  return {};
}

template <class T>
bool leaves_near(const HullTree<T>& tree, int first, const HullTree<T>& other, int second, const RelativePose& pose,
                 double margin, PlaneNormal& plane, Vec3& point, Ended* ended) {
  const HullNode<T>&a = tree.nodes[first], &b = other.nodes[second];
  margin += a.width + b.width + slack_of(a) + slack_of(b);
  Search<T> search{tree, a, other, b, pose, plane, point};
  if (ended != nullptr && ended->size > 0 && margin > 4.0 * SAME) {
    const Answer answer = search.go_on(margin * (1.0 + SURER) + 2.0 * SAME, margin - SAME, *ended);
    if (answer != Answer::OPEN) return answer == Answer::NEAR;
  }
  return search.go(margin, std::max(margin, SAME), ended) != Answer::SEPARATED;
}

#define EVENROAD_HULLS_OF(T)                                                                               \
  template HullContact find_hull_contact(const HullTree<T>&, int, int, const RelativePose&, double);       \
  template bool leaves_near(const HullTree<T>&, int, const HullTree<T>&, int, const RelativePose&, double, \
                            PlaneNormal&, Vec3&, Ended*);
EVENROAD_HULLS_OF(float)
EVENROAD_HULLS_OF(double)

}  // namespace evenroad::robot
