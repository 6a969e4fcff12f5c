// Paths to far goals: the path over the coarse level is followed in legs, each a search of cells between two portals.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "world/corridor.hpp"
#include "world/lattice_path.hpp"

namespace evenroad::world {

namespace {

/// Distance from which a goal counts as far, because a search of all cells takes longer [pixels].
constexpr double FAR = 1000.0;
/// Least number of portals of a leg.
constexpr std::size_t LEG = 8;
/// Largest length of a path through undecided cells that is tried, as a share of the path through free cells.
constexpr double SHORTER = 0.97;

Cell cell_of(const Disk& disk, Point map) {
  const Point at = disk.frame().to_padded(map);
  return {static_cast<std::int32_t>(at.y), static_cast<std::int32_t>(at.x)};
}

bool is_far(const Disk& disk, Point start, std::span<const Point> goals) {
  const Point from = disk.frame().to_padded(start);
  return disk.is_inside(from) && std::all_of(goals.begin(), goals.end(), [&](Point goal) {
           const Point to = disk.frame().to_padded(goal);
           return disk.is_inside(to) && std::hypot(to.x - from.x, to.y - from.y) > FAR;
         });
}

/// Follows coarse paths, and sums their costs.
class Follower {
 public:
  Follower(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most)
      : disk_(disk), start_(start), goals_(goals), most_(most), corridor_(disk) {}

  /// Return the path along a coarse path; without points if that leads through a gap that is too narrow.
  LatticePath follow(const CoarsePath& coarse) {
    const Point goal = goals_[coarse.goal];
    found_.points = {start_};
    Cell last = cell_of(disk_, start_);
    for (std::size_t begin = 0; begin <= coarse.portals.size();) {
      const std::size_t end = end_of_leg(coarse, begin);
      const bool is_last = end == coarse.portals.size();
      corridor_.clear();
      corridor_.add(last);
      for (std::size_t i = begin; i < std::min(end + 1, coarse.portals.size()); i++) {
        const Cell at = coarse.portals[i];
        corridor_.add(at), corridor_.add({at.row + 1, at.column}), corridor_.add({at.row, at.column + 1});
      }
      if (is_last) corridor_.add(cell_of(disk_, goal));
      if (!reach(is_last ? goal : centre(coarse.portals[end]))) return none();
      last = coarse.portals[std::min(end, coarse.portals.size() - 1)];
      begin = end + 1;
    }
    LatticePath found = none();
    found.goal = static_cast<std::int64_t>(coarse.goal), found.points = std::move(found_.points);
    return found;
  }

  /// No path, and the cost of the search.
  LatticePath none() const { return {{}, -1, found_.expanded, found_.motions}; }
  std::int64_t left() const { return most_ - found_.motions; }

 private:
  Point centre(Cell at) const {
    return disk_.frame().to_map({static_cast<double>(at.column) + 0.5, static_cast<double>(at.row) + 0.5});
  }

  /// Return the portal at which a leg ends, which is free; the number of portals at the goal.
  std::size_t end_of_leg(const CoarsePath& coarse, std::size_t begin) const {
    std::size_t end = begin + LEG - 1;
    while (end < coarse.portals.size() && disk_.cell(coarse.portals[end].row, coarse.portals[end].column) < FREE) end++;
    return end + LEG / 2 < coarse.portals.size() ? end : coarse.portals.size();
  }

  /// Continue to a point in the corridor; return whether there is a path.
  bool reach(Point to) {
    const std::array<Point, 1> goal = {to};
    const LatticePath leg = search_cells(disk_, found_.points.back(), goal, left(), &corridor_);
    found_.expanded += leg.expanded, found_.motions += leg.motions;
    for (const Point& each : leg.points) {
      const Point& before = found_.points.back();
      if (each.x != before.x || each.y != before.y) found_.points.push_back(each);
    }
    return leg.goal == 0;
  }

  const Disk& disk_;
  Point start_;
  std::span<const Point> goals_;
  std::int64_t most_;
  Corridor corridor_;
  LatticePath found_;
};

std::vector<Cell> cells_of(const Disk& disk, std::span<const Point> points) {
  std::vector<Cell> cells;
  for (const Point point : points) cells.push_back(cell_of(disk, point));
  return cells;
}

LatticePath find_far(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most) {
  Follower follower(disk, start, goals, most);
  const Cell from = cell_of(disk, start);
  const std::vector<Cell> to = cells_of(disk, goals);
  const std::optional<CoarsePath> any = find_coarse_path(disk, Open::NOT_BLOCKED, from, to);
  if (!any) return {{}, -1, 0, 0, true};
  const std::optional<CoarsePath> sure = find_coarse_path(disk, Open::SURELY_FREE, from, to);
  if (!sure || any->length < SHORTER * sure->length) {
    if (LatticePath found = follower.follow(*any); found.goal >= 0) return found;
  }
  return sure ? follower.follow(*sure) : follower.none();
}

}  // namespace

bool may_reach(const Disk& disk, Point start, std::span<const Point> goals) {
  const auto is_inside = [&](Point at) { return disk.is_inside(disk.frame().to_padded(at)); };
  if (!has_coarse_level(disk) || !is_inside(start) || !std::all_of(goals.begin(), goals.end(), is_inside)) return true;
  return find_coarse_path(disk, Open::NOT_BLOCKED, cell_of(disk, start), cells_of(disk, goals)).has_value();
}

LatticePath find_path(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most) {
  LatticePath far;
  if (has_coarse_level(disk) && is_far(disk, start, goals)) far = find_far(disk, start, goals, most);
  if (far.goal >= 0 || far.is_apart || far.motions >= most) return far;
  LatticePath found = search_cells(disk, start, goals, most - far.motions, nullptr);
  found.expanded += far.expanded, found.motions += far.motions;
  return found;
}

}  // namespace evenroad::world
