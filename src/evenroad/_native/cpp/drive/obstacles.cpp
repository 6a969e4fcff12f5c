// A cell has the sides that touch it.  One without sides of a polygon lies in that polygon as a whole where its middle
// does.  A point is in a polygon where a ray from it crosses an odd number of sides.
#include "drive/obstacles.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "common/time_limit.hpp"
#include "drive/convex.hpp"

namespace evenroad::drive {

namespace {

/// A side touches cells within this distance [cells], which is more than rounding.
constexpr double TOUCHING = 1e-9;
/// Farther than this from the grid, what is left of a side touches no cell [cells].
constexpr double BEYOND = 2.0;

/// Return what of a segment lies in a box around the grid, or nothing.
std::optional<Motion> clipped(Vec from, Vec to, double right, double bottom) {
  const Vec by = to - from;
  double first = 0.0, last = 1.0;
  const auto cut = [&](double at, double along, double low, double high) {
    if (along == 0.0) return at >= low && at <= high;
    const double enters = ((along > 0.0 ? low : high) - at) / along, leaves = ((along > 0.0 ? high : low) - at) / along;
    first = std::max(first, enters), last = std::min(last, leaves);
    return first <= last;
  };
  if (!cut(from.x, by.x, -BEYOND, right + BEYOND) || !cut(from.y, by.y, -BEYOND, bottom + BEYOND)) return std::nullopt;
  const Vec begin = from + first * by;
  return Motion{{begin.x, begin.y, 0.0}, (last - first) * by, 0.0, {}, false};
}

/// Where the line of a height crosses a side, which is not level; each corner belongs to the side below it.
bool crosses(const Side& side, double y) { return (side.from.y <= y) != (side.to.y <= y); }
double crossing(const Side& side, double y) {
  return side.from.x + (y - side.from.y) / (side.to.y - side.from.y) * (side.to.x - side.from.x);
}

}  // namespace

Obstacles::Obstacles(std::span<const Border> borders, std::int64_t rows, std::int64_t columns)
    : rows_(rows), columns_(columns), occupied_(rows * columns, 0), solid_(rows * columns, 0) {
  std::vector<Entry> entries;
  std::vector<std::int64_t> touched(rows * columns, OUTSIDE);
  for (auto first = borders.begin(); first != borders.end();) {
    const auto last = std::find_if(first, borders.end(), [&](const Border& b) { return b.polygon != first->polygon; });
    add({first, last}, entries, touched);
    first = last;
  }
  add_outside(entries, touched);
  begin_.assign(rows_ * columns_ + 1, 0);
  for (const Entry& entry : entries) begin_[entry.cell + 1]++;
  for (std::int64_t cell = 0; cell < rows_ * columns_; cell++) begin_[cell + 1] += begin_[cell];
  of_cells_.resize(entries.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (const Entry& entry : entries) of_cells_[next[entry.cell]++] = entry.side;
  sort_by_rows();
}

void Obstacles::add(std::span<const Border> polygon, std::vector<Entry>& entries, std::vector<std::int64_t>& touched) {
  const std::size_t first = sides_.size();
  for (const Border& border : polygon) {
    const std::vector<Vec>& corners = border.corners;
    for (std::size_t i = 0; i < corners.size(); i++) {
      add_side({corners[i], corners[(i + 1) % corners.size()], border.polygon}, entries, touched);
    }
  }
  fill(std::span(sides_).subspan(first), touched);
}

void Obstacles::add_side(const Side& side, std::vector<Entry>& entries, std::vector<std::int64_t>& touched) {
  look_at_clock();
  const auto number = static_cast<std::uint32_t>(sides_.size());
  sides_.push_back(side);
  const std::optional<Motion> inside =
      clipped(side.from, side.to, static_cast<double>(columns_), static_cast<double>(rows_));
  if (!inside) return;
  const Pose end = inside->at(1.0);
  Covered covered;
  covered.cover(std::array<Vec, 2>{Vec{inside->from.x, inside->from.y}, Vec{end.x, end.y}}, TOUCHING);
  const std::int64_t last_row = std::min(covered.last_row(), rows_ - 1);
  for (std::int64_t row = std::max<std::int64_t>(covered.first_row(), 0); row <= last_row; row++) {
    const Covered::Cells cells = covered.cells(row);
    const std::int64_t last = std::min(cells.last, columns_ - 1);
    for (std::int64_t column = std::max<std::int64_t>(cells.first, 0); column <= last; column++) {
      const std::int64_t cell = row * columns_ + column;
      entries.push_back({cell, number});
      occupied_[cell] = 1, touched[cell] = side.polygon;
    }
  }
}

/// Find the cells that lie in a polygon as a whole.
void Obstacles::fill(std::span<const Side> polygon, const std::vector<std::int64_t>& touched) {
  const auto [low, high] = std::ranges::minmax(polygon, {}, [](const Side& side) { return side.from.y; });
  const auto bottom = static_cast<double>(rows_ - 1), right = static_cast<double>(columns_);
  const auto first_row = static_cast<std::int64_t>(std::clamp(low.from.y, 0.0, bottom));
  const auto last_row = static_cast<std::int64_t>(std::clamp(high.from.y, 0.0, bottom));
  std::vector<std::vector<double>> of_rows(last_row - first_row + 1);
  for (const Side& side : polygon) {
    look_at_clock();
    const auto last = static_cast<std::int64_t>(std::clamp(std::max(side.from.y, side.to.y), 0.0, bottom));
    for (auto row = static_cast<std::int64_t>(std::clamp(std::min(side.from.y, side.to.y), 0.0, bottom)); row <= last;
         row++) {
      const double middle = static_cast<double>(row) + 0.5;
      if (crosses(side, middle)) of_rows[row - first_row].push_back(crossing(side, middle));
    }
  }
  for (std::int64_t row = first_row; row <= last_row; row++) {
    std::vector<double>& at = of_rows[row - first_row];
    std::ranges::sort(at);
    for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
      const auto first = static_cast<std::int64_t>(std::ceil(std::clamp(at[i] - 0.5, 0.0, right)));
      const auto last = static_cast<std::int64_t>(std::floor(std::clamp(at[i + 1] - 0.5, -1.0, right - 1.0)));
      for (std::int64_t cell = row * columns_ + first; cell <= row * columns_ + last; cell++) {
        if (touched[cell] != polygon[0].polygon) occupied_[cell] = solid_[cell] = 1;
      }
    }
  }
}

/// Add the border of the map, and the cells around it.
void Obstacles::add_outside(std::vector<Entry>& entries, std::vector<std::int64_t>& touched) {
  const double right = static_cast<double>(columns_ - 1), bottom = static_cast<double>(rows_ - 1);
  const std::array<Vec, 4> corners{Vec{1.0, 1.0}, Vec{right, 1.0}, Vec{right, bottom}, Vec{1.0, bottom}};
  for (std::size_t i = 0; i < 4; i++) add_side({corners[i], corners[(i + 1) % 4], OUTSIDE}, entries, touched);
  for (std::int64_t row = 0; row < rows_; row++) {
    const bool is_ring = row == 0 || row == rows_ - 1;
    for (std::int64_t column = 0; column < columns_; column += is_ring ? 1 : columns_ - 1) {
      occupied_[row * columns_ + column] = solid_[row * columns_ + column] = 1;
    }
  }
}

void Obstacles::sort_by_rows() {
  row_begin_.assign(rows_ + 1, 0);
  const auto each_row = [&](const Side& side, const auto& found) {
    const double low = std::min(side.from.y, side.to.y), high = std::max(side.from.y, side.to.y);
    if (high < 0.0 || low >= static_cast<double>(rows_) || side.polygon == OUTSIDE) return;
    const auto last = static_cast<std::int64_t>(std::min(high, static_cast<double>(rows_ - 1)));
    for (auto row = static_cast<std::int64_t>(std::max(low, 0.0)); row <= last; row++) found(row);
  };
  for (const Side& side : sides_) each_row(side, [&](std::int64_t row) { row_begin_[row + 1]++; });
  for (std::int64_t row = 0; row < rows_; row++) row_begin_[row + 1] += row_begin_[row];
  of_rows_.resize(row_begin_.back());
  std::vector<std::uint32_t> next(row_begin_.begin(), row_begin_.end() - 1);
  for (std::uint32_t i = 0; i < sides_.size(); i++) {
    each_row(sides_[i], [&](std::int64_t row) { of_rows_[next[row]++] = i; });
  }
}

bool Obstacles::meet(const Covered& covered, const world::Occupancy& occupancy, std::span<const Vec> body,
                     double within) const {
  return any_side(covered, occupancy, [&](const Side& side) {
    const std::array<Vec, 2> segment{side.from, side.to};
    const double overlap = overlap_of(body, segment);
    return overlap >= 0.0 || (overlap >= -within && distance_of(body, segment) <= within);
  });
}

std::int64_t Obstacles::holder(Vec point) const {
  const auto row = static_cast<std::int64_t>(point.y);
  std::int64_t polygon = OUTSIDE;
  bool is_in = false;
  // The sides of a polygon come one after the other.
  for (std::uint32_t i = row_begin_[row]; i < row_begin_[row + 1]; i++) {
    const Side& side = sides_[of_rows_[i]];
    if (side.polygon != polygon) {
      if (is_in) return polygon;
      polygon = side.polygon;
    }
    if (crosses(side, point.y) && crossing(side, point.y) > point.x) is_in = !is_in;
  }
  return is_in ? polygon : OUTSIDE;
}

bool Obstacles::hold(Vec point) const {
  const auto row = static_cast<std::int64_t>(point.y), column = static_cast<std::int64_t>(point.x);
  const std::int64_t cell = row * columns_ + column;
  if (!occupied_[cell] || solid_[cell]) return solid_[cell] != 0;
  return holder(point) != OUTSIDE;
}

}  // namespace evenroad::drive
