// Contact of sixteen configurations with many obstacles: a grid and a tree find the few that are near.
//
// Which obstacles are tested differs from the check of few, and how a lane is decided does not: results are the same.
#pragma once

#include "robot/exact_obstacle.hpp"
#include "robot/obstacle_contact.hpp"

namespace evenroad::robot {

/// Number of obstacles from which on a tree is faster than all blocks in a row.
constexpr int MANY_OBSTACLES = 320;

/// Bring obstacles, with what belongs to them, into an order in which sixteen neighbours are near each other.
void sort_neighbours(std::vector<std::pair<Exact, int>>& obstacles);

/// Return the grid and the tree over obstacles in that order; nothing of the robot is farther from the origin than
/// `reach`, and no capsule is wider than `widest` [m].
std::unique_ptr<const ObstacleTree> make_obstacle_tree(const Obstacles& obstacles, double reach, double widest);

/// Return the same as `meeting_obstacles`.
Mask meeting_in_tree(const Robot& robot, const Lengths& lengths, const Layer& layer, PlacedRobot& placed, Mask blocked,
                     Wanted wanted, Contact* found);

}  // namespace evenroad::robot
