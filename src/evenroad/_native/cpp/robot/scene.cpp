// A scene's obstacles for one robot: those in its reach, boxes around sixteen of them, and the pairs to test.
#include "robot/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "robot/exact_obstacle.hpp"
#include "robot/obstacle_contact.hpp"
#include "robot/obstacle_tree.hpp"

namespace evenroad::robot {

namespace {

constexpr double STANDS = 2e-6;  // allowed depth of a base in its support [m]
/// Return whether the true shape of a fixed body touches an obstacle.  The obstacle is slightly smaller, so that a base
/// may stand on a table.
bool base_touches(const Robot& robot, const PlacedRobot& placed, const Body& body, Exact o, double margin) {
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
  Obstacles alone;
  add(alone, o, 0);
  return shape_meeting(robot, placed, body, alone, 0, static_cast<float>(margin), 1, Wanted::FIRST) != 0;
}

/// Obstacles that the robot can reach, with their rows among those given.
using Reached = std::vector<std::pair<Exact, int>>;

Reached in_reach(const Robot& robot, const GivenObstacles& given, double clearance, Scene& scene) {
  if (given.tested.rows != robot.capsules.size() || given.tested.columns != given.rows.size() ||
      given.numbers.size() != given.rows.size()) {
    throw std::invalid_argument("tested must have a row for each capsule and a column for each obstacle");
  }
  Reached reached;
  scene.too_far = -1;
  const double reach = robot.reach + clearance, origin[3] = {0, 0, 0};
  for (std::size_t k = 0; k < given.rows.size(); k++) {
    const GivenObstacle& row = given.rows[k];
    if (!(row.kind >= 0 && row.kind < 4)) throw std::invalid_argument("there are four kinds of obstacles");
    if (scene.too_far < 0 && is_too_far(row)) scene.too_far = static_cast<int>(k);
    const Exact obstacle = exact(row, reach);
    const double far = reach + obstacle.rounding;
    if (squared_distance(obstacle, origin) <= far * far) reached.emplace_back(obstacle, static_cast<int>(k));
  }
  return reached;
}

/// Return the layer of obstacles, with a tree if there are many, for capsules of at most `widest`; obstacles are sorted
/// into its order.
Layer layer_of(Reached reached, const GivenObstacles& given, double reach, double widest, Scene& scene) {
  const bool many = static_cast<int>(reached.size()) >= MANY_OBSTACLES;
  if (many) sort_neighbours(reached);
  auto all = std::make_shared<Obstacles>();
  for (const auto& [obstacle, k] : reached) scene.added = std::max(scene.added, add(*all, obstacle, given.number(k)));
  if (many) all->tree = make_obstacle_tree(*all, reach, widest);
  OwnMatrix<std::uint16_t> tested(given.tested.rows, all->blocks.size());
  std::vector<bool> tests_all(tested.rows, true);
  for (std::size_t i = 0; i < tested.rows; i++) {
    for (std::size_t row = 0; row < reached.size(); row++) {
      if (given.tested(i, reached[row].second)) {
        tested(i, row / LANES) |= static_cast<std::uint16_t>(1U << (row % LANES));
      } else {
        tests_all[i] = false;
      }
    }
  }
  return {std::move(all), std::move(tested), std::move(tests_all)};
}

/// Find a fixed capsule and an obstacle that it touches.
void find_fixed_contact(const Robot& robot, const Reached& reached, const GivenObstacles& given, Scene& scene) {
  std::optional<PlacedRobot> placed;
  for (const FixedSphere& sphere : robot.fixed_spheres) {
    const Body& body = robot.bodies[robot.capsules[sphere.capsule].body];
    for (const auto& [obstacle, k] : reached) {
      // Without a clearance, because a fixed body cannot move away.
      const double near = sphere.radius + obstacle.rounding;
      if (!given.tested(sphere.capsule, k) || squared_distance(obstacle, sphere.centre) >= near * near) continue;
      if (body.shape >= 0) {
        if (!placed) placed.emplace(robot);
        const int b = robot.capsules[sphere.capsule].body;
        if (!base_touches(robot, *placed, body, obstacle, robot.lengths.shapes[b] - robot.padding)) continue;
      }
      scene.fixed_contact = {sphere.capsule, given.number(k)};
      return;
    }
  }
}

/// Return the row of an obstacle of the scene, -1 if it is not in a layer.
int row_of(const Layer& layer, std::int64_t number) {
  if (layer.obstacles == nullptr || number >= static_cast<std::int64_t>(layer.obstacles->row_of.size())) return -1;
  return layer.obstacles->row_of[static_cast<std::size_t>(number)];
}

}  // namespace

PlacedFrame frame_of(const Obstacle& obstacle) {
  const float* r = obstacle.rotation;
  return {{spread(Vec3{r[0], r[1], r[2]}), spread(Vec3{r[3], r[4], r[5]}), spread(Vec3{r[6], r[7], r[8]})},
          spread(obstacle.centre)};
}

Scene make_scene(const Robot& robot, std::span<const GivenObstacle> obstacles, Matrix<const bool> tested,
                 double clearance) {
  std::vector<std::int64_t> numbers(obstacles.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  const GivenObstacles given{obstacles, numbers, tested};
  Scene scene;
  const Reached reached = in_reach(robot, given, clearance, scene);
  const std::vector<float>& radii = robot.lengths.capsules;
  const double widest = radii.empty() ? 0 : *std::ranges::max_element(radii) + clearance;
  scene.obstacles = layer_of(reached, given, robot.reach + clearance, widest, scene);
  find_fixed_contact(robot, reached, given, scene);
  scene.surfaces_tested.assign(robot.capsules.size(), 0);
  return scene;
}

std::optional<Scene> change_scene(const Robot& robot, const Scene& before, std::span<const std::int64_t> gone,
                                  const GivenObstacles& come, double clearance) {
  if (std::ranges::find(gone, before.fixed_contact.second) != gone.end()) return std::nullopt;
  Scene scene = before;
  std::vector<bool> left(before.changed.obstacles != nullptr ? before.changed.obstacles->rows.size() : 0, true);
  for (const std::int64_t number : gone) {
    if (const int row = row_of(before.obstacles, number); row >= 0) {
      for (std::size_t i = 0; i < robot.capsules.size(); i++) {
        scene.obstacles.tested(i, row / LANES) &= static_cast<std::uint16_t>(~(1U << (row % LANES)));
        scene.obstacles.all[i] = false;
      }
    }
    if (const int row = row_of(before.changed, number); row >= 0) left[row] = false;
  }
  const Reached reached = in_reach(robot, come, clearance, scene);
  auto all = std::make_shared<Obstacles>();
  std::vector<int> kept;
  for (int row = 0; row < static_cast<int>(left.size()); row++) {
    if (left[row]) add_again(*all, *before.changed.obstacles, row), kept.push_back(row);
  }
  for (const auto& [obstacle, k] : reached) scene.added = std::max(scene.added, add(*all, obstacle, come.number(k)));
  OwnMatrix<std::uint16_t> tested(robot.capsules.size(), all->blocks.size());
  for (std::size_t i = 0; i < tested.rows; i++) {
    std::size_t row = 0;
    const auto set = [&](bool is_tested) {
      if (is_tested) tested(i, row / LANES) |= static_cast<std::uint16_t>(1U << (row % LANES));
      row++;
    };
    for (const int old : kept) set((before.changed.tested(i, old / LANES) >> (old % LANES) & 1) != 0);
    for (const auto& [obstacle, k] : reached) set(come.tested(i, k));
  }
  scene.changed = {std::move(all), std::move(tested), {}};
  if (scene.fixed_contact.first < 0) find_fixed_contact(robot, reached, come, scene);
  return scene;
}

}  // namespace evenroad::robot
