// A search over intervals of the lines between rows of cells, each visible from a root at which the path turned last,
// after Anya (D. Harabor and A. Grastien, 2013).  Its least estimate never exceeds the shortest path through the cells.
//
// Coordinates are in the padded pixel plane.  A row's cells that are not blocked form runs; a path crosses from run to
// run.
#include "world/least_length.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_map>
#include <vector>

#include "common/time_limit.hpp"

namespace evenroad::world {

namespace {

constexpr double NEVER = std::numeric_limits<double>::infinity();

/// Bound of the rounding of a length, as a share.
constexpr double ROUNDING = 1e-9;

/// Cells of a row from one side to another, neighbours on both sides blocked.
struct Run {
  double left, right;
};

/// The part of a line that is visible from a root, before the run on its other side is entered.
struct Interval {
  double left, right;
  std::int64_t line;
  /// 1 towards higher rows, -1 towards lower ones.
  std::int64_t onward;
  Point root;
  /// The length of the path to the root, and a lower bound of the whole length.
  double length, estimate;

  bool operator<(const Interval& other) const { return estimate > other.estimate; }
};

/// Return whether padded coordinates are on the map or its border.  No path leads outside, and rows far outside have no
/// number.
bool is_on(const Disk& disk, Point at) {
  return 0.0 <= at.x && at.x <= static_cast<double>(disk.columns()) && 0.0 <= at.y &&
         at.y <= static_cast<double>(disk.rows());
}

class AnyAngleSearch {
 public:
  AnyAngleSearch(const Disk& disk, Point goal) : disk_(disk), goal_(goal), rows_(disk.rows()) {}

  double run(Point start, std::int64_t most) {
    if (begin(start)) return distance(start, goal_);
    ClockWatch clock(256);
    for (std::int64_t done = 0; !queue_.empty(); done++) {
      clock.look();
      const Interval next = queue_.top();
      if (done >= most) return next.estimate;
      queue_.pop();
      if (const auto known = roots_.find(key(next.root)); known != roots_.end() && next.length > known->second)
        continue;
      const Run& run = *run_at(row_beyond(next), next.left, next.right);
      if (holds_goal(row_beyond(next), run)) return next.estimate;
      expand(next, run);
    }
    return NEVER;
  }

 private:
  /// Put the lines around the start into the queue; return whether it is in one run with the goal.
  bool begin(Point start) {
    for (std::int64_t row = rows_below(start.y); static_cast<double>(row) <= start.y; row++) {
      for (const Run& run : runs(row)) {
        if (start.x < run.left || start.x > run.right) continue;
        if (holds_goal(row, run)) return true;
        cross({run.left, run.right, row, -1, start, 0.0, 0.0});
        cross({run.left, run.right, row + 1, 1, start, 0.0, 0.0});
      }
    }
    return false;
  }

  /// Return the first row that contains a coordinate, which may lie on a line between two.
  static std::int64_t rows_below(double y) { return static_cast<std::int64_t>(std::ceil(y)) - 1; }

  /// Return the row that is entered over an interval.
  static std::int64_t row_beyond(const Interval& at) { return at.onward > 0 ? at.line : at.line - 1; }

  bool holds_goal(std::int64_t row, const Run& run) const {
    return static_cast<double>(row) <= goal_.y && goal_.y <= static_cast<double>(row + 1) && run.left <= goal_.x &&
           goal_.x <= run.right;
  }

  const std::vector<Run>& runs(std::int64_t row) {
    static const std::vector<Run> NONE;
    if (row < 0 || row >= disk_.rows()) return NONE;
    Row& of = rows_[static_cast<std::size_t>(row)];
    if (of.is_made) return of.runs;
    of.is_made = true;
    const std::int64_t columns = disk_.columns();
    for (std::int64_t column = 0; column < columns; column++) {
      if (disk_.cell(row, column) == BLOCKED) continue;
      const std::int64_t first = column;
      while (column < columns && disk_.cell(row, column) != BLOCKED) column++;
      of.runs.push_back({static_cast<double>(first), static_cast<double>(column)});
    }
    return of.runs;
  }

  /// Return the run that an interval is part of.
  const Run* run_at(std::int64_t row, double left, double right) {
    const std::vector<Run>& all = runs(row);
    const auto after = std::ranges::upper_bound(all, 0.5 * (left + right), {}, &Run::left);
    return &*std::prev(after);
  }

  /// Return whether the path may turn at a point of a line: at a corner of a blocked cell to the left, or to the right.
  bool is_corner(double x, std::int64_t line, bool is_left) const {
    const auto column = static_cast<std::int64_t>(x);
    if (static_cast<double>(column) != x) return false;
    const std::int64_t beside = is_left ? column - 1 : column;
    return is_blocked(line - 1, beside) || is_blocked(line, beside);
  }

  bool is_blocked(std::int64_t row, std::int64_t column) const {
    return row < 0 || row >= disk_.rows() || column < 0 || column >= disk_.columns() ||
           disk_.cell(row, column) == BLOCKED;
  }

  /// Project an interval to the other side of a run, and turn around its ends if these are corners.
  void expand(const Interval& at, const Run& run) {
    const auto y = static_cast<double>(at.line);
    const double across = y - at.root.y;
    double left, right;
    if (across != 0.0) {
      const double times = (y + static_cast<double>(at.onward) - at.root.y) / across;
      left = at.root.x + times * (at.left - at.root.x), right = at.root.x + times * (at.right - at.root.x);
    } else {
      left = at.root.x < at.left ? NEVER : -NEVER, right = at.root.x > at.right ? -NEVER : NEVER;
    }
    Interval next{
        std::max(left, run.left), std::min(right, run.right), at.line + at.onward, at.onward, at.root, at.length, 0.0};
    cross(next);
    for (const bool is_left : {true, false}) {
      const double x = is_left ? at.left : at.right;
      if (!is_corner(x, at.line, is_left) || !turn(at, {x, y}, next)) continue;
      next.left = is_left ? run.left : std::max(right, run.left);
      next.right = is_left ? std::min(left, run.right) : run.right;
      next.line = at.line + at.onward, next.onward = at.onward;
      cross(next);
      // Around the corner and back over the line.
      next.left = is_left ? run.left : x, next.right = is_left ? x : run.right;
      next.line = at.line, next.onward = -at.onward;
      cross(next);
    }
  }

  /// Make a corner the root of later intervals; return whether no shorter path to it is known.
  bool turn(const Interval& at, Point corner, Interval& next) {
    next.root = corner, next.length = at.length + distance(at.root, corner);
    const auto [known, is_new] = roots_.try_emplace(key(corner), next.length);
    if (!is_new && known->second < next.length) return false;
    known->second = next.length;
    return true;
  }

  /// Put the visible part of a line into the queue, one interval for each run beyond it.
  void cross(Interval seen) {
    if (!(seen.left < seen.right)) return;
    const std::vector<Run>& all = runs(row_beyond(seen));
    const double left = seen.left, right = seen.right;
    auto run = std::ranges::upper_bound(all, left, {}, &Run::left);
    if (run != all.begin()) run--;
    for (; run != all.end() && run->left < right; run++) {
      seen.left = std::max(left, run->left), seen.right = std::min(right, run->right);
      if (!(seen.left < seen.right)) continue;
      seen.estimate = estimate(seen);
      queue_.push(seen);
    }
  }

  /// Return the least length of a path over an interval, with nothing blocked beyond it.
  double estimate(const Interval& seen) const {
    const auto y = static_cast<double>(seen.line);
    Point goal = goal_;
    // A goal on this side is as far as its mirror image.
    if ((goal.y - y) * static_cast<double>(seen.onward) < 0.0) goal.y = 2.0 * y - goal.y;
    const double before = std::abs(y - seen.root.y), after = std::abs(goal.y - y);
    double x = seen.root.x;
    if (before + after > 0.0) x += (goal.x - seen.root.x) * before / (before + after);
    const Point over{std::clamp(x, seen.left, seen.right), y};
    return seen.length + distance(seen.root, over) + distance(over, goal);
  }

  std::int64_t key(Point root) const {
    return static_cast<std::int64_t>(root.y) * (disk_.columns() + 1) + static_cast<std::int64_t>(root.x);
  }

  struct Row {
    bool is_made = false;
    std::vector<Run> runs;
  };

  const Disk& disk_;
  Point goal_;
  std::vector<Row> rows_;
  std::priority_queue<Interval> queue_;
  /// The shortest paths to corners.
  std::unordered_map<std::int64_t, double> roots_;
};

}  // namespace

double least_length(const Disk& disk, Point start, Point goal, std::int64_t most) {
  const Frame& frame = disk.frame();
  const Point from = frame.to_padded(start), to = frame.to_padded(goal);
  if (!is_on(disk, from) || !is_on(disk, to)) return NEVER;
  const double least = AnyAngleSearch(disk, to).run(from, most) * frame.scale * (1.0 - ROUNDING);
  return std::max(least, distance(start, goal));
}

}  // namespace evenroad::world
