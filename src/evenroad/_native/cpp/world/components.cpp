#include "world/components.hpp"

#include <algorithm>
#include <cmath>

#include "common/disjoint_sets.hpp"
#include "common/time_limit.hpp"

namespace evenroad::world {

namespace {

/// Cells between two looks at the clock.
constexpr int CELLS_A_LOOK = 1024;

/// The piece of a cell that each of its parts belongs to, -1 for none.
using Pieces = std::array<std::array<std::int16_t, PARTS>, PARTS>;

bool is_open(const Opened& opened, int row, int column) { return (opened[row] >> column & 1) != 0; }

/// Write the pieces of a cell; return how many there are.
int pieces_of(const Opened& opened, Pieces& pieces) {
  for (auto& row : pieces) row.fill(-1);
  std::array<std::int16_t, PARTS * PARTS> waiting;
  int count = 0;
  for (int seed = 0; seed < PARTS * PARTS; seed++) {
    if (pieces[seed / PARTS][seed % PARTS] >= 0 || !is_open(opened, seed / PARTS, seed % PARTS)) continue;
    pieces[seed / PARTS][seed % PARTS] = static_cast<std::int16_t>(count);
    waiting[0] = static_cast<std::int16_t>(seed);
    for (int size = 1; size > 0;) {
      const int part = waiting[--size], row = part / PARTS, column = part % PARTS;
      constexpr std::array<std::array<int, 2>, 4> SIDES = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
      for (const auto [down, right] : SIDES) {
        const int r = row + down, c = column + right;
        if (r < 0 || r >= PARTS || c < 0 || c >= PARTS || !is_open(opened, r, c) || pieces[r][c] >= 0) continue;
        pieces[r][c] = static_cast<std::int16_t>(count);
        waiting[size++] = static_cast<std::int16_t>(r * PARTS + c);
      }
    }
    count++;
  }
  return count;
}

/// Return the distance from the middle of a square of parts of a cell to the nearest obstacle, or any distance beyond
/// the radius if it is farther.
double distance(const Disk& disk, std::int64_t row, std::int64_t column, int top, int left, int size) {
  const Point middle{static_cast<double>(column) + (left + 0.5 * size) / PARTS,
                     static_cast<double>(row) + (top + 0.5 * size) / PARTS};
  return std::sqrt(disk.squared_gap(middle, row, column, disk.reach() + 1, 0.0));
}

/// Return the parts of a cell that may have a free point: all but those whose middle is too near by their size.
Opened open_parts(const Disk& disk, std::int64_t row, std::int64_t column) {
  constexpr int COARSE = PARTS / 4;
  const double reach = std::sqrt(0.5) * COARSE / PARTS, of_part = std::sqrt(0.5) / PARTS;
  Opened opened{};
  for (int i = 0; i < 16; i++) {
    const int top = i / 4 * COARSE, left = i % 4 * COARSE;
    const double away = distance(disk, row, column, top, left, COARSE);
    if (away + reach < disk.radius()) continue;
    for (int r = top; r < top + COARSE; r++) {
      for (int c = left; c < left + COARSE; c++) {
        const bool whole = away >= disk.radius() + reach;
        if (whole || distance(disk, row, column, r, c, 1) + of_part >= disk.radius()) {
          opened[r] = static_cast<std::uint16_t>(opened[r] | 1u << c);
        }
      }
    }
  }
  return opened;
}

/// Join two cells or pieces, -1 for none, that may both have a free point.
void join(std::vector<std::int32_t>& parent, std::int64_t a, std::int64_t b) {
  if (a < 0 || b < 0 || parent[a] < 0 || parent[b] < 0) return;
  unite(parent, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
}

}  // namespace

Components::Components(const Disk& disk) : cells_(disk.rows(), disk.columns()), number_(disk.rows(), disk.columns()) {
  number_gates(disk);
  const std::size_t cells = cells_.values.size();
  // Cells come first, followed by the pieces of those at gates.
  std::vector<std::int32_t> parent(cells + first_.back(), -1);
  ClockWatch clock(CELLS_A_LOOK);
  for (std::size_t cell = 0; cell < cells; cell++) {
    clock.look();
    const auto row = static_cast<std::int64_t>(cell) / disk.columns(),
               column = static_cast<std::int64_t>(cell) % disk.columns();
    const bool whole = number_.values[cell] < 0 && disk.cell(row, column) != BLOCKED;
    if (whole) parent[cell] = static_cast<std::int32_t>(cell);
  }
  for (std::size_t piece = cells; piece < parent.size(); piece++) parent[piece] = static_cast<std::int32_t>(piece);
  unite_neighbours(parent);
  // A parent never comes after its child, so its entry is final.
  for (std::int32_t& each : parent) each = each < 0 ? each : parent[each];
  for (std::int32_t& each : parent) each++;
  std::copy(parent.begin(), parent.begin() + static_cast<std::ptrdiff_t>(cells), cells_.values.begin());
  pieces_.assign(parent.begin() + static_cast<std::ptrdiff_t>(cells), parent.end());
}

void Components::number_gates(const Disk& disk) {
  Pieces pieces;
  ClockWatch clock(CELLS_A_LOOK / 16);
  first_.push_back(0);
  for (std::int64_t row = 0; row < disk.rows(); row++) {
    for (std::int64_t column = 0; column < disk.columns(); column++) {
      clock.look();
      const bool is_gate = disk.is_gate(row, column);
      number_(row, column) = is_gate ? static_cast<std::int32_t>(opened_.size()) : -1;
      if (!is_gate) continue;
      opened_.push_back(open_parts(disk, row, column));
      first_.push_back(first_.back() + pieces_of(opened_.back(), pieces));
    }
  }
  opened_.shrink_to_fit(), first_.shrink_to_fit();
}

void Components::unite_neighbours(std::vector<std::int32_t>& parent) const {
  const auto rows = static_cast<std::int64_t>(cells_.rows), columns = static_cast<std::int64_t>(cells_.columns);
  const std::int64_t cells = rows * columns;
  Pieces here, there;
  ClockWatch clock(CELLS_A_LOOK);
  const auto number_of = [&](std::int32_t gate, std::int16_t piece) {
    return piece < 0 ? -1 : cells + first_[gate] + piece;
  };
  for (std::int64_t row = 1; row < rows - 1; row++) {
    for (std::int64_t column = 1; column < columns - 1; column++) {
      clock.look();
      const std::int64_t cell = row * columns + column;
      const std::int32_t gate = number_.values[cell];
      if (gate >= 0) pieces_of(opened_[gate], here);
      for (const bool down : {false, true}) {
        const std::int64_t next = down ? cell + columns : cell + 1;
        const std::int32_t next_gate = number_.values[next];
        if (gate < 0 && next_gate < 0) {
          join(parent, cell, next);
          continue;
        }
        if (next_gate >= 0) pieces_of(opened_[next_gate], there);
        for (int k = 0; k < PARTS; k++) {
          // The parts on both sides of the line between the two cells.
          const std::int64_t a = gate < 0 ? cell : number_of(gate, down ? here[PARTS - 1][k] : here[k][PARTS - 1]);
          const std::int64_t b = next_gate < 0 ? next : number_of(next_gate, down ? there[0][k] : there[k][0]);
          join(parent, a, b);
        }
      }
    }
  }
}

std::int32_t Components::at(Point pixels) const {
  const auto row = static_cast<std::int64_t>(pixels.y) + 1, column = static_cast<std::int64_t>(pixels.x) + 1;
  const std::int64_t cell = row * static_cast<std::int64_t>(cells_.columns) + column;
  const std::int32_t gate = number_.values[cell];
  if (gate < 0) return cells_.values[cell];
  Pieces pieces;
  pieces_of(opened_[gate], pieces);
  const auto part = [](double along) { return static_cast<int>(PARTS * (along - std::floor(along))); };
  const std::int16_t piece = pieces[part(pixels.y)][part(pixels.x)];
  return piece < 0 ? 0 : pieces_[first_[gate] + piece];
}

OwnMatrix<std::uint8_t> Components::cells_of(std::int32_t component) const {
  OwnMatrix<std::uint8_t> inside(cells_.rows, cells_.columns);
  for (std::size_t cell = 0; cell < cells_.values.size(); cell++) {
    const std::int32_t gate = number_.values[cell];
    inside.values[cell] = cells_.values[cell] == component ? 1 : 0;
    if (gate < 0) continue;
    const auto begin = pieces_.begin() + first_[gate], end = pieces_.begin() + first_[gate + 1];
    inside.values[cell] = std::find(begin, end, component) != end ? 1 : 0;
  }
  return inside;
}

std::size_t Components::bytes() const {
  return 2 * cells_.values.size() * sizeof(std::int32_t) + opened_.size() * sizeof(Opened) +
         first_.size() * sizeof(std::int64_t) + pieces_.size() * sizeof(std::int32_t);
}

}  // namespace evenroad::world
