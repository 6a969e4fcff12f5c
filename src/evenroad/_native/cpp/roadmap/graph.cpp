#include "roadmap/graph.hpp"

#include <algorithm>

#include "common/disjoint_sets.hpp"

namespace evenroad::roadmap {

Rows::Rows(std::size_t nodes, Matrix<const std::int32_t> edges, std::int32_t numbered_from)
    : first_(nodes + 1), arcs_(2 * edges.rows) {
  for (std::size_t e = 0; e < edges.rows; e++) first_[edges(e, 0) + 1]++, first_[edges(e, 1) + 1]++;
  for (std::size_t node = 0; node < nodes; node++) first_[node + 1] += first_[node];
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t e = 0; e < edges.rows; e++) {
    const auto number = numbered_from + static_cast<std::int32_t>(e);
    for (const int side : {0, 1}) arcs_[next[edges(e, side)]++] = {edges(e, 1 - side), number};
  }
}

Graph Graph::with_links(std::size_t nodes, Matrix<const std::int32_t> links, std::int32_t numbered_from) const {
  Graph linked(*this);
  linked.nodes_ = nodes;
  linked.numbers_ = std::max(fixed_edges_, numbered_from + links.rows);
  linked.links_ = Rows(nodes, links, numbered_from);
  return linked;
}

void join(std::span<std::int32_t> label, Matrix<const std::int32_t> edges) {
  for (std::size_t e = 0; e < edges.rows; e++) unite(label, edges(e, 0), edges(e, 1));
  // Roots are lower than their children, so one ascending sweep flattens every tree.
  for (std::int32_t& each : label) each = label[each];
}

}  // namespace evenroad::roadmap
