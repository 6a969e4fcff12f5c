// The endpoints of a motion, and its states.
#include "robot/motion.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

void Motion::span(std::span<const double> a, std::span<const double> b, const Joints& joints, double resolution) {
  exchanged = std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
  if (exchanged) std::swap(a, b);
  std::copy(a.begin(), a.end(), start.begin());
  std::copy(b.begin(), b.end(), end.begin());
  segments = static_cast<int>(std::ceil(write_direction(start, end, joints, direction) / resolution));
}

void Motion::write_states(std::span<Doubles16> states) const {
  for (std::size_t k = 0; k < states.size(); k++) states[k] = start[k] + share * direction[k];
}

}  // namespace evenroad::robot
