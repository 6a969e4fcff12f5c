#include "drive/disk_paths.hpp"

#include <limits>
#include <numbers>

#include "common/time_limit.hpp"

namespace evenroad::drive {

namespace {

constexpr std::int32_t FAR = std::numeric_limits<std::int32_t>::max();
/// Cost of a straight step in the open, and of one into what is shut; a diagonal one costs more.
constexpr std::int32_t STEP = 16, DIAGONAL = 22;
constexpr std::uint8_t SHUT = 255;
/// More than what any step costs.
constexpr std::size_t BUCKETS = 128;
/// Side of a cell, as a share of the disk's radius.
constexpr double SIDE = 0.5;
/// A disk walks over cells to its eight neighbours: 8 % longer than straight at most.
constexpr double STRAIGHTER = 0.92;
/// What a unit of length costs more at an obstacle, and distance from which on it costs no more, in radii of the disk.
constexpr double NEARNESS = 2.0, NEAR = 2.5;
/// The direction of travel is that between the points this many before and behind.
constexpr std::size_t AROUND = 2;
/// Largest number of cells.
constexpr double MOST_CELLS = 4e6;
/// Obstacles beyond this many rows and columns do not count.
constexpr std::int64_t MOST_REACH = 1000;

std::int64_t stride_for(const Vehicle& vehicle) {
  const double least =
      std::sqrt(static_cast<double>(vehicle.rows()) * static_cast<double>(vehicle.columns()) / MOST_CELLS);
  return static_cast<std::int64_t>(std::max(std::ceil(least), SIDE * vehicle.footprint().inner.radius));
}

}  // namespace

DiskPaths::DiskPaths(const Vehicle& vehicle, const Pose& start, const Pose& goal)
    : vehicle_(vehicle),
      centre_(vehicle.footprint().inner.centres[0]),
      stride_(stride_for(vehicle)),
      rows_(vehicle.rows() / stride_ + 1),
      columns_(vehicle.columns() / stride_ + 1),
      start_(cell_of(start)),
      goal_(cell_of(goal)) {}

double DiskPaths::length_from(const Pose& pose) {
  const std::int32_t cell = cell_of(pose);
  if (!reach(cell)) return std::numeric_limits<double>::infinity();
  return std::max(STRAIGHTER * cells_[cell].length - 3.0 * static_cast<double>(stride_), 0.0);
}

std::vector<Pose> DiskPaths::route_from(const Pose& pose) {
  std::int32_t cell = cell_of(pose);
  std::vector<Pose> route;
  if (!reach(cell)) return route;
  std::vector<Vec> points;
  for (; cell != goal_; cell = cells_[cell].next) points.push_back(middle_of(cell));
  for (std::size_t i = 0; i < points.size() && points.size() > 1; i++) {
    const Vec by = points[std::min(i + AROUND, points.size() - 1)] - points[i - std::min(i, AROUND)];
    const double angle = std::atan2(by.y, by.x);
    const Vec at = points[i] - Placed({0.0, 0.0, angle})(centre_);
    route.push_back({at.x, at.y, angle});
  }
  return route;
}

std::int32_t DiskPaths::cell_of(const Pose& pose) const {
  const Vec at = Placed(pose)(centre_);
  const auto row = std::clamp<std::int64_t>(static_cast<std::int64_t>(at.y) / stride_, 0, rows_ - 1);
  const auto column = std::clamp<std::int64_t>(static_cast<std::int64_t>(at.x) / stride_, 0, columns_ - 1);
  return static_cast<std::int32_t>(row * columns_ + column);
}

Vec DiskPaths::middle_of(std::int32_t cell) const {
  const auto side = static_cast<double>(stride_);
  return {(static_cast<double>(cell % columns_) + 0.5) * side, (static_cast<double>(cell / columns_) + 0.5) * side};
}

/// A cell is open where the disk may be free somewhere in it.
std::uint8_t DiskPaths::weight_of(std::int64_t row, std::int64_t column) const {
  const world::Disk& disk = vehicle_.inner();
  const Vec at = middle_of(static_cast<std::int32_t>(row * columns_ + column));
  const auto last_row = static_cast<double>(vehicle_.rows()) - 0.5,
             last_column = static_cast<double>(vehicle_.columns()) - 0.5;
  const world::Point middle{std::min(at.x, last_column), std::min(at.y, last_row)};
  const double near = NEAR * disk.radius();
  const auto reach = static_cast<std::int64_t>(std::min(std::ceil(near), static_cast<double>(MOST_REACH)));
  const double gap = std::sqrt(
      disk.squared_gap(middle, static_cast<std::int64_t>(middle.y), static_cast<std::int64_t>(middle.x), reach, 0.0));
  if (gap + std::numbers::sqrt2 * 0.5 * static_cast<double>(stride_) < disk.radius()) return SHUT;
  return static_cast<std::uint8_t>(STEP * (1.0 + NEARNESS * std::max(0.0, 1.0 - gap / near)));
}

/// Return the least cost from a cell to the start.
std::int32_t DiskPaths::left_from(std::int64_t row, std::int64_t column) const {
  const std::int64_t rows = std::abs(row - start_ / columns_), columns = std::abs(column - start_ % columns_);
  const std::int64_t both = std::min(rows, columns);
  return static_cast<std::int32_t>(DIAGONAL * both + STEP * (std::max(rows, columns) - both));
}

/// Search until the way from a cell is known; return whether there is one.
bool DiskPaths::reach(std::int32_t cell) {
  if (cells_.empty()) {
    cells_.assign(rows_ * columns_, {FAR, goal_, 0.0F, false, 0});
    buckets_.resize(BUCKETS);
    cost_ = left_from(goal_ / columns_, goal_ % columns_);
    cells_[goal_].cost = 0, buckets_[cost_ % BUCKETS].push_back(goal_), waiting_ = 1;
  }
  ClockWatch clock(1024);
  while (!cells_[cell].is_done && waiting_ > 0) {
    std::vector<std::int32_t>& bucket = buckets_[cost_ % BUCKETS];
    if (bucket.empty()) {
      cost_++;
      continue;
    }
    const std::int32_t next = bucket.back();
    bucket.pop_back(), waiting_--;
    clock.look();
    if (!cells_[next].is_done) leave(next);
  }
  return cells_[cell].is_done;
}

/// Go on from a cell, whose way is known now, to its neighbours.
void DiskPaths::leave(std::int32_t cell) {
  cells_[cell].is_done = true;
  const std::int64_t row = cell / columns_, column = cell % columns_;
  for (std::int64_t r = std::max<std::int64_t>(row - 1, 0); r <= std::min(row + 1, rows_ - 1); r++) {
    for (std::int64_t c = std::max<std::int64_t>(column - 1, 0); c <= std::min(column + 1, columns_ - 1); c++) {
      const auto next = static_cast<std::int32_t>(r * columns_ + c);
      Cell& to = cells_[next];
      if (to.is_done) continue;
      if (to.weight == 0) to.weight = weight_of(r, c);
      if (to.weight == SHUT) continue;
      const std::int32_t step = r != row && c != column ? DIAGONAL : STEP;
      const std::int32_t cost = cells_[cell].cost + step * to.weight / STEP;
      if (cost >= to.cost) continue;
      to.cost = cost, to.next = cell;
      to.length = cells_[cell].length + static_cast<float>(step * stride_) / STEP;
      buckets_[(cost + left_from(r, c)) % BUCKETS].push_back(next), waiting_++;
    }
  }
}

}  // namespace evenroad::drive
