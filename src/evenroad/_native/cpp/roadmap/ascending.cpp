// Two stable passes of counting, by the larger number and by the smaller one: the time grows as the number of pairs.
#include "roadmap/ascending.hpp"

#include <algorithm>

#include "common/time_limit.hpp"

namespace evenroad::roadmap {

namespace {

struct Edge {
  std::int32_t first, second;
  bool operator==(const Edge&) const = default;
};

/// Sort edges by one of their numbers, below `count`; equal ones stay in order.
void sort_by(std::int32_t Edge::* number, std::vector<Edge>& edges, std::size_t count) {
  look_at_clock();
  std::vector<std::size_t> next(count + 1);
  for (const Edge& edge : edges) next[static_cast<std::size_t>(edge.*number) + 1]++;
  for (std::size_t i = 1; i <= count; i++) next[i] += next[i - 1];
  std::vector<Edge> sorted(edges.size());
  for (const Edge& edge : edges) sorted[next[static_cast<std::size_t>(edge.*number)]++] = edge;
  edges = std::move(sorted);
}

}  // namespace

std::vector<std::int32_t> ascending_pairs(Matrix<const std::int32_t> pairs, std::size_t count) {
  std::vector<Edge> edges;
  edges.reserve(pairs.rows);
  for (std::size_t i = 0; i < pairs.rows; i++) {
    edges.push_back({std::min(pairs(i, 0), pairs(i, 1)), std::max(pairs(i, 0), pairs(i, 1))});
  }
  sort_by(&Edge::second, edges, count);
  sort_by(&Edge::first, edges, count);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::int32_t> rows;
  rows.reserve(2 * edges.size());
  for (const Edge& edge : edges) rows.insert(rows.end(), {edge.first, edge.second});
  return rows;
}

}  // namespace evenroad::roadmap
