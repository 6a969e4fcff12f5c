// Every side of the polygon widens the rows that it crosses: between two sides all columns are covered.
#include "drive/covered.hpp"

#include <algorithm>
#include <limits>

namespace evenroad::drive {

bool Covered::cover(std::span<const Vec> polygon, double grow, const world::Occupancy& occupancy) {
  // The ring around the map is occupied, so what reaches beyond it meets something.
  const double right = static_cast<double>(occupancy.columns()) - grow;
  const double bottom = static_cast<double>(occupancy.rows()) - grow;
  const bool is_inside = std::ranges::all_of(
      polygon, [&](const Vec& at) { return at.x > grow && at.x < right && at.y > grow && at.y < bottom; });
  if (is_inside) {
    cover(polygon, grow);
  } else {
    first_ = 0, last_ = -1;
  }
  return is_inside;
}

void Covered::cover(std::span<const Vec> polygon, double grow) {
  const auto [low, high] = std::ranges::minmax(polygon, {}, [](const Vec& at) { return at.y; });
  first_ = before(low.y - grow), last_ = column_of(high.y + grow);
  constexpr double FAR = std::numeric_limits<double>::max();
  columns_.assign(last_ - first_ + 1, {FAR, -FAR});
  for (std::size_t i = 0; i < polygon.size(); i++) {
    Vec a = polygon[i], b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    if (a.y > b.y) std::swap(a, b);
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const std::int64_t end = column_of(b.y + grow);
    for (std::int64_t row = before(a.y - grow); row <= end; row++) {
      const double top = static_cast<double>(row) - grow, bottom = static_cast<double>(row + 1) + grow;
      const double enters = top <= a.y ? a.x : a.x + (top - a.y) * slope;
      const double leaves = bottom >= b.y ? b.x : a.x + (bottom - a.y) * slope;
      Columns& columns = columns_[row - first_];
      columns.low = std::min(columns.low, std::min(enters, leaves) - grow);
      columns.high = std::max(columns.high, std::max(enters, leaves) + grow);
    }
  }
}

bool Covered::meets(const world::Occupancy& occupancy) const {
  for (std::int64_t row = first_; row <= last_; row++) {
    const auto [first, last] = cells(row);
    if (occupancy.any(row, first, last)) return true;
  }
  return false;
}

std::size_t convex_hull(std::span<Vec> points, std::span<Vec> hull) {
  std::ranges::sort(points, [](Vec a, Vec b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::size_t count = 0;
  const auto add = [&](Vec point, std::size_t kept) {
    while (count > kept && cross(hull[count - 1] - hull[count - 2], point - hull[count - 2]) <= 0.0) count--;
    hull[count++] = point;
  };
  for (const Vec& point : points) add(point, 1);
  const std::size_t lower = count;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  return count > 1 ? count - 1 : count;
}

}  // namespace evenroad::drive
