// The route of the largest disk inside of a footprint, from start to goal: where a car probably drives, and no proof.
#pragma once

#include <vector>

#include "drive/vehicle.hpp"

namespace evenroad::drive {

/// Places of the reference point along a route, evenly, with the direction of travel.
std::vector<Pose> disk_route(const Vehicle& vehicle, const Pose& start, const Pose& goal);

}  // namespace evenroad::drive
