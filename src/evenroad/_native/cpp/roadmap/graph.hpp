// A graph as compressed rows, with links that can be replaced; its connected components.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::roadmap {

/// One direction of an undirected edge: its target node, and the edge's number.
struct Arc {
  std::int32_t to, edge;
};

/// For each node the arcs that leave it, in the order of the edges.
class Rows {
 public:
  Rows() = default;

  /// Make it from edges, (m, 2), with both nodes below `nodes`; their numbers begin with `numbered_from`.
  Rows(std::size_t nodes, Matrix<const std::int32_t> edges, std::int32_t numbered_from);

  /// The arcs of a node; none for a node that the rows do not have.
  std::span<const Arc> operator[](std::size_t node) const {
    if (node + 1 >= first_.size()) return {};
    return std::span(arcs_).subspan(first_[node], first_[node + 1] - first_[node]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<Arc> arcs_;
};

/// Undirected edges by node: fixed ones, and links of one query beside them.  It never changes.
class Graph {
 public:
  Graph(std::size_t nodes, Matrix<const std::int32_t> edges)
      : nodes_(nodes),
        fixed_edges_(edges.rows),
        numbers_(edges.rows),
        fixed_(std::make_shared<const Rows>(nodes, edges, 0)) {}

  /// Return this graph with that many nodes, and with other links; O(nodes).
  Graph with_links(std::size_t nodes, Matrix<const std::int32_t> links, std::int32_t numbered_from) const;

  std::size_t nodes() const { return nodes_; }
  /// The numbers of all edges are below this.
  std::size_t numbers() const { return numbers_; }
  const Rows& fixed() const { return *fixed_; }
  const Rows& links() const { return links_; }

 private:
  std::size_t nodes_, fixed_edges_, numbers_;
  std::shared_ptr<const Rows> fixed_;
  Rows links_;
};

/// Join components along edges: `label` holds for every node the lowest node of its component.
void join(std::span<std::int32_t> label, Matrix<const std::int32_t> edges);

}  // namespace evenroad::roadmap
