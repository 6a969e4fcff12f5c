#include "roadmap/grow.hpp"

#include <array>
#include <utility>

namespace evenroad::roadmap {

namespace {

/// The nodes that a tree may add, nearest first, at most `most` of them.
class Offered {
 public:
  Offered(std::span<const double> away, std::size_t most) : away_(away), most_(most) {}

  void offer(std::int32_t node) {
    if (nodes_.size() == most_) {
      if (nodes_.empty() || away_[nodes_.back()] <= away_[node]) return;
      nodes_.pop_back();
    }
    std::size_t index = nodes_.size();
    while (index > 0 && away_[nodes_[index - 1]] > away_[node]) index--;
    nodes_.insert(nodes_.begin() + index, node);
  }

  const std::vector<std::int32_t>& nodes() const { return nodes_; }

 private:
  std::span<const double> away_;
  std::size_t most_;
  std::vector<std::int32_t> nodes_;
};

/// Add the far nodes of free edges to the trees; return an edge at which they meet, or -1.
std::int32_t take(Matrix<const std::int32_t> edges, std::span<const std::int8_t> edge_states, const TwoTrees& trees,
                  std::span<const std::int32_t> asked) {
  for (const std::int32_t edge : asked) {
    if (edge_states[edge] != FREE) continue;
    std::int32_t a = edges(edge, 0), b = edges(edge, 1);
    if (trees.tree[a] > 0 && trees.tree[b] > 0) return edge;
    if (trees.tree[a] == 0) std::swap(a, b);
    trees.tree[b] = trees.tree[a], trees.parent_edge[b] = edge;
  }
  return -1;
}

}  // namespace

Growth grow(Matrix<const std::int32_t> edges, const States& states, const TwoTrees& trees,
            std::span<const std::int32_t> asked, std::size_t most) {
  Growth growth{take(edges, states.edges, trees, asked), {}};
  if (growth.met >= 0) return growth;
  std::vector<std::int32_t> offer(trees.tree.size(), -1);
  std::array<Offered, 2> offered = {Offered(trees.away[0], most), Offered(trees.away[1], most)};
  std::array<bool, 3> grows = {false, false, false};
  for (std::size_t edge = 0; edge < edges.rows; edge++) {
    std::int32_t a = edges(edge, 0), b = edges(edge, 1);
    if (trees.tree[a] == trees.tree[b] || states.edges[edge] == BLOCKED) continue;
    if (trees.tree[a] == 0 || trees.tree[b] == 1) std::swap(a, b);
    if (states.nodes[b] == BLOCKED) continue;
    grows[trees.tree[a]] = grows[trees.tree[b]] = true;
    if (offer[b] >= 0) continue;
    offer[b] = static_cast<std::int32_t>(edge);
    offered[trees.tree[a] - 1].offer(b);
  }
  if (!grows[1] || !grows[2]) return growth;
  for (const Offered& each : offered) {
    for (const std::int32_t node : each.nodes()) growth.edges.push_back(offer[node]);
  }
  return growth;
}

Offers best_offers(const Rows& rows, std::int32_t node, std::span<const std::int64_t> weights,
                   std::span<const std::int64_t> cost, std::span<const std::int8_t> stage) {
  Offers offers;
  for (const Arc& arc : rows[node]) {
    if (stage[arc.to] != UNVISITED) continue;
    std::int32_t best = -1, giver = -1;
    std::int64_t least = 0;
    for (const auto [candidate, edge] : rows[arc.to]) {
      if (stage[candidate] != OPEN) continue;
      const std::int64_t reached = extended(cost[candidate], weights[edge]);
      if (best < 0 || reached < least || (reached == least && candidate < giver)) {
        best = edge, least = reached, giver = candidate;
      }
    }
    offers.nodes.push_back(arc.to), offers.edges.push_back(best);
  }
  return offers;
}

}  // namespace evenroad::roadmap
