// A surface, points or triangles, as checks read it: a grid of distances and a tree of sixteens.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/float16.hpp"
#include "robot/box_tree.hpp"
#include "robot/surface_grid.hpp"

namespace evenroad::robot {

/// Sixteen points.
struct PointLeaf {
  Vec3x16 points;
};

/// Sixteen triangles: a corner, the ways to the other two, and their unit normals, or 0 where they have none.
struct TriangleLeaf {
  Vec3x16 corner, first, second, normal;
};

struct Surface {
  DistanceGrid grid;
  std::vector<std::int8_t> windings;  // how often it winds around the middle of each cell; empty: nothing is inside
  bool turned = false;            // inside is what it winds around, or else what it winds around an odd number of times
  float radius = 0;               // by which points, or triangles, are widened
  std::vector<PointLeaf> points;  // of a cloud
  std::vector<TriangleLeaf> triangles;  // of a mesh
  std::vector<std::uint16_t> firsts;    // of a mesh: which triangles of a leaf are the first of their part
  std::vector<std::uint16_t> closed;    // of a mesh: which ones are of closed parts
  BoxTree tree;                         // over the leaves
};

/// A surface as Python gives it.
struct GivenSurface {
  std::span<const double> corners;  // (n, 1, 3) points or (n, 3, 3) triangles, a grid's cell farther than the reach
  bool triangles;
  double radius;
  std::span<const double> solid;  // (m, 3, 3): triangles of closed surfaces, however far
  bool turned;                    // whether the sides of these tell inside from outside
  double reach;                   // no queried point is farther from the origin along an axis
  std::span<const bool> first;    // of a mesh: which triangles are the first of a part, or pieces of one
  std::span<const bool> closed;   // of a mesh: which triangles are some of the solid ones, or pieces of one
};

/// Return a surface; std::invalid_argument if sizes do not fit.
Surface make_surface(const GivenSurface& given);

/// A cloud as Python gives it: points, and their pose.
struct GivenCloud {
  std::span<const double> points, rotation, xyz;  // (n, 3) [m]; (3, 3); (3,) [m]
  double radius, clearance;                       // of a ball about each, and by which that is larger [m]
  double reach;  // of the robot with that clearance: no more than this is looked at [m]
};

/// Return as a surface what of a cloud can be reached, or nothing.
std::optional<Surface> make_cloud(const GivenCloud& given);

/// Return a grid around surfaces, without leaves: a byte counts how far all of a cell is from every one.
Surface make_surface_around(std::span<const std::shared_ptr<const Surface>> surfaces);

}  // namespace evenroad::robot
