#include "roadmap/spread_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evenroad::roadmap {

namespace {

/// For each point the ends that see it.
std::vector<std::vector<std::size_t>> by_point(const Seen& seen, std::size_t points) {
  std::vector<std::vector<std::size_t>> terminals(points);
  for (std::size_t end = 0; end < seen.terminals(); end++) {
    for (const std::int64_t point : seen[end]) terminals[point].push_back(end);
  }
  return terminals;
}

/// Write the squared distances of all points, by coordinate, from one.
void squared_distances(OwnMatrix<double>& columns, std::span<const double> period, std::size_t from,
                       std::vector<double>& squared) {
  std::fill(squared.begin(), squared.end(), 0.0);
  for (std::size_t k = 0; k < period.size(); k++) {
    const std::span<const double> column = columns[k];
    const double here = column[from], turn = period[k];
    for (std::size_t row = 0; row < squared.size(); row++) {
      double apart = std::abs(column[row] - here);
      apart = std::min(apart, turn - apart);
      squared[row] += apart * apart;
    }
  }
}

}  // namespace

std::vector<std::int64_t> spread_order(const Periodic& set, std::span<const double> preference, std::size_t count,
                                       const Seen& seen, const Serving& serving) {
  const std::size_t n = set.points.rows;
  const double terminals = static_cast<double>(std::max<std::size_t>(seen.terminals(), 1));
  const auto seeing = by_point(seen, n);
  std::vector<double> use(n, serving.least), times(seen.terminals(), 1.0);
  for (const std::int64_t point : seen.which) use[point] += 1.0 / terminals;
  OwnMatrix<double> columns = transposed(set.points);
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity()), squared(n), value(n);
  std::size_t chosen = 0;
  for (std::size_t row = 1; row < n; row++) {
    if (preference[row] * use[row] > preference[chosen] * use[chosen]) chosen = row;
  }
  std::vector<std::int64_t> order;
  while (order.size() < count) {
    order.push_back(static_cast<std::int64_t>(chosen));
    for (const std::size_t end : seeing[chosen]) {
      const double lost = std::pow(times[end], -serving.served) - std::pow(times[end] + 1.0, -serving.served);
      times[end] += 1.0;
      for (const std::int64_t point : seen[end]) use[point] -= lost / terminals;
    }
    squared_distances(columns, set.period, chosen, squared);
    for (std::size_t row = 0; row < n; row++) {
      nearest[row] = std::min(nearest[row], squared[row]);
      value[row] = std::sqrt(nearest[row]) * preference[row] * use[row];
    }
    chosen = std::max_element(value.begin(), value.end()) - value.begin();
  }
  return order;
}

}  // namespace evenroad::roadmap
