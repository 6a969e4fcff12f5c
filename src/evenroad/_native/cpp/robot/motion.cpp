// Bounds, and the short way between two configurations.
#include "robot/motion.hpp"

namespace evenroad::robot {

bool enter(std::span<const double> q, const Bounds& bounds, std::span<double> into) {
  bool inside = true;
  for (std::size_t k = 0; k < q.size(); k++) {
    const double value = into_range(q[k], bounds, k);
    if (!wraps(bounds, k)) inside &= is_within(value, bounds, k);
    into[k] = value;
  }
  return inside;
}

void make_canonical(std::span<double> q, const Bounds& bounds) {
  enter(q, bounds, q);
  for (std::size_t k = 0; k < q.size(); k++) {
    if (!wraps(bounds, k)) q[k] = std::min(std::max(q[k], bounds.low[k]), bounds.high[k]);
  }
}

double write_direction(std::span<const double> a, std::span<const double> b, const Bounds& bounds,
                       std::span<double> direction) {
  double squared = 0;
  for (std::size_t k = 0; k < a.size(); k++) {
    direction[k] = b[k] - a[k];
    // As FlatMetric: one half is rounded to zero, so that opposite places keep the sign.
    if (wraps(bounds, k)) direction[k] -= bounds.period[k] * std::rint(direction[k] / bounds.period[k]);
    squared += direction[k] * direction[k];
  }
  return std::sqrt(squared);
}

void Motion::span(std::span<const double> a, std::span<const double> b, const Bounds& bounds, double resolution) {
  exchanged = std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
  if (exchanged) std::swap(a, b);
  std::copy(a.begin(), a.end(), start.begin());
  std::copy(b.begin(), b.end(), end.begin());
  segments = static_cast<int>(std::ceil(write_direction(start, end, bounds, direction) / resolution));
}

void Motion::write_states(std::span<Doubles16> states) const {
  for (std::size_t k = 0; k < states.size(); k++) states[k] = start[k] + share * direction[k];
}

}  // namespace evenroad::robot
