#include "roadmap/shortest_path.hpp"

#include <algorithm>
#include <limits>

#include "common/time_limit.hpp"

namespace evenroad::roadmap {

namespace {

/// Nodes by key, the least on top, each at most once; a key can fall.
class Heap {
 public:
  explicit Heap(std::size_t nodes) : index_(nodes, NOWHERE) {}

  bool empty() const { return entries_.empty(); }
  std::int64_t least() const { return entries_.front().key; }

  /// Insert a node, or move it up to a lower key.
  void put(std::int32_t node, std::int64_t key) {
    std::size_t hole = index_[node];
    if (hole == NOWHERE) hole = entries_.size(), entries_.emplace_back();
    while (hole > 0) {
      const std::size_t above = (hole - 1) / 2;
      if (entries_[above].key <= key) break;
      move(entries_[above], hole);
      hole = above;
    }
    move({key, node}, hole);
  }

  std::int32_t take() {
    const std::int32_t top = entries_.front().node;
    index_[top] = NOWHERE;
    const Entry last = entries_.back();
    entries_.pop_back();
    if (entries_.empty()) return top;
    std::size_t hole = 0;
    for (std::size_t child = 1; child < entries_.size(); child = 2 * hole + 1) {
      if (child + 1 < entries_.size() && entries_[child + 1].key < entries_[child].key) child++;
      if (last.key <= entries_[child].key) break;
      move(entries_[child], hole);
      hole = child;
    }
    move(last, hole);
    return top;
  }

 private:
  struct Entry {
    std::int64_t key;
    std::int32_t node;
  };
  static constexpr std::uint32_t NOWHERE = std::numeric_limits<std::uint32_t>::max();

  void move(Entry entry, std::size_t to) {
    entries_[to] = entry;
    index_[entry.node] = static_cast<std::uint32_t>(to);
  }

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> index_;
};

/// The arc by which a node was reached at the least cost.
struct From {
  std::int32_t node, edge;
};

Path path_to(std::int32_t end, std::int32_t start, const std::vector<From>& reached) {
  Path path{{end}, {}};
  while (path.nodes.back() != start) {
    const auto [node, edge] = reached[path.nodes.back()];
    path.edges.push_back(edge);
    path.nodes.push_back(node);
  }
  std::reverse(path.nodes.begin(), path.nodes.end());
  std::reverse(path.edges.begin(), path.edges.end());
  return path;
}

}  // namespace

Path shortest_path(const Graph& graph, const Costs& costs, const States& states, std::int32_t start,
                   std::span<const std::int64_t> goals) {
  std::vector<bool> is_goal(graph.nodes());
  for (const std::int64_t goal : goals) is_goal[goal] = true;
  std::vector<std::int64_t> cost(graph.nodes(), std::numeric_limits<std::int64_t>::max());
  std::vector<From> reached(graph.nodes());
  Heap open(graph.nodes());
  std::int32_t end = -1;
  cost[start] = 0;
  open.put(start, costs.bounds[start]);
  ClockWatch clock(512);
  // Ties with the goal are expanded, too, because one of them may have the lower node.
  while (!open.empty() && (end < 0 || open.least() <= cost[end])) {
    clock.look();
    const std::int32_t node = open.take();
    if (is_goal[node]) {
      if (end < 0 || cost[node] < cost[end] || (cost[node] == cost[end] && node < end)) end = node;
      continue;
    }
    for (const Rows* rows : {&graph.fixed(), &graph.links()}) {
      for (const auto [neighbour, edge] : (*rows)[node]) {
        if (states.edges[edge] == BLOCKED || states.nodes[neighbour] == BLOCKED) continue;
        const std::int64_t through = extended(cost[node], costs.weights[edge]);
        if (through < cost[neighbour]) {
          cost[neighbour] = through, reached[neighbour] = {node, edge};
          open.put(neighbour, extended(through, costs.bounds[neighbour], 0));
        } else if (through == cost[neighbour] && node < reached[neighbour].node) {
          reached[neighbour] = {node, edge};
        }
      }
    }
  }
  return end < 0 ? Path{} : path_to(end, start, reached);
}

}  // namespace evenroad::roadmap
