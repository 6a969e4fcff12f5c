// The farthest that a point of a cell can be from a square (dc, dr) cells away is hypot(dc, dr): where that is less
// than the radius for the nearest occupied cell, the cell is blocked.  The nearest is hypot(max(dc - 1, 0), max(dr - 1,
// 0)), the distance from the obstacles grown by one cell all round: where that is at least the radius, the cell is
// free.
#include "world/cell_states.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::world {

namespace {

constexpr int LARGEST_RUN = 65535, LARGEST_SLACK = 255 - FREE;

std::int64_t square(std::int64_t number) { return number * number; }

/// Return a / b rounded down, b > 0.
std::int64_t floor_divided(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

/// min over j of (i - j)^2 + heights[j]^2 for all i, in linear time: the parabolas' lower envelope, built from left to
/// right and then read off (Meijster, Roerdink and Hesselink 2000, section 2.2).
class Envelope {
 public:
  explicit Envelope(std::size_t columns) : apexes_(columns), starts_(columns) {}

  void write(const std::vector<std::int64_t>& heights, std::vector<std::int64_t>& squared) {
    const auto count = static_cast<std::int64_t>(heights.size());
    std::int64_t last = 0;
    apexes_[0] = starts_[0] = 0;
    for (std::int64_t next = 1; next < count; next++) {
      const auto height = [&](std::int64_t apex, std::int64_t at) { return square(at - apex) + square(heights[apex]); };
      while (last >= 0 && height(apexes_[last], starts_[last]) > height(next, starts_[last])) last--;
      if (last < 0) {
        last = 0;
        apexes_[0] = next, starts_[0] = 0;
        continue;
      }
      const std::int64_t old = apexes_[last];
      const std::int64_t crossing =
          floor_divided(square(next) - square(old) + square(heights[next]) - square(heights[old]), 2 * (next - old));
      if (crossing + 1 < count) last++, apexes_[last] = next, starts_[last] = crossing + 1;
    }
    for (std::int64_t i = count - 1; i >= 0; i--) {
      squared[i] = square(i - apexes_[last]) + square(heights[apexes_[last]]);
      if (i == starts_[last]) last--;
    }
  }

 private:
  std::vector<std::int64_t> apexes_, starts_;
};

}  // namespace

Runs vertical_runs(Matrix<const bool> padded) {
  const std::size_t rows = padded.rows, cols = padded.columns;
  Runs runs{{rows, cols}, {rows, cols}};
  const auto next = [](bool occupied, int before) {
    return static_cast<std::uint16_t>(occupied ? 0 : std::min(before + 1, LARGEST_RUN));
  };
  for (std::size_t row = 0; row < rows; row++) {
    for (std::size_t col = 0; col < cols; col++) {
      runs.above(row, col) = next(padded(row, col), row > 0 ? runs.above(row - 1, col) : LARGEST_RUN);
    }
  }
  for (std::size_t row = rows; row-- > 0;) {
    for (std::size_t col = 0; col < cols; col++) {
      runs.below(row, col) = next(padded(row, col), row + 1 < rows ? runs.below(row + 1, col) : LARGEST_RUN);
    }
  }
  return runs;
}

OwnMatrix<std::uint8_t> classify(const Runs& runs, double radius) {
  const std::size_t rows = runs.above.rows, cols = runs.above.columns;
  const double squared_radius = radius * radius;
  OwnMatrix<std::uint8_t> cells(rows, cols);
  Envelope envelope(cols);
  std::vector<std::int64_t> heights(cols), grown(cols), to_centre(cols), to_grown(cols);
  for (std::size_t row = 1; row + 1 < rows; row++) {
    for (std::size_t col = 0; col < cols; col++) heights[col] = std::min(runs.above(row, col), runs.below(row, col));
    for (std::size_t col = 0; col < cols; col++) {
      std::int64_t lowest = heights[col];
      if (col > 0) lowest = std::min(lowest, heights[col - 1]);
      if (col + 1 < cols) lowest = std::min(lowest, heights[col + 1]);
      grown[col] = std::max<std::int64_t>(lowest - 1, 0);
    }
    envelope.write(heights, to_centre);
    envelope.write(grown, to_grown);
    for (std::size_t col = 1; col + 1 < cols; col++) {
      const auto centre = static_cast<double>(to_centre[col]), gap = static_cast<double>(to_grown[col]);
      if (to_centre[col] == 0 || centre < squared_radius) continue;
      if (gap < squared_radius) {
        cells(row, col) = UNDECIDED;
        continue;
      }
      const double slack = std::min(std::floor(std::sqrt(gap) - radius), static_cast<double>(LARGEST_SLACK));
      cells(row, col) = static_cast<std::uint8_t>(FREE + static_cast<int>(slack));
    }
  }
  return cells;
}

}  // namespace evenroad::world
