// Trees of a roadmap that grow while the world evaluates edges: two that meet, and a marching one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roadmap/shortest_path.hpp"

namespace evenroad::roadmap {

/// Two trees in a graph, from the start (1) and from the goals (2); a node in neither is 0.
struct TwoTrees {
  std::span<std::int8_t> tree;
  /// The edge by which each node was added, -1 for roots.
  std::span<std::int32_t> parent_edge;
  /// Distances of all nodes from the root of the other tree, (2, nodes).
  Matrix<const double> away;
};

/// The next step of two trees: an edge at which they meet, or -1 and the edges to evaluate.
struct Growth {
  std::int32_t met;
  std::vector<std::int32_t> edges;
};

/// Add the nodes behind free evaluated edges to the trees.  Return edges to at most that many nodes of each tree,
/// nearest first, or none if one of the two can grow no further.
Growth grow(Matrix<const std::int32_t> edges, const States& states, const TwoTrees& trees,
            std::span<const std::int32_t> asked, std::size_t most);

/// The state of a node in a marching tree.
enum Stage : std::int8_t { UNVISITED, OPEN, CLOSED };

/// Unvisited nodes, and for each the edge from an open node with the least cost, -1 for none.
struct Offers {
  std::vector<std::int32_t> nodes, edges;
};

/// Return the unvisited neighbours of a node of a marching tree, with the best edge for each; ties go to the lower
/// node.
Offers best_offers(const Rows& rows, std::int32_t node, std::span<const std::int64_t> weights,
                   std::span<const std::int64_t> cost, std::span<const std::int8_t> stage);

}  // namespace evenroad::roadmap
