// A* over integer costs with buckets for the queue.  A step between free cells that share a side or a corner needs no
// check; every other one is tested exactly.
#include "world/lattice_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/time_limit.hpp"
#include "world/corridor.hpp"
#include "world/node_memory.hpp"

namespace evenroad::world {

namespace {

/// A step on the half lattice and its cost: about ten times its length in pixels.
struct Step {
  std::int8_t right, down;
  std::int8_t cost;
};

/// The first eight lead from cell to cell.
constexpr std::array<Step, 24> STEPS = {{
    {2, 0, 10}, {-2, 0, 10}, {0, 2, 10},  {0, -2, 10},  {2, 2, 14}, {2, -2, 14}, {-2, 2, 14}, {-2, -2, 14},
    {1, 0, 5},  {-1, 0, 5},  {0, 1, 5},   {0, -1, 5},   {1, 1, 7},  {1, -1, 7},  {-1, 1, 7},  {-1, -1, 7},
    {2, 1, 11}, {2, -1, 11}, {-2, 1, 11}, {-2, -1, 11}, {1, 2, 11}, {1, -2, 11}, {-1, 2, 11}, {-1, -2, 11},
}};
constexpr std::size_t OVER_CELLS = 8;
/// Number of lattice points that a start or goal is linked to, and the rings of them that are tried.
constexpr std::size_t LINKS = 24;
constexpr std::int64_t RINGS = 13;
/// Share of the least cost that counts as a bound, because costs are rounded down.
constexpr double BOUND = 0.97;

/// The queue: nodes in buckets by key, last in, first out.  Its keys never differ by more than the number of buckets.
class Buckets {
 public:
  explicit Buckets(std::int64_t least) : key_(least) { heads_.fill(-1); }

  std::int64_t key() const { return key_; }
  bool empty() const { return waiting_ == 0; }

  void put(Node node, std::int64_t key) {
    std::int32_t& head = heads_[key % COUNT];
    // Slots of removed entries are reused, so the queue is as large as the number of waiting nodes.
    std::int32_t entry = spare_;
    if (entry >= 0) {
      spare_ = entries_[entry].next;
    } else {
      entry = static_cast<std::int32_t>(entries_.size());
      entries_.emplace_back();
    }
    entries_[entry] = {node, head};
    head = entry;
    waiting_++;
  }

  Node take() {
    while (heads_[key_ % COUNT] < 0) key_++;
    std::int32_t& head = heads_[key_ % COUNT];
    const std::int32_t taken = head;
    head = entries_[taken].next;
    entries_[taken].next = spare_, spare_ = taken;
    waiting_--;
    return entries_[taken].node;
  }

  /// More than the largest step of a key, twice the costliest step.
  static constexpr std::int64_t COUNT = 64;

 private:
  struct Entry {
    Node node;
    std::int32_t next;
  };

  std::array<std::int32_t, COUNT> heads_;
  std::int32_t spare_ = -1;
  std::vector<Entry> entries_;
  std::int64_t key_, waiting_ = 0;
};

class LatticeSearch {
 public:
  LatticeSearch(const Disk& disk, std::span<const Point> goals, std::int64_t most, const Corridor* corridor)
      : disk_(disk),
        most_(most),
        corridor_(corridor),
        nodes_(2 * disk.rows() + 1, 2 * disk.columns() + 1),
        goals_(goals) {
    for (std::size_t goal = 0; goal < goals.size(); goal++) {
      const Point at = disk.frame().to_padded(goals[goal]);
      targets_.push_back({2.0 * at.x, 2.0 * at.y});
      for (const Node node : links(goals[goal])) {
        if (goal_of(node) < 0) goal_nodes_.push_back({number(node), static_cast<std::int64_t>(goal)});
      }
      // Only the first goal that a node leads to counts.
      std::sort(goal_nodes_.begin(), goal_nodes_.end(),
                [](const GoalNode& a, const GoalNode& b) { return a.node < b.node; });
    }
  }

  LatticePath run(Point start) {
    LatticePath found;
    Buckets queue = seeded(start);
    ClockWatch clock(256);
    while (!queue.empty() && motions_ < most_) {
      clock.look();
      const Node node = queue.take();
      NodeState& state = *nodes_.find(node);
      if (state.is_closed) continue;
      state.is_closed = true;
      found.expanded++;
      if (const std::int64_t goal = goal_of(node); goal >= 0) {
        found.goal = goal, found.points = trace(node, start, goals_[goal]);
        break;
      }
      expand(node, state.cost, queue);
    }
    found.motions = motions_;
    return found;
  }

 private:
  struct GoalNode {
    std::int64_t node, goal;
  };

  /// Return the unique number of a node.
  static std::int64_t number(Node at) { return static_cast<std::int64_t>(at.row) << 32 | at.column; }
  Point map_point(Node at) const {
    return disk_.frame().to_map({0.5 * static_cast<double>(at.column), 0.5 * static_cast<double>(at.row)});
  }

  /// Say whether a node is the centre of a surely free cell.
  bool is_centre(Node at) const {
    return at.row % 2 == 1 && at.column % 2 == 1 && disk_.cell(at.row / 2, at.column / 2) >= FREE;
  }

  /// Say whether a node lies in a cell of a gate, or between two.
  bool is_at_gate(Node at) const {
    const auto before = [](std::int64_t half) { return std::max<std::int64_t>(half - 1, 0) / 2; };
    return disk_.is_gate(at.row / 2, at.column / 2) || disk_.is_gate(before(at.row), before(at.column));
  }

  /// Return to which goal a node leads, -1 to none.
  std::int64_t goal_of(Node node) const {
    const std::int64_t wanted = number(node);
    const auto at = std::lower_bound(goal_nodes_.begin(), goal_nodes_.end(), wanted,
                                     [](const GoalNode& each, std::int64_t of) { return each.node < of; });
    return at != goal_nodes_.end() && at->node == wanted ? at->goal : -1;
  }

  /// Return a lower bound of the cost from a node to the nearest target.
  std::int64_t bound(Node at) const {
    double least = 1e18;
    for (const Point& target : targets_) {
      const double along = std::abs(target.x - static_cast<double>(at.column));
      const double across = std::abs(target.y - static_cast<double>(at.row));
      least = std::min(least, 5.0 * std::max(along, across) + 2.0 * std::min(along, across));
    }
    return static_cast<std::int64_t>(BOUND * least);
  }

  /// Return the nodes near a map point that can be reached straight, ring by ring until there are enough.
  std::vector<Node> links(Point from) {
    const Point at = disk_.frame().to_padded(from);
    // Points far outside, or with NaN, have no links.
    const auto nearest = [](double along) {
      return static_cast<std::int64_t>(std::nearbyint(2.0 * (along >= -1e9 ? std::min(along, 1e9) : -1e9)));
    };
    const std::int64_t column = nearest(at.x), row = nearest(at.y);
    const std::int64_t last_row = 2 * disk_.rows() - 1, last_column = 2 * disk_.columns() - 1;
    std::vector<Node> linked;
    for (std::int64_t ring = 0; ring < RINGS && linked.size() < LINKS; ring++) {
      for (std::int64_t r = std::max<std::int64_t>(row - ring, 0); r <= std::min(row + ring, last_row); r++) {
        for (std::int64_t c = std::max<std::int64_t>(column - ring, 0); c <= std::min(column + ring, last_column);
             c++) {
          if (std::max(std::abs(r - row), std::abs(c - column)) != ring) continue;
          const Node node{static_cast<std::int32_t>(c), static_cast<std::int32_t>(r)};
          if (!is_centre(node) && !is_at_gate(node)) continue;
          motions_++;
          if (disk_.is_motion_free(from, map_point(node))) linked.push_back(node);
        }
      }
    }
    return linked;
  }

  /// Put the nodes near the start into the queue.
  Buckets seeded(Point start) {
    const Point at = disk_.frame().to_padded(start);
    const std::vector<Node> linked = links(start);
    std::vector<std::int64_t> keys;
    std::int64_t least = std::int64_t{1} << 60;
    for (const Node node : linked) {
      const double away =
          std::hypot(0.5 * static_cast<double>(node.column) - at.x, 0.5 * static_cast<double>(node.row) - at.y);
      const auto cost = static_cast<std::int32_t>(10.0 * away);
      nodes_.reach(node, cost, NodeMemory::SEED);
      keys.push_back(cost + bound(node));
      least = std::min(least, keys.back());
    }
    // The keys of the seeds may differ by more than those of later steps, so large ones are clipped.
    Buckets queue(least);
    for (std::size_t i = 0; i < linked.size(); i++) {
      queue.put(linked[i], std::min(keys[i], least + Buckets::COUNT / 2 - 1));
    }
    return queue;
  }

  /// Put the nodes that a node leads to into the queue.
  void expand(Node here, std::int32_t spent, Buckets& queue) {
    const std::size_t first = is_centre(here) ? 0 : OVER_CELLS, last = is_at_gate(here) ? STEPS.size() : OVER_CELLS;
    for (std::size_t step = first; step < last; step++) {
      // It never leaves the array, because nothing is free on its ring.
      const Node there{here.column + STEPS[step].right, here.row + STEPS[step].down};
      const std::int32_t cost = spent + STEPS[step].cost;
      const NodeState* const known = nodes_.find(there);
      if (known != nullptr && (known->is_closed || known->cost <= cost)) continue;
      if (corridor_ != nullptr && !corridor_->has(there)) continue;
      if (!is_step_free(step, here, there)) continue;
      nodes_.reach(there, cost, static_cast<std::uint8_t>(step));
      queue.put(there, std::max(cost + bound(there), queue.key()));
    }
  }

  bool is_step_free(std::size_t step, Node from, Node to) {
    if (step < OVER_CELLS) return is_centre(to);
    if (!is_at_gate(to) || disk_.cell(to.row / 2, to.column / 2) == BLOCKED) return false;
    motions_++;
    return disk_.is_motion_free(map_point(from), map_point(to));
  }

  std::vector<Point> trace(Node node, Point start, Point goal) const {
    std::vector<Point> points = {goal, map_point(node)};
    for (std::uint8_t by; (by = nodes_.find(node)->step) != NodeMemory::SEED;) {
      node.column -= STEPS[by].right, node.row -= STEPS[by].down;
      points.push_back(map_point(node));
    }
    points.push_back(start);
    std::reverse(points.begin(), points.end());
    return points;
  }

  const Disk& disk_;
  std::int64_t most_, motions_ = 0;
  const Corridor* corridor_;
  NodeMemory nodes_;
  std::span<const Point> goals_;
  /// The goals on the lattice, in half pixels; which nodes lead to them, by node.
  std::vector<Point> targets_;
  std::vector<GoalNode> goal_nodes_;
};

}  // namespace

LatticePath search_cells(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most,
                         const Corridor* corridor) {
  return LatticeSearch(disk, goals, most, corridor).run(start);
}

}  // namespace evenroad::world
