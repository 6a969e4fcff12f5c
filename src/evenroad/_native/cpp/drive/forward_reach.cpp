#include "drive/forward_reach.hpp"

#include <algorithm>
#include <bit>

#include "common/time_limit.hpp"

namespace evenroad::drive {

namespace {

/// Largest turn of a drive [rad], and its largest length, in radii of the disk inside: it jumps over no obstacle.
constexpr double TURN = 0.35, LENGTH = 1.6;
/// Number of slices in that turn.  Rounding to slices turns a car by as much more as one of these.
constexpr double SLICES = 4.0;
constexpr std::int64_t MOST_SLICES = 720;
/// Number of squares along a drive, at least.
constexpr double SQUARES = 8.0;
/// Largest number of squares in a cell, along a side, and of boxes.
constexpr double MOST_IN_CELL = 4.0;
constexpr double MOST_SQUARES = 8e8;
/// Rounding of places.
constexpr double POSITION_ROUNDING = 1e-9;

}  // namespace

ForwardReach::ForwardReach(const Vehicle& vehicle, const Steering& steering)
    : vehicle_(vehicle),
      radius_(steering.radius),
      length_(std::min(TURN * radius_, LENGTH * vehicle.footprint().inner.radius)),
      // An even number: the opposite of a slice is one, too.
      count_(2 * std::min(MOST_SLICES / 2, static_cast<std::int64_t>(std::ceil(SLICES * PI * radius_ / length_)))),
      width_(2.0 * PI / static_cast<double>(count_)),
      side_(1.0 / std::clamp(std::ceil(SQUARES / length_), 1.0, MOST_IN_CELL)),
      rows_(static_cast<std::int64_t>(std::ceil(static_cast<double>(vehicle.rows()) / side_))),
      columns_(static_cast<std::int64_t>(std::ceil(static_cast<double>(vehicle.columns()) / side_))),
      slices_(vehicle, count_, {}),
      spans_(count_) {}

Apart ForwardReach::find(const Pose& start, const Pose& goal, std::int64_t most) {
  const bool is_inside = std::ranges::any_of(vehicle_.footprint().parts, [](const std::vector<Vec>& part) {
    for (std::size_t i = 0; i < part.size(); i++) {
      if (cross(part[(i + 1) % part.size()] - part[i], Vec{} - part[i]) < 0.0) return false;
    }
    return true;
  });
  // A reference point outside of the footprint may leave the map.
  const double boxes = static_cast<double>(count_) * static_cast<double>(rows_) * static_cast<double>(columns_);
  if (!is_inside || boxes > MOST_SQUARES) return Apart::UNKNOWN;
  const Apart from_start = flood(start, goal, false, most);
  return from_start == Apart::PROVED ? from_start : flood(goal, start, true, most);
}

/// Backwards, a car drives as one that is turned around does forwards.
ForwardReach::Box ForwardReach::box_of(const Pose& pose, bool is_backwards) const {
  const double turns = pose.angle / (2.0 * PI) + (is_backwards ? 0.5 : 0.0), share = turns - std::floor(turns);
  return {std::min(static_cast<std::int64_t>(share * static_cast<double>(count_)), count_ - 1),
          static_cast<std::int64_t>(pose.y / side_), static_cast<std::int64_t>(pose.x / side_)};
}

Apart ForwardReach::flood(const Pose& from, const Pose& to, bool is_backwards, std::int64_t most) {
  const Box first = box_of(from, is_backwards), last = box_of(to, is_backwards);
  const std::int64_t words = columns_ / 64 + 2;
  // Slices lie side by side: a drive ends in many of them.
  std::vector<std::uint64_t> seen(rows_ * words * count_, 0);
  std::vector<Box> boxes;
  const auto reach = [&](const Box& box, const std::vector<Span>& spans) {
    for (const Span& span : spans) {
      const std::int64_t slice = (box.slice + span.slice + count_) % count_, row = box.row + span.row;
      const std::int64_t begin = std::max<std::int64_t>(box.column + span.first, 0);
      const std::int64_t end = std::min(box.column + span.last, columns_ - 1);
      if (row < 0 || row >= rows_) continue;
      std::uint64_t* line = seen.data() + row * words * count_ + slice;
      const std::int64_t body = is_backwards ? (slice + count_ / 2) % count_ : slice;
      const auto cell_row = static_cast<std::int64_t>((static_cast<double>(row) + 0.5) * side_);
      for (std::int64_t left = begin; left <= end; left = (left | 63) + 1) {
        std::uint64_t& word = line[(left >> 6) * count_];
        const std::int64_t right = std::min(end, left | 63);
        std::uint64_t fresh = ~word & ~std::uint64_t{0} << (left & 63) & ~std::uint64_t{0} >> (63 - (right & 63));
        for (word |= fresh; fresh != 0; fresh &= fresh - 1) {
          const std::int64_t column = (left & ~std::int64_t{63}) + std::countr_zero(fresh);
          const auto cell = static_cast<std::int64_t>((static_cast<double>(column) + 0.5) * side_);
          if (slices_.is_open({body, cell_row, cell})) boxes.push_back({slice, row, column});
        }
      }
    }
  };
  const auto is_there = [&] {
    return (seen[(last.row * words + (last.column >> 6)) * count_ + last.slice] >> (last.column & 63) & 1) != 0;
  };
  // A drive that is shorter first: then whole ones lead to every pose of a path, and to its end.
  reach(first, make_spans(first.slice, true));
  ClockWatch clock(256);
  for (std::size_t next = 0; next < boxes.size(); next++) {
    if (is_there()) return Apart::JOINED;
    if (static_cast<std::int64_t>(next) >= most) return Apart::UNKNOWN;
    clock.look();
    const Box box = boxes[next];
    reach(box, spans_from(box.slice));
  }
  return is_there() ? Apart::JOINED : Apart::PROVED;
}

const std::vector<ForwardReach::Span>& ForwardReach::spans_from(std::int64_t slice) {
  if (spans_[slice].empty()) spans_[slice] = make_spans(slice, false);
  return spans_[slice];
}

/// Return what a drive does that turns by about that many slices: between one less and one more.
///
/// Nowhere is its direction farther to the left than by a turn to the left that is followed by one to the right.
ForwardReach::Moved ForwardReach::moved(std::int64_t slices, bool is_shorter) const {
  const double turn = length_ / radius_;
  const double low = std::max(width_ * static_cast<double>(slices - 1), -turn);
  const double high = std::min(width_ * static_cast<double>(slices + 1), turn);
  const auto left = [&](double by) { return radius_ * (1.0 + std::cos(by) - 2.0 * std::cos(0.5 * (turn + by))); };
  const double most = std::max(high, -low), least = std::max({low, -high, 0.0});
  return {is_shorter ? 0.0 : radius_ * (2.0 * std::sin(0.5 * (turn + most)) - std::sin(most)),
          length_ - radius_ * (least - std::sin(least)), -left(-low), left(high)};
}

/// Return where a drive from a box may end: squares that meet a rectangle, seen from the middle of the slice.
std::vector<ForwardReach::Span> ForwardReach::make_spans(std::int64_t slice, bool is_shorter) const {
  const double angle = (static_cast<double>(slice) + 0.5) * width_, c = std::cos(angle), s = std::sin(angle);
  const double wide = side_ * (std::abs(c) + std::abs(s));
  const auto reached = static_cast<std::int64_t>(std::ceil((1.5 * length_) / side_)) + 2;
  const auto most = static_cast<std::int64_t>(std::ceil(length_ / radius_ / width_ + POSITION_ROUNDING));
  std::vector<Span> spans;
  for (std::int64_t by = -most; by <= most; by++) {
    const Moved to = moved(by, is_shorter);
    // What half a slice more or less does.
    const double aside = std::max(-to.right, to.left);
    const double across = 0.5 * width_ * (to.most + 0.5 * width_ * aside) + POSITION_ROUNDING;
    const double along = 0.5 * width_ * (aside + 0.5 * width_ * to.most) + POSITION_ROUNDING;
    for (std::int64_t row = -reached; row <= reached; row++) {
      Span span{by, row, reached + 1, -reached - 1};
      for (std::int64_t column = -reached; column <= reached; column++) {
        const Vec at = side_ * Vec{static_cast<double>(column), static_cast<double>(row)};
        const double x = c * at.x + s * at.y, y = c * at.y - s * at.x;
        if (x < to.least - along - wide || x > to.most + along + wide) continue;
        if (y < to.right - across - wide || y > to.left + across + wide) continue;
        span.first = std::min(span.first, column), span.last = std::max(span.last, column);
      }
      if (span.first <= span.last) spans.push_back(span);
    }
  }
  return spans;
}

}  // namespace evenroad::drive
