// The data of a search about the nodes of a half lattice, in blocks that are allocated when a node in them is reached.
// The cost of a query thus follows the visited nodes, not the size of the map.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace evenroad::world {

/// A point of the half lattice, in half pixels of the padded plane.
struct Node {
  std::int32_t column, row;
};

/// One node.
struct NodeState {
  std::int32_t cost;
  /// The search that reached it; entries of other searches are invalid.
  std::uint16_t search;
  /// The step by which it was reached.
  std::uint8_t step;
  bool is_closed;
};

/// The nodes of a thread's search; the memory is reused by the next one.
class NodeMemory {
 public:
  /// The step of a node that the search began with.
  static constexpr std::uint8_t SEED = 0xff;

  NodeMemory(std::int64_t rows, std::int64_t columns) : wide_((columns >> SHIFT) + 1) {
    const auto blocks = static_cast<std::size_t>(wide_ * ((rows >> SHIFT) + 1));
    for (Blocks& each : kept_.blocks) each.by_index.resize(std::max(each.by_index.size(), blocks));
    if (++kept_.search != 0) return;
    // Numbers of searches repeat, so entries of old searches are cleared.
    for (Blocks& each : kept_.blocks) each.spare.clear();
    kept_.search = 1;
  }

  NodeMemory(const NodeMemory&) = delete;
  NodeMemory& operator=(const NodeMemory&) = delete;

  ~NodeMemory() {
    for (Blocks& each : kept_.blocks) {
      for (auto& [index, block] : each.taken) {
        each.by_index[index] = nullptr;
        if (each.spare.size() < MOST_KEPT) each.spare.push_back(std::move(block));
      }
      each.taken.clear();
    }
  }

  /// Return the data of a node, or null if it was not reached.
  NodeState* find(Node at) const {
    NodeState* const block = kept_.blocks[kind(at)].by_index[index(at)];
    if (block == nullptr) return nullptr;
    NodeState& state = block[inside(at)];
    return state.search == kept_.search ? &state : nullptr;
  }

  /// Note that a node was reached at a cost, by a step.
  void reach(Node at, std::int32_t cost, std::uint8_t step) {
    Blocks& blocks = kept_.blocks[kind(at)];
    NodeState*& block = blocks.by_index[index(at)];
    if (block == nullptr) block = take(blocks, index(at), kind(at) == 0 ? SIDE * SIDE : 3 * SIDE * SIDE);
    block[inside(at)] = {cost, kept_.search, step, false};
  }

 private:
  /// Nodes whose column and row numbers agree up to the last bits form a block.  Centres of cells have odd numbers and
  /// separate blocks, because away from gates there are no others.
  static constexpr int SHIFT = 7, HALF = SHIFT - 1;
  static constexpr std::size_t SIDE = std::size_t{1} << HALF;
  /// Number of blocks of either kind that a thread keeps: 32 and 96 MB.
  static constexpr std::size_t MOST_KEPT = 1024;

  struct Free {
    void operator()(NodeState* memory) const { std::free(memory); }
  };
  using Block = std::unique_ptr<NodeState[], Free>;

  struct Blocks {
    /// The block of each position, null if not allocated.
    std::vector<NodeState*> by_index;
    std::vector<std::pair<std::size_t, Block>> taken;
    std::vector<Block> spare;
  };

  struct Kept {
    Blocks blocks[2];
    /// The number of the search.
    std::uint16_t search = 0;
  };

  static Kept& kept_by_thread() {
    thread_local Kept kept;
    return kept;
  }

  static int kind(Node at) { return (at.row & at.column & 1) != 0 ? 0 : 1; }

  std::size_t index(Node at) const {
    return static_cast<std::size_t>((at.row >> SHIFT) * wide_ + (at.column >> SHIFT));
  }

  static std::size_t inside(Node at) {
    const auto row = static_cast<std::size_t>(at.row), column = static_cast<std::size_t>(at.column);
    const std::size_t cell = (row >> 1 & (SIDE - 1)) << HALF | (column >> 1 & (SIDE - 1));
    return kind(at) == 0 ? cell : ((row & 1) << 1 | (column & 1)) << 2 * HALF | cell;
  }

  static NodeState* take(Blocks& blocks, std::size_t index, std::size_t nodes) {
    Block block;
    if (blocks.spare.empty()) {
      block.reset(static_cast<NodeState*>(std::calloc(nodes, sizeof(NodeState))));
      if (block == nullptr) throw std::bad_alloc();
    } else {
      block = std::move(blocks.spare.back());
      blocks.spare.pop_back();
    }
    blocks.taken.emplace_back(index, std::move(block));
    return blocks.taken.back().second.get();
  }

  std::int64_t wide_;
  Kept& kept_ = kept_by_thread();
};

}  // namespace evenroad::world
