// What a search knows of the nodes of a lattice, in memory that is zero at first: a query costs what it touches, not
// what the map has.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace evenroad::world {

/// One node; all zero where it was not reached.
struct NodeState {
  std::int32_t cost_and_one;
  /// The step by which it was reached.
  std::uint8_t step;
  bool is_closed;

  bool is_reached() const { return cost_and_one > 0; }
  std::int32_t cost() const { return cost_and_one - 1; }
};

/// The nodes of one search: small lattices in memory that the thread keeps, large ones in pages that the system zeroes
/// when they are touched.
class NodeMemory {
 public:
  /// The step of a node that the search began with.
  static constexpr std::uint8_t SEED = 0xff;

  explicit NodeMemory(std::size_t nodes) {
    if (nodes <= KEPT) {
      std::vector<NodeState>& kept = kept_by_thread();
      if (kept.size() < nodes) kept.resize(nodes);
      nodes_ = kept.data();
      return;
    }
    own_.reset(static_cast<NodeState*>(std::calloc(nodes, sizeof(NodeState))));
    if (own_ == nullptr) throw std::bad_alloc();
    nodes_ = own_.get();
  }

  NodeMemory(const NodeMemory&) = delete;
  NodeMemory& operator=(const NodeMemory&) = delete;

  ~NodeMemory() {
    // What the thread keeps is zero again.
    for (const std::int64_t node : touched_) nodes_[node] = {};
  }

  NodeState& operator[](std::int64_t node) { return nodes_[node]; }
  const NodeState& operator[](std::int64_t node) const { return nodes_[node]; }

  /// Note that a node was reached at a cost, by a step.
  void reach(std::int64_t node, std::int32_t cost, std::uint8_t step) {
    if (own_ == nullptr && !nodes_[node].is_reached()) touched_.push_back(node);
    nodes_[node].cost_and_one = cost + 1, nodes_[node].step = step;
  }

 private:
  /// Most nodes that a thread keeps memory for: 32 MB.
  static constexpr std::size_t KEPT = std::size_t{1} << 22;

  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };

  static std::vector<NodeState>& kept_by_thread() {
    thread_local std::vector<NodeState> kept;
    return kept;
  }

  NodeState* nodes_ = nullptr;
  std::unique_ptr<NodeState[], Free> own_;
  std::vector<std::int64_t> touched_;
};

}  // namespace evenroad::world
