// The shortest path by A* (Hart, Nilsson and Raphael 1968), over integer lengths.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "roadmap/graph.hpp"

namespace evenroad::roadmap {

/// The state of a node or an edge.
enum State : std::int8_t { UNKNOWN, FREE, BLOCKED };

/// Lengths of the edges by number, >= 1, and lower bounds of the path from each node to the nearest goal.
struct Costs {
  std::span<const std::int64_t> weights, bounds;
};

/// The states of the edges by number, and of the nodes.
struct States {
  std::span<const std::int8_t> edges, nodes;
};

/// Return the sum of a path's and an edge's length; refuse sums that would not stay 64-bit integers.
inline std::int64_t extended(std::int64_t path, std::int64_t edge, std::int64_t least = 1) {
  constexpr std::int64_t MOST = std::int64_t{1} << 61;
  if (path < 0 || path > 2 * MOST || edge < least || edge > MOST) {
    throw std::invalid_argument("weights must be from 1, and bounds and paths from 0, to 2^61");
  }
  return path + edge;
}

/// The nodes of a path, start first, and its edges; both are empty if there is none.
struct Path {
  std::vector<std::int32_t> nodes, edges;
};

/// Return the one shortest path from a start to the nearest goal over nodes and edges that are not BLOCKED.
///
/// Among equally short paths it is the one that, followed back from its end, always goes to the lowest node.
Path shortest_path(const Graph& graph, const Costs& costs, const States& states, std::int32_t start,
                   std::span<const std::int64_t> goals);

}  // namespace evenroad::roadmap
