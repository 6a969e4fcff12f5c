#include "drive/slices.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "common/time_limit.hpp"

namespace evenroad::drive {

namespace {

/// Number of directions that stand for those of a side over a slice, besides the first.
constexpr int DIRECTIONS = 4;
/// What is covered is smaller by this, so that what it meets is met for certain [cells].
constexpr double SMALLER = 1e-9;
/// Largest number of boxes that are kept in mind.
constexpr std::int64_t MOST_BOXES = 100'000'000;
/// Whom a box was seen by, or that it is shut.
enum Seen : std::uint8_t { NOBODY, FROM_START, FROM_GOAL, CLOSED };

/// Keep what of a convex polygon lies on one side of a line: where dot(out, point) <= offset.
std::vector<Vec> cut_off(const std::vector<Vec>& polygon, Vec out, double offset) {
  std::vector<Vec> kept;
  for (std::size_t i = 0; i < polygon.size(); i++) {
    const Vec p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double dp = dot(out, p) - offset, dq = dot(out, q) - offset;
    if (dp <= 0.0) kept.push_back(p);
    if ((dp < 0.0) != (dq < 0.0) && dp != dq) kept.push_back(p + dp / (dp - dq) * (q - p));
  }
  return kept;
}

/// Return a convex polygon that every pose of a box covers with a part: angles from one on, and the reference point
/// anywhere in a cell around the origin; nothing where there is none.
///
/// A side at a distance h turns about the reference point.  Between two directions whose angle is d, points within
/// h cos(d / 2) of both lie within h of all.
std::vector<Vec> always_covered(const std::vector<Vec>& part, double from, double width) {
  double wide = 1.0;
  for (const Vec& corner : part) wide = std::max(wide, norm(corner));
  std::vector<Vec> polygon{{-wide, -wide}, {wide, -wide}, {wide, wide}, {-wide, wide}};
  for (std::size_t i = 0; i < part.size() && polygon.size() >= 3; i++) {
    const Vec along = part[(i + 1) % part.size()] - part[i];
    const double angle = std::atan2(-along.x, along.y), far = cross(part[i], along) / norm(along);
    const double least = far > 0.0 ? far * std::cos(0.5 * width / DIRECTIONS) : far;
    for (int k = 0; k <= DIRECTIONS && polygon.size() >= 3; k++) {
      const double turned = angle + from + width * k / DIRECTIONS;
      const Vec out{std::cos(turned), std::sin(turned)};
      polygon = cut_off(polygon, out, least - 0.5 * (std::abs(out.x) + std::abs(out.y)) - SMALLER);
    }
  }
  if (polygon.size() < 3) polygon.clear();
  return polygon;
}

/// Write the bits of a line, each a number of places lower: beyond its words all are set.
void shift(std::span<const std::uint64_t> line, std::int64_t by, std::span<std::uint64_t> moved) {
  const std::int64_t whole = by >> 6, rest = by & 63, words = static_cast<std::int64_t>(line.size());
  const auto at = [&](std::int64_t word) { return word < 0 || word >= words ? ~std::uint64_t{0} : line[word]; };
  for (std::int64_t word = 0; word < words; word++) {
    const std::uint64_t low = at(word + whole);
    moved[word] = rest == 0 ? low : low >> rest | at(word + whole + 1) << (64 - rest);
  }
}

}  // namespace

Slices::Slices(const Vehicle& vehicle, std::int64_t count)
    : Slices(vehicle, count, vehicle.footprint().inner.centres[0]) {}

Slices::Slices(const Vehicle& vehicle, std::int64_t count, Vec point)
    : vehicle_(vehicle),
      centre_(point),
      count_(count),
      rows_(vehicle.rows()),
      columns_(vehicle.columns()),
      words_((columns_ + 63) / 64),
      shut_(count),
      always_(count) {}

/// The disk inside of the footprint is on the map wherever that is free, so its centre stands for a pose.
Slices::Box Slices::box_of(const Pose& pose) const {
  const Vec at = Placed(pose)(centre_);
  const double turns = pose.angle / (2.0 * PI), share = turns - std::floor(turns);
  return {std::min(static_cast<std::int64_t>(share * static_cast<double>(count_)), count_ - 1),
          static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.x)};
}

bool Slices::is_open(const Box& box) {
  if (vehicle_.obstacles() != nullptr) return !meets_polygons(box);
  if (shut_[box.slice].empty()) shut(box.slice);
  return (shut_[box.slice][box.row * words_ + (box.column >> 6)] >> (box.column & 63) & 1) == 0;
}

/// Say whether a part always meets a polygon where its pose lies in a box.
bool Slices::meets_polygons(const Box& box) {
  std::vector<std::vector<Vec>>& always = always_[box.slice];
  if (always.empty()) {
    const double width = 2.0 * PI / static_cast<double>(count_);
    for (std::vector<Vec> part : vehicle_.footprint().parts) {
      for (Vec& corner : part) corner = corner - centre_;
      always.push_back(always_covered(part, static_cast<double>(box.slice) * width, width));
    }
  }
  const Vec middle{static_cast<double>(box.column) + 0.5, static_cast<double>(box.row) + 0.5};
  return std::ranges::any_of(always, [&](std::vector<Vec> polygon) {
    if (polygon.empty()) return false;
    for (Vec& corner : polygon) corner = corner + middle;
    return !covered_.cover(polygon, 0.0, vehicle_.occupancy()) ||
           vehicle_.obstacles()->meet(covered_, vehicle_.occupancy(), polygon, 0.0) ||
           vehicle_.obstacles()->hold(polygon[0]);
  });
}

/// Find the shut boxes of a slice: those from which a part always covers an occupied cell.
void Slices::shut(std::int64_t slice) {
  std::vector<std::uint64_t>& shut = shut_[slice];
  shut.assign(rows_ * words_, 0);
  const double width = 2.0 * PI / static_cast<double>(count_);
  for (const std::vector<Vec>& part : vehicle_.footprint().parts) {
    std::vector<Vec> moved = part;
    for (Vec& corner : moved) corner = corner - centre_;
    std::vector<Vec> polygon = always_covered(moved, static_cast<double>(slice) * width, width);
    if (polygon.empty()) continue;
    // The cell around the origin is that of row and column 0.
    for (Vec& corner : polygon) corner = corner + Vec{0.5, 0.5};
    covered_.cover(polygon, 0.0);
    for (std::int64_t row = 0; row < rows_; row++) {
      look_at_clock();
      shut_by(row, shut);
    }
  }
}

/// Shut the boxes of a row from which a covered cell is occupied.
void Slices::shut_by(std::int64_t row, std::vector<std::uint64_t>& shut) const {
  const world::Occupancy& occupancy = vehicle_.occupancy();
  std::vector<std::uint64_t> line(words_), moved(words_);
  for (std::int64_t by = covered_.first_row(); by <= covered_.last_row(); by++) {
    const Covered::Cells cells = covered_.cells(by);
    if (row + by < 0 || row + by >= rows_) {
      std::fill_n(shut.begin() + row * words_, words_, ~std::uint64_t{0});
      return;
    }
    for (std::int64_t word = 0; word < words_; word++) line[word] = occupancy.window(row + by, 64 * word);
    // Bit c of the line becomes whether one of `known` columns from c on is occupied.
    for (std::int64_t known = 1, wanted = cells.last - cells.first + 1; known < wanted;) {
      const std::int64_t more = std::min(known, wanted - known);
      shift(line, more, moved);
      for (std::int64_t word = 0; word < words_; word++) line[word] |= moved[word];
      known += more;
    }
    shift(line, cells.first, moved);
    for (std::int64_t word = 0; word < words_; word++) shut[row * words_ + word] |= moved[word];
  }
}

/// Visit a box and those beside it until `visit` returns true.
template <class Visit>
void Slices::each_beside(const Box& box, const Visit& visit) const {
  for (std::int64_t slice = box.slice - 1; slice <= box.slice + 1; slice++) {
    for (std::int64_t row = std::max<std::int64_t>(box.row - 1, 0); row <= std::min(box.row + 1, rows_ - 1); row++) {
      for (std::int64_t column = std::max<std::int64_t>(box.column - 1, 0);
           column <= std::min(box.column + 1, columns_ - 1); column++) {
        if (visit(Box{(slice + count_) % count_, row, column})) return;
      }
    }
  }
}

Apart Slices::find(const Pose& start, const Pose& goal, std::int64_t most) {
  if (count_ * rows_ * columns_ > MOST_BOXES) return Apart::UNKNOWN;
  struct Side {
    std::vector<Box> boxes;
    std::size_t next = 0;
  };
  std::array<Side, 2> sides{Side{{box_of(start)}}, Side{{box_of(goal)}}};
  std::vector<std::uint8_t> seen(count_ * rows_ * columns_, NOBODY);
  if (number_of(sides[0].boxes[0]) == number_of(sides[1].boxes[0])) return Apart::JOINED;
  for (int side = 0; side < 2; side++) seen[number_of(sides[side].boxes[0])] = FROM_START + side;
  ClockWatch clock(1024);
  for (std::int64_t gone = 0; gone < most; gone++) {
    const int side = static_cast<int>(gone % 2);
    Side& own = sides[side];
    if (own.next == own.boxes.size()) return Apart::PROVED;
    clock.look();
    bool is_joined = false;
    each_beside(Box(own.boxes[own.next++]), [&](const Box& next) {
      std::uint8_t& by = seen[number_of(next)];
      is_joined = by == FROM_GOAL - side;
      if (by != NOBODY) return is_joined;
      by = is_open(next) ? static_cast<std::uint8_t>(FROM_START + side) : CLOSED;
      if (by != CLOSED) own.boxes.push_back(next);
      return false;
    });
    if (is_joined) return Apart::JOINED;
  }
  return Apart::UNKNOWN;
}

/// Say whether a pose of a box may be one of some poses.
bool Slices::is_in(const Box& box, const Around& goals) const {
  const double off = norm(centre_), width = 2.0 * PI / static_cast<double>(count_);
  const Vec middle{static_cast<double>(box.column) + 0.5, static_cast<double>(box.row) + 0.5};
  const double turned = wrapped((static_cast<double>(box.slice) + 0.5) * width - goals.middle.angle);
  return std::abs(middle.x - goals.middle.x) <= goals.x + off + 0.5 + SMALLER &&
         std::abs(middle.y - goals.middle.y) <= goals.y + off + 0.5 + SMALLER &&
         std::abs(turned) <= goals.angle + 0.5 * width + SMALLER;
}

Apart Slices::find(const Pose& start, const Around& goals, std::int64_t most) {
  if (count_ * rows_ * columns_ > MOST_BOXES) return Apart::UNKNOWN;
  std::vector<Box> boxes{box_of(start)};
  std::vector<std::uint8_t> seen(count_ * rows_ * columns_, NOBODY);
  seen[number_of(boxes[0])] = FROM_START;
  ClockWatch clock(1024);
  for (std::int64_t gone = 0; gone < most; gone++) {
    if (gone == static_cast<std::int64_t>(boxes.size())) return Apart::PROVED;
    clock.look();
    if (is_in(boxes[gone], goals)) return Apart::JOINED;
    each_beside(Box(boxes[gone]), [&](const Box& next) {
      std::uint8_t& by = seen[number_of(next)];
      if (by != NOBODY) return false;
      by = is_open(next) ? FROM_START : CLOSED;
      if (by != CLOSED) boxes.push_back(next);
      return false;
    });
  }
  return Apart::UNKNOWN;
}

}  // namespace evenroad::drive
