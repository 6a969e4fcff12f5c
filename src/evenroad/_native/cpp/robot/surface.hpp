// A surface of points or triangles in the form of checks: a grid of distances and a tree of sixteens.
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

/// Sixteen triangles: a corner, the vectors to the other two, and unit normals, or 0 if they have none.
struct TriangleLeaf {
  Vec3x16 corner, first, second, normal;
};

struct Surface {
  DistanceGrid grid;
  std::vector<std::int8_t> windings;    // winding number around the middle of each cell; empty: nothing is inside
  bool turned = false;                  // inside are points of any winding number, or else of an odd one
  float radius = 0;                     // width of points or triangles
  std::vector<PointLeaf> points;        // of a cloud
  std::vector<TriangleLeaf> triangles;  // of a mesh
  std::vector<std::uint16_t> firsts;    // of a mesh: which triangles of a leaf are the first of their part
  std::vector<std::uint16_t> closed;    // of a mesh: which ones are of closed parts
  BoxTree tree;                         // over the leaves
};

/// A surface in the form of Python.
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

/// A cloud in the form of Python: points, and their pose.
struct GivenCloud {
  std::span<const double> points, rotation, xyz;  // (n, 3) [m]; (3, 3); (3,) [m]
  double radius, clearance;                       // of a ball about each point, and its enlargement [m]
  double reach;                                   // of the robot with that clearance; farther points are ignored [m]
};

/// Return the reachable part of a cloud as a surface, or nothing.
std::optional<Surface> make_cloud(const GivenCloud& given);

/// Return a grid around surfaces, without leaves: a byte is the distance of a whole cell from all of them.
Surface make_surface_around(std::span<const std::shared_ptr<const Surface>> surfaces);

}  // namespace evenroad::robot
