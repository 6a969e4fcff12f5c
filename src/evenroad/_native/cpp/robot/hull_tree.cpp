// Contact of two bodies of convex hulls in double precision: a tree over the hulls of each, and GJK below.
//
// Apart is only what a plane separates: its gap is computed from all corners, so no rounding, and no search that ends
// too soon, calls bodies free that touch.  The search is that of E. Gilbert, D. Johnson and S. Keerthi (1988).
#include "robot/hull_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace evenroad::robot {

namespace {

constexpr int MOST_STEPS = 40;
constexpr double SAME = 1e-9;  // lengths that differ by less are one [m]

struct Vector {
  double at[3];
  double& operator[](int axis) { return at[axis]; }
  double operator[](int axis) const { return at[axis]; }
};

double squared_length(const Vector& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Up to four points of the difference of two hulls.
struct Simplex {
  Vector corners[4];
  int size = 0;
};

double determinant(const Vector& a, const Vector& b, const Vector& c) {
  const double x = b[1] * c[2] - b[2] * c[1], y = b[2] * c[0] - b[0] * c[2], z = b[0] * c[1] - b[1] * c[0];
  return a[0] * x + a[1] * y + a[2] * z;
}

/// Return whether the origin is inside of four corners: their weights in it, up to a factor, have one sign.
bool is_inside(const Simplex& s) {
  const auto& c = s.corners;
  const double a = determinant(c[1], c[2], c[3]), b = -determinant(c[0], c[2], c[3]);
  const double d = determinant(c[0], c[1], c[3]), e = -determinant(c[0], c[1], c[2]);
  return std::min({a, b, d, e}) > 0.0 || std::max({a, b, d, e}) < 0.0;
}

/// Write the weights of a face's corners, and return whether the origin projects into it; bits say which corners.
bool projects_into(const Simplex& s, int face, double (&weights)[4]) {
  int a = -1, b = -1, c = -1;
  for (int i = 0; i < 4; i++) {
    if ((face >> i & 1) != 0) (a < 0 ? a : b < 0 ? b : c) = i;
  }
  weights[a] = 1.0;
  if (b < 0) return true;
  double ee = 0, ef = 0, ff = 0, ae = 0, af = 0;
  for (int axis = 0; axis < 3; axis++) {
    const double origin = s.corners[a][axis];
    const double e = s.corners[b][axis] - origin, f = s.corners[std::max(c, 0)][axis] - origin;
    ee += e * e, ef += e * f, ff += f * f, ae -= origin * e, af -= origin * f;
  }
  if (c < 0) {
    if (!(0.0 < ae && ae < ee)) return false;
    weights[b] = ae / ee;
    weights[a] = 1.0 - weights[b];
    return true;
  }
  const double det = ee * ff - ef * ef, second = ae * ff - af * ef, third = af * ee - ae * ef;
  if (!(second > 0.0 && third > 0.0 && second + third < det)) return false;
  weights[b] = second / det, weights[c] = third / det;
  weights[a] = 1.0 - weights[b] - weights[c];
  return true;
}

/// Keep the corners that the nearest point to the origin is between, and write that point; none where it is inside.
void nearest(Simplex& s, Vector& v) {
  if (s.size == 4 && is_inside(s)) {
    s.size = 0;
    return;
  }
  // In a corner, an edge or a side: few enough to try them all.
  int kept = 0;
  double least = std::numeric_limits<double>::infinity(), weights[4];
  for (int face = 1; face < std::min(1 << s.size, 15); face++) {
    if (!projects_into(s, face, weights)) continue;
    Vector place;
    double squared = 0;
    for (int axis = 0; axis < 3; axis++) {
      place[axis] = 0;
      for (int i = 0; i < s.size; i++) {
        if ((face >> i & 1) != 0) place[axis] += weights[i] * s.corners[i][axis];
      }
      squared += place[axis] * place[axis];
    }
    if (squared < least) least = squared, kept = face, v = place;
  }
  int count = 0;
  for (int i = 0; i < s.size; i++) {
    if ((kept >> i & 1) != 0) s.corners[count++] = s.corners[i];
  }
  s.size = count;
}

/// Return the way from the middle of the second node to that of the first, in the first's frame.
template <class T>
Vector way_between(const HullNode<T>& a, const HullNode<T>& b, const RelativePose& pose) {
  Vector way;
  for (int axis = 0; axis < 3; axis++) {
    way[axis] = a.centre[axis] - pose.translation[axis];
    for (int entry = 0; entry < 3; entry++) way[axis] -= pose.rotation[3 * axis + entry] * b.centre[entry];
  }
  return way;
}

/// How far a leaf's hull and disc reach along a direction, and the point that is farthest.
struct Farthest {
  double along;
  Vector place;
};

template <class T>
Farthest farthest(const HullTree<T>& tree, const HullNode<T>& leaf, const Vector& way) {
  double most = -std::numeric_limits<double>::infinity();
  int corner = leaf.points.first;
  for (int i = leaf.points.first; i < leaf.points.end; i++) {
    const auto& [x, y, z] = tree.points[i];
    const double along = x * way[0] + y * way[1] + z * way[2];
    if (along > most) most = along, corner = i;
  }
  const auto& [x, y, z] = tree.points[corner];
  Farthest found{most, {x, y, z}};
  if (leaf.disc > 0) {
    const double upright = leaf.axis[0] * way[0] + leaf.axis[1] * way[1] + leaf.axis[2] * way[2];
    Vector aside;
    for (int axis = 0; axis < 3; axis++) aside[axis] = way[axis] - upright * leaf.axis[axis];
    const double length = std::sqrt(squared_length(aside)), share = length > 0.0 ? leaf.disc / length : 0.0;
    found.along += leaf.disc * length;
    for (int axis = 0; axis < 3; axis++) found.place[axis] += share * aside[axis];
  }
  return found;
}

/// Return how deep the tree below each node is, leaves 1; children come after their parents.
template <class T>
int depth_of(const HullTree<T>& tree) {
  std::vector<int> depths(tree.nodes.size(), 1);
  int deepest = 0;
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const auto& node = tree.nodes[i];
    if (!node.is_leaf()) depths[i] = 1 + std::max(depths[node.children[0]], depths[node.children[1]]);
    deepest = std::max(deepest, depths[i]);
  }
  return deepest;
}

}  // namespace

template <class T>
HullTree<T> make_hull_tree(const GivenHulls& given) {
  const std::size_t count = given.boxes.size() / 8, points = given.points.size() / 3;
  if (given.children.size() != 2 * count || given.spans.size() != 2 * count) {
    throw std::invalid_argument("hulls.children and hulls.spans must be as long as hulls.boxes");
  }
  HullTree<T> tree;
  for (std::size_t i = 0; i < points; i++) {
    const double* p = given.points.data() + 3 * i;
    tree.points.push_back({static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2])});
  }
  for (std::size_t i = 0; i < count; i++) {
    const std::int64_t a = given.children[2 * i], b = given.children[2 * i + 1];
    const std::int64_t first = given.spans[2 * i], end = given.spans[2 * i + 1];
    const auto after = [&](std::int64_t child) {
      return static_cast<std::int64_t>(i) < child && child < static_cast<std::int64_t>(count);
    };
    const bool leaf = a == -1 && b == -1;
    if (!leaf && !(after(a) && after(b))) throw std::invalid_argument("hulls.children must come after their parents");
    if (leaf && !(0 <= first && first < end && end <= static_cast<std::int64_t>(points))) {
      throw std::invalid_argument("hulls.spans must lie within hulls.points");
    }
    const double* box = given.boxes.data() + 8 * i;
    HullNode<T> node{{static_cast<int>(a), static_cast<int>(b)},
                     {static_cast<int>(first), static_cast<int>(end)},
                     {},
                     {},
                     static_cast<T>(box[6]),
                     static_cast<T>(box[7]),
                     0,
                     {},
                     false};
    for (int axis = 0; axis < 3; axis++) node.centre[axis] = static_cast<T>(box[axis]);
    for (int axis = 0; axis < 3; axis++) node.half[axis] = static_cast<T>(box[3 + axis]);
    tree.nodes.push_back(node);
  }
  if (2 * depth_of(tree) > DEEPEST) throw std::invalid_argument("trees of hulls must be less deep");
  return tree;
}

template <class T>
HullContact find_hull_contact(const HullTree<T>& tree, int first, int second, const RelativePose& pose, double margin) {
  HullContact waiting[DEEPEST];
  waiting[0] = {first, second};
  for (int count = 1; count > 0;) {
    const auto [a, b] = waiting[--count];
    const HullNode<T>&p = tree.nodes[a], &q = tree.nodes[b];
    const Vector way = way_between(p, q, pose);
    const double near = p.radius + margin, other_near = q.radius + margin;
    if (squared_length(way) > (near + q.radius) * (near + q.radius)) continue;
    // The box of the one and the ball of the other.
    double aside = 0, other_aside = 0;
    for (int axis = 0; axis < 3; axis++) {
      const double* m = pose.rotation + axis;
      const double turned = m[0] * way[0] + m[3] * way[1] + m[6] * way[2];
      const double gap = std::max(std::abs(way[axis]) - p.half[axis], 0.0);
      const double other_gap = std::max(std::abs(turned) - q.half[axis], 0.0);
      aside += gap * gap, other_aside += other_gap * other_gap;
    }
    if (aside > other_near * other_near || other_aside > near * near) continue;
    if (p.is_leaf() && q.is_leaf()) {
      if (leaves_near(tree, a, tree, b, pose, margin)) return {a, b};
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
                 double margin) {
  const HullNode<T>&a = tree.nodes[first], &b = other.nodes[second];
  const double* m = pose.rotation;
  Simplex simplex;
  // The search begins with the way between the middles.
  Vector way = way_between(a, b, pose);
  double length = std::sqrt(squared_length(way));
  if (length == 0.0) return true;
  margin += a.width + b.width;
  for (int step = 0; step < MOST_STEPS; step++) {
    const double x = way[0] / length, y = way[1] / length, z = way[2] / length;
    const Farthest p = farthest(tree, a, {-x, -y, -z});
    const Farthest q = farthest(
        other, b, {m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z});
    const double gap =
        -p.along - q.along - (pose.translation[0] * x + pose.translation[1] * y + pose.translation[2] * z);
    if (gap > margin) return false;
    if (simplex.size > 0 && length - gap < 1e-6 * length + SAME) return true;
    Vector& apart = simplex.corners[simplex.size++];
    for (int axis = 0; axis < 3; axis++) {
      const double* row = m + 3 * axis;
      const double turned = row[0] * q.place[0] + row[1] * q.place[1] + row[2] * q.place[2];
      apart[axis] = p.place[axis] - turned - pose.translation[axis];
    }
    nearest(simplex, way);
    length = std::sqrt(squared_length(way));
    if (simplex.size <= 0 || length <= std::max(margin, SAME)) return true;
  }
  return true;
}

#define EVENROAD_HULLS_OF(T)                                                                         \
  template HullTree<T> make_hull_tree(const GivenHulls&);                                            \
  template HullContact find_hull_contact(const HullTree<T>&, int, int, const RelativePose&, double); \
  template bool leaves_near(const HullTree<T>&, int, const HullTree<T>&, int, const RelativePose&, double);
EVENROAD_HULLS_OF(float)
EVENROAD_HULLS_OF(double)

}  // namespace evenroad::robot
