// Contact of sixteen configurations with many obstacles: a grid and a tree find the few that are near.
//
// It tests other obstacles than the check of few, but decides a lane in the same way, so results are the same.
#pragma once

#include "robot/exact_obstacle.hpp"
#include "robot/obstacle_contact.hpp"

namespace evenroad::robot {

/// Number of obstacles from which a tree is faster than all blocks in sequence.
constexpr int MANY_OBSTACLES = 320;

/// Sort obstacles, with their other data, so that groups of sixteen are near each other.
void sort_neighbours(std::vector<std::pair<Exact, int>>& obstacles);

/// Return the grid and the tree over obstacles in that order.  No point of the robot is farther from the origin than
/// `reach`, and no capsule is wider than `widest` [m].
std::unique_ptr<const ObstacleTree> make_obstacle_tree(const Obstacles& obstacles, double reach, double widest);

/// Return the result of `meeting_obstacles`.
Mask meeting_in_tree(const Robot& robot, const Lengths& lengths, const Layer& layer, PlacedRobot& placed, Mask blocked,
                     Wanted wanted, Contact* found);

}  // namespace evenroad::robot
