#include "picture/nearest.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::picture {

namespace {

/// Return the first pixel whose centre lies at or beyond a coordinate, at most `count`.
std::size_t first_from(double position, std::size_t count) {
  return static_cast<std::size_t>(std::clamp(std::ceil(position - 0.5), 0.0, static_cast<double>(count)));
}

/// Return the column of a side at a height; `from` is above `to`, so that both of its triangles get the same result.
double column_at(const Seen& from, const Seen& to, double row) {
  return from.column + (row - from.row) * ((to.column - from.column) / (to.row - from.row));
}

}  // namespace

void Nearest::add(const Flat& flat, std::int32_t number) {
  const double size = area(flat);
  // Also false for NaN.
  if (!(std::abs(size) > 1e-12 && std::abs(size) < 1e18)) return;
  auto [a, b, c] = flat;
  const double right = ((c.row - a.row) * (b.near - a.near) - (b.row - a.row) * (c.near - a.near)) / size;
  const double down = ((b.column - a.column) * (c.near - a.near) - (c.column - a.column) * (b.near - a.near)) / size;
  const Seen origin = a;
  if (b.row < a.row) std::swap(a, b);
  if (c.row < b.row) std::swap(b, c);
  if (b.row < a.row) std::swap(a, b);
  const std::size_t last = first_from(c.row, rows);
  for (std::size_t row = first_from(a.row, rows); row < last; row++) {
    const double height = static_cast<double>(row) + 0.5;
    const double one = column_at(a, c, height);
    const double other = height < b.row ? column_at(a, b, height) : column_at(b, c, height);
    const std::size_t begin = first_from(std::min(one, other), columns);
    const std::size_t end = first_from(std::max(one, other), columns);
    const double start = origin.near + down * (height - origin.row) + right * (0.5 - origin.column);
    for (std::size_t column = begin, at = row * columns + begin; column < end; column++, at++) {
      const auto value = static_cast<float>(start + right * static_cast<double>(column));
      if (value < near[at]) continue;
      near[at] = value;
      owner[at] = number;
    }
  }
}

}  // namespace evenroad::picture
