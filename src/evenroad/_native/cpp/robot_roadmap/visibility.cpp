// Motions from one configuration to many, and one configuration in many scenes.
#include "robot_roadmap/visibility.hpp"

#include "robot/obstacle_contact.hpp"

namespace evenroad::robot_roadmap {

using namespace robot;

namespace {

Mask meeting_walls(const Checker& walls, Places& places, Wanted wanted) {
  return meeting_obstacles(walls.robot(), walls.lengths(), walls.scene(), places, 0, wanted, nullptr);
}

/// Keep of the rows those whose motions touch no wall at a share of their ways, (n, dim).
void keep_free(const Checker& walls, Workspace& workspace, std::span<const double> from, const OwnMatrix<double>& ways,
               double share, std::vector<std::size_t>& kept) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < kept.size(); first += LANES) {
    const std::size_t lanes = std::min<std::size_t>(LANES, kept.size() - first);
    for (std::size_t k = 0; k < from.size(); k++) {
      for (std::size_t lane = 0; lane < LANES; lane++) {
        workspace.states[k][lane] = from[k] + share * ways(kept[first + std::min(lane, lanes - 1)], k);
      }
    }
    workspace.places.place(walls.robot(), walls.lengths(), workspace.states);
    const Mask touching = meeting_walls(walls, workspace.places, Wanted::ALL);
    for (std::size_t lane = 0; lane < lanes; lane++) {
      if ((touching >> lane & 1) == 0) kept[count++] = kept[first + lane];
    }
  }
  kept.resize(count);
}

/// Return whether sixteen states spread over a motion, its end the last, touch neither walls nor anything else.
bool is_free(const Passage& passage, Workspace& workspace, std::span<const double> from, std::span<const double> way) {
  Doubles16 share;
  for (int lane = 0; lane < LANES; lane++) share[lane] = (lane + 1) / static_cast<double>(LANES);
  for (std::size_t k = 0; k < from.size(); k++) workspace.states[k] = from[k] + share * way[k];
  workspace.places.place(passage.inside.robot(), passage.inside.lengths(), workspace.states);
  return meeting_walls(passage.walls, workspace.places, Wanted::FIRST) == 0 &&
         blocked_where_placed(workspace, Wanted::FIRST) == 0;
}

}  // namespace

std::vector<std::int64_t> rows_joined(const Passage& passage, Matrix<const double> pool, std::size_t from,
                                      std::span<const std::int64_t> rows, std::span<const double> early) {
  std::vector<std::int64_t> joined;
  if (passage.walls.is_never_free() || passage.inside.is_never_free()) return joined;
  const Borrowed workspace = passage.inside.borrow();
  OwnMatrix<double> ways(rows.size(), pool.columns);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.size(); i++) {
    if (rows[i] == static_cast<std::int64_t>(from)) continue;
    way_between(pool[from], pool[rows[i]], passage.inside.robot().bounds, ways[i]);
    kept.push_back(i);
  }
  for (const double share : early) keep_free(passage.walls, *workspace, pool[from], ways, share, kept);
  for (const std::size_t i : kept) {
    if (is_free(passage, *workspace, pool[from], ways[i])) joined.push_back(rows[i]);
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
