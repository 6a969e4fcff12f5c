// The shortest path by A* (Hart, Nilsson and Raphael 1968), over integer lengths.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roadmap/graph.hpp"

namespace evenroad::roadmap {

/// What is known of a node or an edge.
enum State : std::int8_t { UNKNOWN, FREE, BLOCKED };

/// Lengths of the edges by number, >= 1, and lower bounds of the path from each node to the nearest goal.
struct Costs {
  std::span<const std::int64_t> weights, bounds;
};

/// What is known of the edges by number and of the nodes.
struct States {
  std::span<const std::int8_t> edges, nodes;
};

/// The nodes of a path, start first, and its edges; both empty where there is none.
struct Path {
  std::vector<std::int32_t> nodes, edges;
};

/// Return the one shortest path from a start to the nearest goal over nodes and edges that are not BLOCKED.
///
/// Among equally short paths it is the one that, followed back from its end, always goes to the lowest node.
Path shortest_path(const Graph& graph, const Costs& costs, const States& states, std::int32_t start,
                   std::span<const std::int64_t> goals);

}  // namespace evenroad::roadmap
