// Obstacles in the form of checks: boxes, cylinders, spheres and capsules, and surfaces (clouds and meshes).
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "robot/hull_contact.hpp"
#include "robot/rough_boxes.hpp"
#include "robot/surface.hpp"

namespace evenroad::robot {

enum class Form : std::uint8_t {
  ALIGNED,  // a box along the axes with its edges rounded; also a sphere
  ROTATED,  // such a box, turned
  CYLINDER,
};

/// All points within `rounding` of a box or a cylinder, whose radius is in the first two half extents.
struct Obstacle {
  Form form;
  int number;  // in the scene, of those that are neither clouds nor meshes
  Vec3 centre, half;
  float rotation[9];  // to the root's frame
  float rounding;
};

/// Return the pose of an obstacle's frame, the same in all lanes.
PlacedFrame frame_of(const Obstacle& obstacle);

/// Boxes around sixteen obstacles.
struct Block {
  Vec3x16 centre, half;
};

/// A byte for each cell: the distance of its middle from the nearest obstacle, rounded, in units of `step`.
struct ObstacleGrid {
  int cells[3] = {0, 0, 0};
  Vec3 low, size;  // lower corner, and extents
  float one_by_cell = 0, cell = 0, step = 0;
  float exact = 0;  // distances above this are only lower bounds
  std::vector<std::uint8_t> distances;
};

/// The index of many obstacles: a grid of distances, and a tree whose leaves are the blocks.
struct ObstacleTree {
  ObstacleGrid grid;
  BoxTree boxes;
};

/// Obstacles in blocks of sixteen.
struct Obstacles {
  std::vector<Obstacle> rows;
  HullTree<float> hulls;  // a leaf for each, in its frame
  std::vector<Block> blocks;
  std::vector<RoughLimits> limits;           // the same boxes in whole numbers
  std::vector<int> row_of;                   // by number in the scene, -1 for none
  std::unique_ptr<const ObstacleTree> tree;  // if there are many
};

/// An obstacle in the form of Python, sixteen doubles.
struct GivenObstacle {
  double kind;     // as below
  double size[3];  // full extents of a box; radius and length without caps for the others [m]
  double rotation[9], translation[3];
  double clearance;  // enlargement, with rounded edges [m]
};
enum class GivenKind : std::uint8_t { BOX, SPHERE, CYLINDER, CAPSULE };

/// A surface among the obstacles.
struct SurfaceObstacle {
  std::shared_ptr<const Surface> surface;
  int number;                // in the scene
  std::vector<bool> tested;  // capsules that are tested against it
};

/// Obstacles, and those that each capsule is tested against: (capsules, blocks), a bit for each obstacle.
struct Layer {
  std::shared_ptr<const Obstacles> obstacles;
  OwnMatrix<std::uint16_t> tested{0, 0};
  std::vector<bool> all;  // by capsule: whether it is tested against every one
};

struct Scene {
  Layer obstacles;  // those that the robot can reach
  Layer changed;    // later ones; no capsule is tested against the obstacles that they replace
  std::vector<SurfaceObstacle> surfaces;
  std::vector<int> surfaces_tested;           // by capsule: number of surfaces
  std::shared_ptr<const Surface> around;      // a grid around all surfaces, or none
  double added = 0;                           // largest enlargement of obstacles for rounding [m]
  int too_far = -1;                           // the first obstacle that is too far or too large for single precision
  std::pair<int, int> fixed_contact{-1, -1};  // a capsule that does not move, and an obstacle that it touches
};

/// Obstacles with their numbers, and the capsules that are tested against them: (capsules, obstacles).
struct GivenObstacles {
  std::span<const GivenObstacle> rows;
  std::span<const std::int64_t> numbers;
  Matrix<const bool> tested;

  int number(int row) const { return static_cast<int>(numbers[row]); }
};

/// Return a scene without obstacles of some numbers and with new ones; nothing if the whole scene must be rebuilt.
/// Unchanged parts are shared.
std::optional<Scene> change_scene(const Robot& robot, const Scene& before, std::span<const std::int64_t> gone,
                                  const GivenObstacles& come, double clearance);

/// Return the scene of a robot whose bodies are larger by `clearance`; `tested` is (capsules, obstacles).
Scene make_scene(const Robot& robot, std::span<const GivenObstacle> obstacles, Matrix<const bool> tested,
                 double clearance);

}  // namespace evenroad::robot
