// Trees of balls and boxes over convex hulls: one tree for each body, in its frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/float16.hpp"
#include "robot/simplex.hpp"

namespace evenroad::robot {

/// A range from a first number to one before an end.
struct Range {
  int first = 0, end = 0;
  int size() const { return end - first; }
};

template <class T>
struct HullPoint {
  T x, y, z;
};

template <class T>
struct HullNode {
  int children[2] = {-1, -1};  // -1 twice for a leaf
  Range points;                // of a leaf's hull, or of a hull around everything below, if there is one
  Range blocks;                // blocks of sixteen of these points, if there are many
  T centre[3] = {0, 0, 0}, half[3] = {0, 0, 0};
  T radius = 0;  // of a ball about the same centre
  T width = 0;   // by how much a leaf's hull is widened
  // A leaf's hull is also widened by a disc of this radius, perpendicular to an axis: a segment becomes a cylinder.
  T disc = 0, axis[3] = {0, 0, 0};
  // It is also widened by a box along the axes: an obstacle is a widened point.
  T extents[3] = {0, 0, 0};
  bool encloses =
      false;  // whether a leaf is a triangle of a closed surface, which has its inside to the left of its turn
  bool is_leaf() const { return children[0] < 0; }
};

template <class T>
struct HullTree {
  std::vector<HullNode<T>> nodes;
  std::vector<int> parts;  // of each node that is a leaf, which part it is
  std::vector<HullPoint<T>> points;
  std::vector<Vec3x16> blocks;  // points again, the last of a leaf repeated: of trees in single precision alone

  /// Let a leaf have some of the points.
  void take_points(HullNode<T>& leaf, Range of);
};

/// Convex parts with the names of Python.  A part is the hull of its points, widened by a ball and by a disc.
struct GivenParts {
  std::span<const std::int64_t> first_point;  // of each part, then the number of points
  std::span<const double> points;             // (points, 3)
  std::span<const double> widths;             // of the balls
  std::span<const double> discs;              // (parts, 3): the axis, as long as the disc's radius; or none
  std::span<const bool> enclosing;            // whether it is a triangle of a closed surface; or none is
};

/// Bodies of hulls as Python names them.
struct GivenHulls {
  std::span<const std::int64_t> first_part;  // of each body, then the number of parts
  GivenParts parts;
};

/// Pairs of nodes that may wait: at most the depths of both trees together.
constexpr int DEEPEST = 96;

/// Add a tree over parts, and return its root; std::invalid_argument if sizes do not fit, or there are no parts.
template <class T>
int add_parts(HullTree<T>& tree, const GivenParts& given, Range parts);

/// Add a tree for each body, and return their roots; std::invalid_argument as add_parts.
template <class T>
std::vector<int> add_trees(HullTree<T>& tree, const GivenHulls& given);

/// Let a root have a hull of some points around it, within whose width all leaves lie.
void add_around(HullTree<float>& tree, int root, std::span<const double> points, Range of, double width);

/// Return a point of every leaf below a root, but one alone of those that share corners.
std::vector<Vec3> points_of_parts(const HullTree<float>& tree, int root);

/// Return whether closed surfaces below a root go around a point in the body's frame, or it is uncertain whether one
/// does.
bool encloses(const HullTree<float>& tree, int root, const Vector& point);

/// The pose of one body in the frame of another: rotation row by row, translation.
struct RelativePose {
  double rotation[9], translation[3];
};

/// Two nodes, leaves, that touch; -1 twice for none.
struct HullContact {
  int first = -1, second = -1;
};

/// Return two hulls, below these roots, that come nearer than `margin` [m].
template <class T>
HullContact find_hull_contact(const HullTree<T>& tree, int first, int second, const RelativePose& pose, double margin);

/// The normal of a plane, in the frame of the second body; 0 where none is known.
struct PlaneNormal {
  double at[3] = {0, 0, 0};
};

/// Return whether two leaves, each of a tree, come within a margin; only a plane separates them.  The search begins
/// with a plane, if one is given.  It writes the plane that separates the leaves, or else a point of the first that is
/// nearly nearest to the second.  It continues from the end of an earlier search of these leaves, if that is given, and
/// writes its own end.  If that decides by less than rounding errors, the search starts from the beginning.
template <class T>
bool leaves_near(const HullTree<T>& tree, int first, const HullTree<T>& other, int second, const RelativePose& pose,
                 double margin, PlaneNormal& plane, Vec3& point, Ended* ended = nullptr);

}  // namespace evenroad::robot
