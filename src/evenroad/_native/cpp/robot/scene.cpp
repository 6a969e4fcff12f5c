// A scene's obstacles for one robot: those in its reach, boxes around sixteen of them, and who is tested against which.
#include "robot/scene.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robot/exact_obstacle.hpp"
#include "robot/obstacle_contact.hpp"
#include "robot/obstacle_tree.hpp"

namespace evenroad::robot {

namespace {

constexpr double STANDS = 2e-6;  // a base may reach so deep into what it stands on [m]
/// Return whether the true shape of a body that does not move touches an obstacle, which is a little smaller then: a
/// base that stands on a table does not.
bool base_touches(const Robot& robot, const Places& places, const Body& body, Exact o, double margin) {
  double extents[3];
  write_extents(o, extents);
  const double less = STANDS + 2.0 * OBSTACLE_PADDING *
                                   std::hypot(std::abs(o.centre[0]) + extents[0], std::abs(o.centre[1]) + extents[1],
                                              std::abs(o.centre[2]) + extents[2]);
  if (o.rounding > 0) {
    o.rounding = std::max(o.rounding - less, 0.0);
  } else {
    for (double& half : o.half) half = std::max(half - less, 0.0);
  }
  auto one = std::make_shared<Obstacles>();
  add(*one, o, 0);
  Scene alone;
  alone.obstacles = std::move(one);
  return shape_meeting(robot, places, body, alone, 0, static_cast<float>(margin), 1, Wanted::FIRST) != 0;
}

}  // namespace

PlacedFrame placed(const Obstacle& obstacle) {
  const float* r = obstacle.rotation;
  return {{spread(Vec3{r[0], r[1], r[2]}), spread(Vec3{r[3], r[4], r[5]}), spread(Vec3{r[6], r[7], r[8]})},
          spread(obstacle.centre)};
}

Scene make_scene(const Robot& robot, std::span<const GivenObstacle> obstacles, Matrix<const bool> tested,
                 double clearance) {
  if (tested.rows != robot.capsules.size() || tested.columns != obstacles.size()) {
    throw std::invalid_argument("tested must have a row for each capsule and a column for each obstacle");
  }
  Scene scene;
  std::vector<Exact> kept;
  std::vector<int> numbers;
  const double reach = robot.reach + clearance, origin[3] = {0, 0, 0};
  for (std::size_t k = 0; k < obstacles.size(); k++) {
    if (!(obstacles[k].kind >= 0 && obstacles[k].kind < 4))
      throw std::invalid_argument("there are four kinds of obstacles");
    if (scene.too_far < 0 && is_too_far(obstacles[k])) scene.too_far = static_cast<int>(k);
    const Exact obstacle = exact(obstacles[k], reach);
    const double far = reach + obstacle.rounding;
    if (!(squared_distance(obstacle, origin) <= far * far)) continue;
    kept.push_back(obstacle);
    numbers.push_back(static_cast<int>(k));
  }
  const bool many = static_cast<int>(kept.size()) >= MANY_OBSTACLES;
  if (many) sort_neighbours(kept, numbers);
  auto all = std::make_shared<Obstacles>();
  for (std::size_t k = 0; k < kept.size(); k++) scene.added = std::max(scene.added, add(*all, kept[k], numbers[k]));
  if (many) all->tree = make_obstacle_tree(*all, reach);
  scene.tested = OwnMatrix<std::uint16_t>(tested.rows, all->blocks.size());
  for (std::size_t i = 0; i < tested.rows; i++) {
    for (std::size_t k = 0; k < kept.size(); k++) {
      if (tested(i, numbers[k])) scene.tested(i, k / LANES) |= static_cast<std::uint16_t>(1U << (k % LANES));
    }
  }
  scene.obstacles = std::move(all);
  const Places places(robot);
  for (const FixedSphere& sphere : robot.fixed_spheres) {
    for (std::size_t k = 0; k < kept.size() && scene.fixed_contact.first < 0; k++) {
      // Without a clearance: what does not move cannot keep away.
      const double near = sphere.radius + kept[k].rounding;
      if (!tested(sphere.capsule, numbers[k])) continue;
      const Capsule& capsule = robot.capsules[sphere.capsule];
      if (squared_distance(kept[k], sphere.centre) < near * near &&
          (robot.bodies[capsule.body].shape < 0 || base_touches(robot, places, robot.bodies[capsule.body], kept[k],
                                                                robot.lengths.shapes[capsule.body] - robot.padding))) {
        scene.fixed_contact = {sphere.capsule, numbers[k]};
      }
    }
  }
  scene.surfaces_tested.assign(robot.capsules.size(), 0);
  return scene;
}

}  // namespace evenroad::robot
