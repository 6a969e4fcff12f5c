// Cells of the ranges of some joints, split only where a path may lead through them (D. Zhu and J.-C. Latombe, 1991).
//
// A cell is blocked if every configuration in it is, and clear if none is; others are unknown.  The caller decides
// cells that wait.  A search then splits unknown cells on the paths that have the fewest of them, and the new cells
// wait.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::infeasibility {

constexpr std::size_t MOST_JOINTS = 4;
constexpr int DEEPEST = 12;           // largest number of times a cell is split
constexpr std::int64_t SPLIT_OF = 2;  // paths with up to twice the fewest unknown cells are split, too

/// The cells along one joint at the beginning [rad or m].
struct Axis {
  double low, size;    // lower end, and extent of a cell
  std::int64_t count;  // number of cells
  double period;       // infinite for a joint that does not wrap
  bool whole;          // whether the cells go all around the circle
};

enum class Cell : std::uint8_t { WAITING, BLOCKED, CLEAR, UNKNOWN };

/// How a search ended: no path, a path of clear cells, no result, or with cells that wait.
enum class Ended : std::uint8_t { APART, JOINED, UNDECIDED, SPLIT };

class SplitCells {
 public:
  /// All cells wait at depth 0.
  explicit SplitCells(std::vector<Axis> axes);

  std::size_t joints() const { return axes_.size(); }

  /// Cells of a depth that wait, in order.
  std::span<const int> waiting(int depth) const { return waiting_[static_cast<std::size_t>(depth)]; }
  bool are_decided() const;
  /// Return the middles of these cells, one row each.
  OwnMatrix<double> middles(int depth) const;
  /// Decide these cells: which are not blocked, and which of those are clear.
  void decide(int depth, std::span<const bool> unblocked, std::span<const bool> clear);

  /// Return whether a path may lead from the start to a goal, rows of (g, joints); at most `most` cells are kept.
  Ended search(std::span<const double> start, Matrix<const double> goals, std::int64_t most);

 private:
  struct Node {
    int children = -1;  // the first of them, one for each corner; -1 for none
    int depth = 0;
    Cell state = Cell::WAITING;
  };
  using Number = std::array<std::int32_t, MOST_JOINTS>;  // of a cell along each joint, among those of its depth

  void add(int depth, const Number& number);
  int node_at(const Number& number, int depth) const;
  int find(std::span<const double> values) const;
  std::vector<int> fewest_unknown(std::span<const int> from, std::int64_t most, std::span<const int> until) const;
  Ended split(std::span<const int> cells, std::int64_t most);
  int cost(int node) const { return nodes_[static_cast<std::size_t>(node)].state == Cell::UNKNOWN ? 1 : 0; }
  template <class Visit>
  void visit_side(int node, std::size_t joint, unsigned side, const Visit& visit) const;
  template <class Visit>
  void visit_neighbours(int node, const Visit& visit) const;

  std::vector<Axis> axes_;
  std::vector<Node> nodes_;
  std::vector<Number> numbers_;
  std::array<std::vector<int>, DEEPEST + 1> waiting_;
  std::int64_t open_ = 0;  // number of cells that are not blocked
};

}  // namespace evenroad::infeasibility
