// A* over the portals; tiles are made when the search reaches them.
#include "world/coarse_path.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include "common/time_limit.hpp"

namespace evenroad::world {

namespace {

/// A* over the portals: each is a run of the bottom or right border of a tile.
class CoarseSearch {
 public:
  CoarseSearch(const Disk& disk, Open open, std::span<const Cell> goals)
      : tiles_(disk, open), goals_(goals), first_(2 * tiles_.count(), -1) {}

  std::optional<CoarsePath> run(Cell start) {
    const std::int64_t tile = tiles_.tile_of(start);
    for (const Cell goal : goals_) goal_parts_.push_back(tiles_.part_at(goal));
    const std::int16_t part = tiles_.part_at(start);
    if (part < 0) return std::nullopt;
    leave(tile, part, -1, start, 0.0);
    ClockWatch clock(8);
    while (!queue_.empty()) {
      clock.look();
      const Waiting next = queue_.top();
      queue_.pop();
      if (next.node < 0) return traced(next);
      Portal& portal = portals_[next.node];
      if (portal.is_closed) continue;
      portal.is_closed = true;
      const double cost = portal.cost;
      const Cell at = portal.middle;
      const auto [near, border, run] = portal.at;
      const std::int64_t far = tiles_.beyond(near, border);
      leave(near, tiles_.divided(near).runs[border][run].part, next.node, at, cost);
      leave(far, tiles_.divided(far).runs[border - BOTTOM][run].part, next.node, at, cost);
    }
    return std::nullopt;
  }

 private:
  struct OnBorder {
    std::int64_t tile;
    int border;
    std::size_t run;
  };
  struct Portal {
    OnBorder at;
    Cell middle;
    double cost;
    std::int32_t before;
    bool is_closed;
  };
  struct Waiting {
    double key;
    /// A portal, or -1 - goal with the portal before it.
    std::int32_t node, before;
    bool operator<(const Waiting& other) const {
      return key != other.key ? key > other.key : node != other.node ? node > other.node : before > other.before;
    }
  };

  static double distance(Cell a, Cell b) {
    return std::hypot(static_cast<double>(a.row - b.row), static_cast<double>(a.column - b.column));
  }

  double bound(Cell at) const {
    double least = 1e300;
    for (const Cell goal : goals_) least = std::min(least, distance(at, goal));
    return least;
  }

  /// Expand all portals of a part of a tile, and goals in it.
  void leave(std::int64_t number, std::int16_t part, std::int32_t from, Cell at, double spent) {
    for (std::size_t goal = 0; goal < goals_.size(); goal++) {
      if (goal_parts_[goal] != part || tiles_.tile_of(goals_[goal]) != number) continue;
      queue_.push({spent + distance(at, goals_[goal]), -1 - static_cast<std::int32_t>(goal), from});
    }
    const CoarseTile& tile = tiles_.divided(number);
    for (int border = 0; border < BORDERS; border++) {
      const std::vector<BorderRun>& runs = tile.runs[border];
      if (runs.empty()) continue;
      const std::int32_t first = first_portal(number, border, runs);
      for (std::size_t run = 0; run < runs.size(); run++) {
        if (runs[run].part != part) continue;
        const std::int32_t node = first + static_cast<std::int32_t>(run);
        Portal& portal = portals_[node];
        const double cost = spent + distance(at, portal.middle);
        if (portal.is_closed || cost >= portal.cost) continue;
        portal.cost = cost, portal.before = from;
        queue_.push({cost + bound(portal.middle), node, -1});
      }
    }
  }

  /// Return the number of the first portal of a border; its runs are the same on both sides.
  std::int32_t first_portal(std::int64_t number, int border, const std::vector<BorderRun>& runs) {
    const bool is_own = border >= BOTTOM;
    const std::int64_t owner = is_own ? number : tiles_.beyond(number, border);
    const int own = is_own ? border : border + BOTTOM;
    std::int32_t& first = first_[2 * owner + own - BOTTOM];
    if (first >= 0) return first;
    first = static_cast<std::int32_t>(portals_.size());
    for (std::size_t run = 0; run < runs.size(); run++) {
      portals_.push_back({{owner, own, run}, tiles_.middle(owner, own, runs[run]), 1e300, -1, false});
    }
    return first;
  }

  CoarsePath traced(const Waiting& last) const {
    CoarsePath path{{}, last.key, static_cast<std::size_t>(-1 - last.node)};
    for (std::int32_t node = last.before; node >= 0; node = portals_[node].before) {
      path.portals.push_back(portals_[node].middle);
    }
    std::reverse(path.portals.begin(), path.portals.end());
    return path;
  }

  CoarseTiles tiles_;
  std::span<const Cell> goals_;
  std::vector<std::int16_t> goal_parts_;
  /// The first portal of the bottom and right borders of each tile, -1 before they are visited.
  std::vector<std::int32_t> first_;
  std::vector<Portal> portals_;
  std::priority_queue<Waiting> queue_;
};

}  // namespace

bool has_coarse_level(const Disk& disk) {
  return disk.reach() <= MOST_REACH &&
         2.0 * disk.radius() <= static_cast<double>(std::min(disk.rows(), disk.columns()));
}

std::optional<CoarsePath> find_coarse_path(const Disk& disk, Open open, Cell start, std::span<const Cell> goals) {
  return CoarseSearch(disk, open, goals).run(start);
}

}  // namespace evenroad::world
