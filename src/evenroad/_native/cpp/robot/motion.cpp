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

double way_between(std::span<const double> a, std::span<const double> b, const Bounds& bounds, std::span<double> way) {
  double squared = 0;
  for (std::size_t k = 0; k < a.size(); k++) {
    way[k] = b[k] - a[k];
    // As FlatMetric: one half is rounded to zero, so that opposite places keep the sign.
    if (wraps(bounds, k)) way[k] -= bounds.period[k] * std::rint(way[k] / bounds.period[k]);
    squared += way[k] * way[k];
  }
  return std::sqrt(squared);
}

void Motion::span(std::span<const double> a, std::span<const double> b, const Bounds& bounds, double resolution) {
  exchanged = std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
  if (exchanged) std::swap(a, b);
  std::copy(a.begin(), a.end(), start.begin());
  std::copy(b.begin(), b.end(), end.begin());
  segments = static_cast<int>(std::ceil(way_between(start, end, bounds, way) / resolution));
}

void Motion::write_states(std::span<Doubles16> states) const {
  for (std::size_t k = 0; k < states.size(); k++) states[k] = start[k] + share * way[k];
}

}  // namespace evenroad::robot
