// Motions from one configuration to many, and one configuration in many scenes.
#include "robot_roadmap/visibility.hpp"

#include <bit>
#include <cmath>

#include "robot/obstacle_contact.hpp"

namespace evenroad::robot_roadmap {

using namespace robot;

namespace {

Mask meeting_walls(const Checker& walls, Places& places, Wanted wanted) {
  return meeting_obstacles(walls.robot(), walls.lengths(), walls.scene(), places, 0, wanted, nullptr);
}

/// Vectors to some rows: sixteen of them in each block of `dim` numbers in lanes.
struct RowsInLanes {
  std::size_t dim;
  std::vector<Doubles16> blocks;
  std::vector<std::int64_t> rows;

  std::span<Doubles16> block(std::size_t i) { return {&blocks[i / LANES * dim], dim}; }
};

RowsInLanes in_lanes(Matrix<const double> pool, std::span<const std::int64_t> rows) {
  RowsInLanes all{pool.columns, {}, {rows.begin(), rows.end()}};
  all.blocks.resize((rows.size() + LANES - 1) / LANES * all.dim);
  for (std::size_t i = 0; i < rows.size(); i++) {
    for (std::size_t k = 0; k < all.dim; k++) all.block(i)[k][i % LANES] = pool(rows[i], k);
  }
  return all;
}

/// Write the shortest ways from one configuration to rows, as `way_between` does.
void write_ways(const Bounds& bounds, std::span<const double> from, const RowsInLanes& to, RowsInLanes& ways) {
  ways.dim = to.dim, ways.rows = to.rows;
  ways.blocks.resize(to.blocks.size());
  for (std::size_t block = 0; block < to.blocks.size(); block += to.dim) {
    for (std::size_t k = 0; k < to.dim; k++) {
      Doubles16 way = to.blocks[block + k] - from[k];
      if (wraps(bounds, k)) {
        for (int lane = 0; lane < LANES; lane++) {
          way[lane] -= bounds.period[k] * std::rint(way[lane] / bounds.period[k]);
        }
      }
      ways.blocks[block + k] = way;
    }
  }
}

/// Keep the rows whose motions touch no wall at a share of their ways.
void keep_free(const Checker& walls, Workspace& workspace, std::span<const double> from, double share,
               RowsInLanes& ways) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < ways.rows.size(); first += LANES) {
    const std::span<const Doubles16> block = ways.block(first);
    for (std::size_t k = 0; k < ways.dim; k++) workspace.states[k] = from[k] + share * block[k];
    workspace.places.place(walls.robot(), walls.lengths(), workspace.states);
    const std::size_t lanes = std::min<std::size_t>(LANES, ways.rows.size() - first);
    Mask kept = ~meeting_walls(walls, workspace.places, Wanted::ALL) & (ALL_LANES >> (LANES - lanes));
    for (; kept != 0; kept &= kept - 1, count++) {
      const int lane = std::countr_zero(kept);
      for (std::size_t k = 0; k < ways.dim; k++) ways.block(count)[k][count % LANES] = block[k][lane];
      ways.rows[count] = ways.rows[first + lane];
    }
  }
  ways.rows.resize(count);
}

/// Return whether sixteen states spread over a motion, its end the last, touch neither walls nor anything else.
bool is_free(const Checker& walls, Workspace& workspace, std::span<const double> from, RowsInLanes& ways,
             std::size_t i) {
  Doubles16 share;
  for (int lane = 0; lane < LANES; lane++) share[lane] = (lane + 1) / static_cast<double>(LANES);
  for (std::size_t k = 0; k < from.size(); k++) {
    workspace.states[k] = from[k] + share * ways.block(i)[k][i % LANES];
  }
  workspace.places.place(walls.robot(), walls.lengths(), workspace.states);
  return meeting_walls(walls, workspace.places, Wanted::FIRST) == 0 &&
         blocked_where_placed(workspace, Wanted::FIRST) == 0;
}

}  // namespace

Joined rows_joined(std::span<const HardQuery> queries, const Checker& inside, Matrix<const double> pool,
                   std::span<const std::int64_t> rows, std::span<const double> early) {
  Joined joined;
  const Borrowed workspace = inside.borrow();
  const RowsInLanes to = in_lanes(pool, rows);
  RowsInLanes ways;
  for (const auto& [walls, from] : queries) {
    const std::size_t before = joined.rows.size();
    if (!walls.is_never_free() && !inside.is_never_free()) {
      write_ways(inside.robot().bounds, pool[from], to, ways);
      for (const double share : early) keep_free(walls, *workspace, pool[from], share, ways);
      for (std::size_t i = 0; i < ways.rows.size(); i++) {
        const bool is_itself = ways.rows[i] == static_cast<std::int64_t>(from);
        if (!is_itself && is_free(walls, *workspace, pool[from], ways, i)) joined.rows.push_back(ways.rows[i]);
      }
    }
    joined.counts.push_back(static_cast<std::int64_t>(joined.rows.size() - before));
  }
  return joined;
}

std::vector<std::int32_t> scenes_free(std::span<const Checker* const> checkers, Matrix<const double> rows) {
  std::vector<std::int32_t> free(rows.rows);
  if (checkers.empty() || rows.rows == 0) return free;
  const Borrowed workspace = checkers[0]->borrow();
  const Robot& robot = checkers[0]->robot();
  for (std::size_t first = 0; first < rows.rows; first += LANES) {
    const std::size_t count = std::min<std::size_t>(LANES, rows.rows - first);
    const Mask outside = take_rows(*workspace, rows, first, count);
    workspace->places.place(robot, *workspace->lengths, workspace->states);
    for (const Checker* checker : checkers) {
      const Mask touching =
          checker->is_never_free() ? ALL_LANES : meeting_walls(*checker, workspace->places, Wanted::ALL);
      for (std::size_t lane = 0; lane < count; lane++) free[first + lane] += ((outside | touching) >> lane & 1) == 0;
    }
  }
  return free;
}

}  // namespace evenroad::robot_roadmap
