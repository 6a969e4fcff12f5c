#include "world/nearest_free.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/time_limit.hpp"

namespace evenroad::world {

namespace {

constexpr double INF = std::numeric_limits<double>::infinity();
/// Not on the sides of a cell, where rounding decides which cell they belong to.
constexpr double INSIDE = 1e-6;

double squared_distance(Point a, Point b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// The free point that was found, and its squared distance.
struct Best {
  Point at{};
  double squared = INF;
};

void look_at_cell(const Disk& disk, std::int64_t row, std::int64_t column, Point from, Best& best) {
  const std::uint8_t state = disk.cell(row, column);
  const auto left = static_cast<double>(column), top = static_cast<double>(row);
  if (state == BLOCKED) return;
  if (state >= FREE) {
    const Point near{std::min(std::max(from.x, left + INSIDE), left + 1.0 - INSIDE),
                     std::min(std::max(from.y, top + INSIDE), top + 1.0 - INSIDE)};
    if (const double squared = squared_distance(near, from); squared < best.squared) best = {near, squared};
    return;
  }
  for (int i = 0; i < 25; i++) {
    const int across = i % 5, down = i / 5;
    const Point near{left + 0.25 * across, top + 0.25 * down};
    const double squared = squared_distance(near, from);
    if (squared < best.squared && disk.is_free(near)) best = {near, squared};
  }
}

}  // namespace

NearestObstacle nearest_obstacle(const Disk& disk, Point at) {
  if (!disk.is_inside(at)) return {at, 0.0};
  const auto column = static_cast<std::int64_t>(at.x), row = static_cast<std::int64_t>(at.y);
  const Occupancy& occupancy = disk.occupancy();
  double best = INF;
  Point nearest = at;
  for (std::int64_t away = 0; away < disk.rows(); away++) {
    // Cells this many rows away are at a distance of at least away - 1.
    const double least = static_cast<double>(away) - 1.0;
    if (away > 1 && least * least >= best) break;
    const std::int64_t most =
        best < INF ? static_cast<std::int64_t>(std::sqrt(best)) + 1 : std::max(column, disk.columns() - 1 - column);
    for (const std::int64_t other : {row - away, row + away}) {
      if (other < 0 || other >= disk.rows()) continue;
      const auto top = static_cast<double>(other);
      Point near{at.x, std::min(std::max(at.y, top), top + 1.0)};
      if (const std::int64_t left = occupancy.to_left(other, column, most); left > 0) {
        const double before = static_cast<double>(column + 1 - left);
        const double after = static_cast<double>(column + occupancy.to_right(other, column, most));
        near.x = at.x - before <= after - at.x ? before : after;
      }
      if (const double squared = squared_distance(near, at); squared < best) best = squared, nearest = near;
    }
  }
  return {nearest, std::sqrt(best)};
}

std::optional<Point> nearest_free(const Disk& disk, Point at) {
  const std::int64_t last_row = disk.rows() - 2, last_column = disk.columns() - 2;
  // For NaN, or a point far outside, the nearest cell of the map.
  const auto cell = [](double along, std::int64_t last) {
    return along >= 1.0 ? static_cast<std::int64_t>(std::min(along, static_cast<double>(last))) : 1;
  };
  const std::int64_t column = cell(at.x, last_column), row = cell(at.y, last_row);
  Best best;
  for (std::int64_t ring = 0; ring < std::max(disk.rows(), disk.columns()); ring++) {
    if (ring > 1 && static_cast<double>(ring) - 1.0 > std::sqrt(best.squared)) break;
    look_at_clock();
    const std::int64_t bottom = std::min(row + ring, last_row);
    for (std::int64_t r = std::max<std::int64_t>(row - ring, 1); r <= bottom; r++) {
      const std::int64_t step = std::max<std::int64_t>(std::abs(r - row) == ring ? 1 : 2 * ring, 1);
      for (std::int64_t c = column - ring; c <= column + ring; c += step) {
        if (c >= 1 && c <= last_column) look_at_cell(disk, r, c, at, best);
      }
    }
  }
  return best.squared < INF ? std::optional<Point>(best.at) : std::nullopt;
}

}  // namespace evenroad::world
