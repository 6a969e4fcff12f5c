// Velocities at the corners of a polyline: the quickest flight over some of the corners, by a lazy search.
#pragma once

#include <cstdint>
#include <vector>

#include "flight/airspace.hpp"

namespace evenroad::flight {

/// States, joined by motions of the least time, and the time of each motion.
struct FlightPath {
  std::vector<State> states;
  std::vector<double> times;

  double duration() const;
};

/// Return the quickest proved flight from a start over some of the corners between to a goal, with one of a few
/// velocities along the polyline at each, and in the middle of segments that are longer than `longest`; nothing if
/// there is none, or none after that many motions were checked.
FlightPath fly_over(const Airspace& airspace, const State& start, const std::vector<Vector>& corners, const State& goal,
                    double longest, std::int64_t& motions);

}  // namespace evenroad::flight
