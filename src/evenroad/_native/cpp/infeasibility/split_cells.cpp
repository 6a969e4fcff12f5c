// A tree of halves below each cell of a grid, and searches by levels over cells that share a side.
#include "infeasibility/split_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/time_limit.hpp"

namespace evenroad::infeasibility {

namespace {

constexpr int FAR = std::numeric_limits<int>::max() / 4;
constexpr int CELLS_A_LOOK = 1024;  // number of cells between two looks at the clock

}  // namespace

SplitCells::SplitCells(std::vector<Axis> axes) : axes_(std::move(axes)) {
  std::int64_t all = 1;
  for (const Axis& axis : axes_) all *= axis.count;
  Number number{};
  for (std::int64_t i = 0; i < all; i++) {
    add(0, number);
    for (std::size_t k = joints(); k-- > 0;) {
      if (++number[k] < axes_[k].count) break;
      number[k] = 0;
    }
  }
}

bool SplitCells::are_decided() const {
  return std::ranges::all_of(waiting_, [](const auto& cells) { return cells.empty(); });
}

void SplitCells::add(int depth, const Number& number) {
  waiting_[static_cast<std::size_t>(depth)].push_back(static_cast<int>(nodes_.size()));
  nodes_.push_back({-1, depth, Cell::WAITING});
  numbers_.push_back(number);
}

OwnMatrix<double> SplitCells::middles(int depth) const {
  const std::span<const int> cells = waiting(depth);
  OwnMatrix<double> rows(cells.size(), joints());
  for (std::size_t k = 0; k < joints(); k++) {
    const double size = std::ldexp(axes_[k].size, -depth);
    for (std::size_t i = 0; i < cells.size(); i++) {
      rows(i, k) = axes_[k].low + (static_cast<double>(numbers_[static_cast<std::size_t>(cells[i])][k]) + 0.5) * size;
    }
  }
  return rows;
}

void SplitCells::decide(int depth, std::span<const bool> unblocked, std::span<const bool> clear) {
  std::vector<int>& cells = waiting_[static_cast<std::size_t>(depth)];
  for (std::size_t i = 0; i < cells.size(); i++) {
    const Cell open = clear[i] ? Cell::CLEAR : Cell::UNKNOWN;
    nodes_[static_cast<std::size_t>(cells[i])].state = unblocked[i] ? open : Cell::BLOCKED;
    open_ += unblocked[i] ? 1 : 0;
  }
  cells.clear();
}

/// Return the cell with a number among those of a depth, or the larger cell that holds it.
int SplitCells::node_at(const Number& number, int depth) const {
  std::int64_t node = 0;
  for (std::size_t k = 0; k < joints(); k++) node = node * axes_[k].count + (number[k] >> depth);
  for (int level = depth - 1; level >= 0 && nodes_[static_cast<std::size_t>(node)].children >= 0; level--) {
    std::int64_t corner = 0;
    for (std::size_t k = 0; k < joints(); k++) corner = 2 * corner + (number[k] >> level & 1);
    node = nodes_[static_cast<std::size_t>(node)].children + corner;
  }
  return static_cast<int>(node);
}

/// Return the cell that holds some values and is not blocked, or -1.
int SplitCells::find(std::span<const double> values) const {
  Number number{};
  for (std::size_t k = 0; k < joints(); k++) {
    const Axis& axis = axes_[k];
    double above = values[k] - axis.low;
    if (std::isfinite(axis.period)) above -= std::floor(above / axis.period) * axis.period;
    const double at = std::floor(above / axis.size);
    // Rounding must not put values on the boundary outside.
    if (!(at >= -1.0 && at <= static_cast<double>(axis.count))) return -1;
    const std::int64_t last = (axis.count << DEEPEST) - 1;
    const std::int64_t fine = std::llround(std::floor(std::ldexp(above / axis.size, DEEPEST)));
    number[k] = static_cast<std::int32_t>(std::clamp<std::int64_t>(fine, 0, last));
  }
  const int node = node_at(number, DEEPEST);
  return nodes_[static_cast<std::size_t>(node)].state == Cell::BLOCKED ? -1 : node;
}

/// Visit the cells below one that lie at one of its two sides along a joint.
template <class Visit>
void SplitCells::visit_side(int node, std::size_t joint, unsigned side, const Visit& visit) const {
  const Node& here = nodes_[static_cast<std::size_t>(node)];
  if (here.children < 0) {
    if (here.state != Cell::BLOCKED) visit(node);
    return;
  }
  const unsigned bit = static_cast<unsigned>(joints() - 1 - joint);
  for (unsigned corner = 0; corner < 1U << joints(); corner++) {
    if ((corner >> bit & 1U) == side) visit_side(here.children + static_cast<int>(corner), joint, side, visit);
  }
}

/// Visit the cells that share a side with a cell and are not blocked.
template <class Visit>
void SplitCells::visit_neighbours(int node, const Visit& visit) const {
  const int depth = nodes_[static_cast<std::size_t>(node)].depth;
  const Number& own = numbers_[static_cast<std::size_t>(node)];
  for (std::size_t k = 0; k < joints(); k++) {
    const auto count = static_cast<std::int32_t>(axes_[k].count << depth);
    for (const int step : {-1, 1}) {
      Number beside = own;
      beside[k] += step;
      if (axes_[k].whole) beside[k] = (beside[k] + count) % count;
      if (beside[k] >= 0 && beside[k] < count) visit_side(node_at(beside, depth), k, step > 0 ? 0 : 1, visit);
    }
  }
}

/// Return the fewest unknown cells on paths from some cells to each, itself included, FAR beyond `most`.  If there are
/// cells to go to, the search ends at those that are worth splitting.
std::vector<int> SplitCells::fewest_unknown(std::span<const int> from, std::int64_t most,
                                            std::span<const int> until) const {
  std::vector<int> fewest(nodes_.size(), FAR), now(from.begin(), from.end()), next;
  for (const int node : from) fewest[static_cast<std::size_t>(node)] = 0;
  ClockWatch clock(CELLS_A_LOOK);
  for (int level = 0; level <= most && !now.empty(); level++) {
    while (!now.empty()) {
      const int node = now.back();
      now.pop_back();
      clock.look();
      visit_neighbours(node, [&](int other) {
        const int at = level + cost(other);
        if (at >= fewest[static_cast<std::size_t>(other)]) return;
        fewest[static_cast<std::size_t>(other)] = at;
        (at == level ? now : next).push_back(other);
      });
    }
    std::swap(now, next);
    for (const int node : until) {
      const int reached = fewest[static_cast<std::size_t>(node)];
      if (reached <= level) most = std::min(most, SPLIT_OF * (reached - cost(node)) + 2);
    }
  }
  return fewest;
}

Ended SplitCells::search(std::span<const double> start, Matrix<const double> goals, std::int64_t most) {
  const std::vector<int> from{find(start)};
  std::vector<int> to;
  for (std::size_t g = 0; g < goals.rows; g++) to.push_back(find(goals[g]));
  // A free configuration outside of all cells contradicts the checks.
  if (from[0] < 0 || to.empty() || std::ranges::min(to) < 0) return Ended::UNDECIDED;
  const std::vector<int> away = fewest_unknown(from, FAR, to);
  int least = FAR;
  bool is_joined = false;
  for (const int node : to) {
    const int reached = away[static_cast<std::size_t>(node)];
    least = std::min(least, std::max(reached - cost(node), 0));
    // The cells of the start and of the goal are clear, too.
    is_joined |= reached == 0 && cost(from[0]) == 0 && cost(node) == 0;
  }
  if (least >= FAR - 1) return Ended::APART;
  if (is_joined) return Ended::JOINED;
  const std::int64_t limit = SPLIT_OF * least + 1;
  const std::vector<int> left = fewest_unknown(to, limit + 1, {});
  std::vector<int> cells;
  for (std::size_t node = 0; node < nodes_.size(); node++) {
    const Node& here = nodes_[node];
    if (here.state != Cell::UNKNOWN || here.children >= 0 || here.depth >= DEEPEST) continue;
    if (std::int64_t{away[node]} + left[node] - 1 <= limit) cells.push_back(static_cast<int>(node));
  }
  return split(cells, most);
}

/// Split cells, unless there are none or more than `most` would be left.
Ended SplitCells::split(std::span<const int> cells, std::int64_t most) {
  const int corners = 1 << joints();
  if (cells.empty() || open_ + (corners - 1) * static_cast<std::int64_t>(cells.size()) > most) return Ended::UNDECIDED;
  for (const int node : cells) {
    const Number own = numbers_[static_cast<std::size_t>(node)];
    const int depth = nodes_[static_cast<std::size_t>(node)].depth;
    nodes_[static_cast<std::size_t>(node)].children = static_cast<int>(nodes_.size());
    for (int corner = 0; corner < corners; corner++) {
      Number number{};
      for (std::size_t k = 0; k < joints(); k++) number[k] = 2 * own[k] + (corner >> (joints() - 1 - k) & 1);
      add(depth + 1, number);
    }
  }
  open_ -= static_cast<std::int64_t>(cells.size());
  return Ended::SPLIT;
}

}  // namespace evenroad::infeasibility
