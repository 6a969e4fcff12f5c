// A tile is made when the search comes to it: 64 cells are told open or not at once, by bits.
#include "world/coarse_way.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <queue>

namespace evenroad::world {

namespace {

constexpr std::int64_t SIDE = std::int64_t{1} << COARSE_SHIFT;
/// Largest reach of a disk, in cells.
constexpr std::int64_t MOST_REACH = 60;

/// The cells of a tile, a word a row, its lowest bit the first column.
using Bits = std::array<std::uint64_t, SIDE>;

enum Border : std::uint8_t { TOP, LEFT, BOTTOM, RIGHT, BORDERS };

/// Cells of a border, from `first` to `last`, which are open on both sides, and what they hang together with inside.
struct BorderRun {
  std::uint8_t first, last;
  std::int16_t part;
};

struct Tile {
  Bits open;
  bool is_divided = false;
  /// What hangs together inside, and the runs of each border.
  std::vector<Bits> parts;
  std::array<std::vector<BorderRun>, BORDERS> runs;
};

/// How far to the sides the squares of a row reach that close a cell, by how many rows they are away; -1 where none do.
std::vector<std::int64_t> reaches(double radius, Open open) {
  std::vector<std::int64_t> reaches;
  const std::int64_t less = open == Open::SURELY_FREE ? 1 : 0;
  for (std::int64_t down = 0; down <= MOST_REACH + 2; down++) {
    const auto y = static_cast<double>(std::max<std::int64_t>(down - less, 0));
    std::int64_t reach = -1;
    for (std::int64_t right = 0; right <= MOST_REACH + 2; right++) {
      const auto x = static_cast<double>(std::max<std::int64_t>(right - less, 0));
      if (x * x + y * y < radius * radius) reach = right;
    }
    if (reach < 0) break;
    reaches.push_back(reach);
  }
  return reaches;
}

/// Return the bits of a mask that bits hang together with along a row.
std::uint64_t spread(std::uint64_t bits, std::uint64_t mask) {
  std::uint64_t up = mask, down = mask, left = bits, right = bits;
  for (int by = 1; by < SIDE; by *= 2) {
    left |= up & (left << by), up &= up << by;
    right |= down & (right >> by), down &= down >> by;
  }
  return left | right;
}

/// Take what hangs together with one bit out of a tile.
Bits take_part(Bits& open, std::int64_t row, std::uint64_t bit) {
  Bits part{};
  part[row] = spread(bit, open[row]);
  for (bool is_growing = true; is_growing;) {
    is_growing = false;
    const auto grow = [&](std::int64_t from, std::int64_t to) {
      const std::uint64_t more = part[from] & open[to] & ~part[to];
      if (more == 0) return;
      part[to] = spread(part[to] | more, open[to]);
      is_growing = true;
    };
    for (std::int64_t each = 1; each < SIDE; each++) grow(each - 1, each);
    for (std::int64_t each = SIDE - 1; each > 0; each--) grow(each, each - 1);
  }
  for (std::int64_t each = 0; each < SIDE; each++) open[each] &= ~part[each];
  return part;
}

std::uint64_t column_of(const Bits& bits, int column) {
  std::uint64_t word = 0;
  for (std::int64_t row = 0; row < SIDE; row++) word |= (bits[row] >> column & 1) << row;
  return word;
}

class Graph {
 public:
  Graph(const Disk& disk, Open open)
      : disk_(disk),
        reaches_(reaches(disk.radius(), open)),
        high_(((disk.rows() - 1) >> COARSE_SHIFT) + 1),
        wide_(((disk.columns() - 1) >> COARSE_SHIFT) + 1),
        tiles_(high_ * wide_) {}

  std::int64_t tile_of(Cell at) const { return (at.row >> COARSE_SHIFT) * wide_ + (at.column >> COARSE_SHIFT); }
  std::int64_t count() const { return high_ * wide_; }

  /// Return the tile behind a border, -1 where the map ends.
  std::int64_t beyond(std::int64_t tile, int border) const {
    const std::int64_t row = tile / wide_, column = tile % wide_;
    if (border == TOP) return row > 0 ? tile - wide_ : -1;
    if (border == LEFT) return column > 0 ? tile - 1 : -1;
    if (border == BOTTOM) return row + 1 < high_ ? tile + wide_ : -1;
    return column + 1 < wide_ ? tile + 1 : -1;
  }

  /// Return the cell in the middle of a run of a border of a tile, on its side.
  Cell middle(std::int64_t tile, int border, const BorderRun& run) const {
    const std::int64_t top = tile / wide_ << COARSE_SHIFT, left = tile % wide_ << COARSE_SHIFT;
    const std::int64_t along = (run.first + run.last) / 2;
    const std::int64_t row = border == TOP ? 0 : border == BOTTOM ? SIDE - 1 : along;
    const std::int64_t column = border == LEFT ? 0 : border == RIGHT ? SIDE - 1 : along;
    return {static_cast<std::int32_t>(top + row), static_cast<std::int32_t>(left + column)};
  }

  /// Return a tile with its parts and the runs of its borders.
  const Tile& divided(std::int64_t number) {
    Tile& tile = opened(number);
    if (tile.is_divided) return tile;
    tile.is_divided = true;
    Bits left = tile.open;
    for (std::int64_t row = 0; row < SIDE; row++) {
      while (left[row] != 0) tile.parts.push_back(take_part(left, row, left[row] & -left[row]));
    }
    for (int border = 0; border < BORDERS; border++) {
      const std::int64_t other = beyond(number, border);
      if (other < 0) continue;
      const std::uint64_t both = outermost(tile.open, border) & outermost(opened(other).open, (border + 2) % BORDERS);
      for (std::uint64_t rest = both; rest != 0;) {
        const int first = std::countr_zero(rest), length = std::countr_one(rest >> first);
        const BorderRun run{static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(first + length - 1), 0};
        rest = first + length >= SIDE ? 0 : rest >> (first + length) << (first + length);
        tile.runs[border].push_back({run.first, run.last, part_of(tile, inside(middle(number, border, run)))});
      }
    }
    return tile;
  }

  /// Return the part that a cell is in, -1 of none.
  std::int16_t part_at(Cell at) { return part_of(divided(tile_of(at)), inside(at)); }

 private:
  static Cell inside(Cell at) {
    return {at.row & static_cast<std::int32_t>(SIDE - 1), at.column & static_cast<std::int32_t>(SIDE - 1)};
  }

  static std::int16_t part_of(const Tile& tile, Cell inside) {
    for (std::size_t part = 0; part < tile.parts.size(); part++) {
      if ((tile.parts[part][inside.row] >> inside.column & 1) != 0) return static_cast<std::int16_t>(part);
    }
    return -1;
  }

  static std::uint64_t outermost(const Bits& bits, int border) {
    if (border == TOP || border == BOTTOM) return bits[border == TOP ? 0 : SIDE - 1];
    return column_of(bits, border == LEFT ? 0 : SIDE - 1);
  }

  /// Return a tile of which the open cells are known.
  Tile& opened(std::int64_t number) {
    std::unique_ptr<Tile>& tile = tiles_[number];
    if (tile != nullptr) return *tile;
    tile = std::make_unique<Tile>();
    const std::int64_t top = number / wide_ << COARSE_SHIFT, left = number % wide_ << COARSE_SHIFT;
    const std::int64_t reach = static_cast<std::int64_t>(reaches_.size()) - 1;
    std::array<std::uint64_t, MOST_REACH + 3> grown;
    Bits closed{};
    for (std::int64_t row = std::max<std::int64_t>(top - reach, 0); row < std::min(top + SIDE + reach, disk_.rows());
         row++) {
      grow_row(row, left, grown);
      const std::int64_t first = std::max(row - reach, top), last = std::min(row + reach, top + SIDE - 1);
      for (std::int64_t each = first; each <= last; each++) {
        closed[each - top] |= grown[reaches_[each < row ? row - each : each - row]];
      }
    }
    for (std::int64_t row = 0; row < SIDE; row++) tile->open[row] = top + row < disk_.rows() ? ~closed[row] : 0;
    return *tile;
  }

  /// Write the occupied cells of 64 columns of a row, with so many to both sides.
  void grow_row(std::int64_t row, std::int64_t left, std::array<std::uint64_t, MOST_REACH + 3>& grown) const {
    const Occupancy& occupancy = disk_.occupancy();
    const std::uint64_t here = occupancy.window(row, left);
    const std::uint64_t before = occupancy.window(row, left - SIDE);
    const std::uint64_t after = left + SIDE <= disk_.columns() ? occupancy.window(row, left + SIDE) : ~std::uint64_t{0};
    grown[0] = here;
    for (std::int64_t by = 1; by <= reaches_[0]; by++) {
      grown[by] = grown[by - 1] | here << by | before >> (SIDE - by) | here >> by | after << (SIDE - by);
    }
  }

  const Disk& disk_;
  std::vector<std::int64_t> reaches_;
  std::int64_t high_, wide_;
  std::vector<std::unique_ptr<Tile>> tiles_;
};

/// A* over the portals: each is a run of the bottom or right border of a tile.
class WaySearch {
 public:
  WaySearch(const Disk& disk, Open open, std::span<const Cell> goals)
      : graph_(disk, open), goals_(goals), first_(2 * graph_.count(), -1) {}

  std::optional<CoarseWay> run(Cell start) {
    const std::int64_t tile = graph_.tile_of(start);
    for (const Cell goal : goals_) goal_parts_.push_back(graph_.part_at(goal));
    const std::int16_t part = graph_.part_at(start);
    if (part < 0) return std::nullopt;
    leave(tile, part, -1, start, 0.0);
    while (!queue_.empty()) {
      const Waiting next = queue_.top();
      queue_.pop();
      if (next.node < 0) return traced(next);
      Portal& portal = portals_[next.node];
      if (portal.is_closed) continue;
      portal.is_closed = true;
      const double cost = portal.cost;
      const Cell at = portal.middle;
      const auto [near, border, run] = portal.place;
      const std::int64_t far = graph_.beyond(near, border);
      leave(near, graph_.divided(near).runs[border][run].part, next.node, at, cost);
      leave(far, graph_.divided(far).runs[border - BOTTOM][run].part, next.node, at, cost);
    }
    return std::nullopt;
  }

 private:
  struct Place {
    std::int64_t tile;
    int border;
    std::size_t run;
  };
  struct Portal {
    Place place;
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

  /// Go to all portals of a part of a tile, and to goals in it.
  void leave(std::int64_t number, std::int16_t part, std::int32_t from, Cell at, double spent) {
    for (std::size_t goal = 0; goal < goals_.size(); goal++) {
      if (goal_parts_[goal] != part || graph_.tile_of(goals_[goal]) != number) continue;
      queue_.push({spent + distance(at, goals_[goal]), -1 - static_cast<std::int32_t>(goal), from});
    }
    const Tile& tile = graph_.divided(number);
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

  /// Return the number of the first portal of a border, of which the runs are the same on both sides.
  std::int32_t first_portal(std::int64_t number, int border, const std::vector<BorderRun>& runs) {
    const bool is_own = border >= BOTTOM;
    const std::int64_t owner = is_own ? number : graph_.beyond(number, border);
    const int own = is_own ? border : border + BOTTOM;
    std::int32_t& first = first_[2 * owner + own - BOTTOM];
    if (first >= 0) return first;
    first = static_cast<std::int32_t>(portals_.size());
    for (std::size_t run = 0; run < runs.size(); run++) {
      portals_.push_back({{owner, own, run}, graph_.middle(owner, own, runs[run]), 1e300, -1, false});
    }
    return first;
  }

  CoarseWay traced(const Waiting& last) const {
    CoarseWay way{{}, last.key, static_cast<std::size_t>(-1 - last.node)};
    for (std::int32_t node = last.before; node >= 0; node = portals_[node].before) {
      way.portals.push_back(portals_[node].middle);
    }
    std::reverse(way.portals.begin(), way.portals.end());
    return way;
  }

  Graph graph_;
  std::span<const Cell> goals_;
  std::vector<std::int16_t> goal_parts_;
  /// The first portal of the bottom and right borders of each tile, -1 before they are looked at.
  std::vector<std::int32_t> first_;
  std::vector<Portal> portals_;
  std::priority_queue<Waiting> queue_;
};

}  // namespace

bool has_coarse_level(const Disk& disk) {
  return disk.reach() <= MOST_REACH &&
         2.0 * disk.radius() <= static_cast<double>(std::min(disk.rows(), disk.columns()));
}

std::optional<CoarseWay> find_coarse_way(const Disk& disk, Open open, Cell start, std::span<const Cell> goals) {
  return WaySearch(disk, open, goals).run(start);
}

}  // namespace evenroad::world
