// Open cells of a tile are computed 64 at once, as bits; its parts grow along rows in six steps per row.
#include "world/coarse_tiles.hpp"

#include <algorithm>
#include <bit>

namespace evenroad::world {

namespace {

/// Largest column distance of a square that closes a cell, by row distance; -1 if none does.
std::vector<std::int64_t> reaches(double radius, Open open) {
  std::vector<std::int64_t> reaches;
  const std::int64_t less = open == Open::SURELY_FREE ? 1 : 0;
  for (std::int64_t down = 0; down <= MOST_REACH + 2; down++) {
    const auto y = static_cast<double>(std::max<std::int64_t>(down - less, 0));
    std::int64_t reach = -1;
    for (std::int64_t right = 0; right <= MOST_REACH + 2; right++) {
      const auto x = static_cast<double>(std::max<std::int64_t>(right - less, 0));
      if (x * x + y * y < radius * radius) reach = right;
    }
    if (reach < 0) break;
    reaches.push_back(reach);
  }
  return reaches;
}

/// Return the bits of a mask that are connected to some bits along a row.
std::uint64_t spread(std::uint64_t bits, std::uint64_t mask) {
  std::uint64_t up = mask, down = mask, left = bits, right = bits;
  for (int by = 1; by < TILE_SIDE; by *= 2) {
    left |= up & (left << by), up &= up << by;
    right |= down & (right >> by), down &= down >> by;
  }
  return left | right;
}

/// Remove the part that is connected to one bit from a tile.
TileBits take_part(TileBits& open, std::int64_t row, std::uint64_t bit) {
  TileBits part{};
  part[row] = spread(bit, open[row]);
  for (bool is_growing = true; is_growing;) {
    is_growing = false;
    const auto grow = [&](std::int64_t from, std::int64_t to) {
      const std::uint64_t more = part[from] & open[to] & ~part[to];
      if (more == 0) return;
      part[to] = spread(part[to] | more, open[to]);
      is_growing = true;
    };
    for (std::int64_t each = 1; each < TILE_SIDE; each++) grow(each - 1, each);
    for (std::int64_t each = TILE_SIDE - 1; each > 0; each--) grow(each, each - 1);
  }
  for (std::int64_t each = 0; each < TILE_SIDE; each++) open[each] &= ~part[each];
  return part;
}

std::uint64_t column_of(const TileBits& bits, int column) {
  std::uint64_t word = 0;
  for (std::int64_t row = 0; row < TILE_SIDE; row++) word |= (bits[row] >> column & 1) << row;
  return word;
}

Cell inside(Cell at) {
  return {at.row & static_cast<std::int32_t>(TILE_SIDE - 1), at.column & static_cast<std::int32_t>(TILE_SIDE - 1)};
}

std::int16_t part_of(const CoarseTile& tile, Cell inside) {
  for (std::size_t part = 0; part < tile.parts.size(); part++) {
    if ((tile.parts[part][inside.row] >> inside.column & 1) != 0) return static_cast<std::int16_t>(part);
  }
  return -1;
}

std::uint64_t outermost(const TileBits& bits, int border) {
  if (border == TOP || border == BOTTOM) return bits[border == TOP ? 0 : TILE_SIDE - 1];
  return column_of(bits, border == LEFT ? 0 : TILE_SIDE - 1);
}

}  // namespace

CoarseTiles::CoarseTiles(const Disk& disk, Open open)
    : disk_(disk),
      reaches_(reaches(disk.radius(), open)),
      high_(((disk.rows() - 1) >> COARSE_SHIFT) + 1),
      wide_(((disk.columns() - 1) >> COARSE_SHIFT) + 1),
      tiles_(high_ * wide_) {}

std::int64_t CoarseTiles::beyond(std::int64_t tile, int border) const {
  const std::int64_t row = tile / wide_, column = tile % wide_;
  if (border == TOP) return row > 0 ? tile - wide_ : -1;
  if (border == LEFT) return column > 0 ? tile - 1 : -1;
  if (border == BOTTOM) return row + 1 < high_ ? tile + wide_ : -1;
  return column + 1 < wide_ ? tile + 1 : -1;
}

Cell CoarseTiles::middle(std::int64_t tile, int border, const BorderRun& run) const {
  const std::int64_t top = tile / wide_ << COARSE_SHIFT, left = tile % wide_ << COARSE_SHIFT;
  const std::int64_t along = (run.first + run.last) / 2;
  const std::int64_t row = border == TOP ? 0 : border == BOTTOM ? TILE_SIDE - 1 : along;
  const std::int64_t column = border == LEFT ? 0 : border == RIGHT ? TILE_SIDE - 1 : along;
  return {static_cast<std::int32_t>(top + row), static_cast<std::int32_t>(left + column)};
}

const CoarseTile& CoarseTiles::divide(std::int64_t number) {
  CoarseTile& tile = opened(number);
  tile.is_divided = true;
  TileBits left = tile.open;
  for (std::int64_t row = 0; row < TILE_SIDE; row++) {
    while (left[row] != 0) tile.parts.push_back(take_part(left, row, left[row] & -left[row]));
  }
  for (int border = 0; border < BORDERS; border++) {
    const std::int64_t other = beyond(number, border);
    if (other < 0) continue;
    const std::uint64_t both = outermost(tile.open, border) & outermost(opened(other).open, (border + 2) % BORDERS);
    for (std::uint64_t rest = both; rest != 0;) {
      const int first = std::countr_zero(rest), length = std::countr_one(rest >> first);
      const BorderRun run{static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(first + length - 1), 0};
      rest = first + length >= TILE_SIDE ? 0 : rest >> (first + length) << (first + length);
      tile.runs[border].push_back({run.first, run.last, part_of(tile, inside(middle(number, border, run)))});
    }
  }
  return tile;
}

std::int16_t CoarseTiles::part_at(Cell at) { return part_of(divided(tile_of(at)), inside(at)); }

/// Return a tile with known open cells.
CoarseTile& CoarseTiles::opened(std::int64_t number) {
  std::unique_ptr<CoarseTile>& tile = tiles_[number];
  if (tile != nullptr) return *tile;
  tile = std::make_unique<CoarseTile>();
  const std::int64_t top = number / wide_ << COARSE_SHIFT, left = number % wide_ << COARSE_SHIFT;
  const std::int64_t reach = static_cast<std::int64_t>(reaches_.size()) - 1;
  std::array<std::uint64_t, MOST_REACH + 3> grown;
  TileBits closed{};
  for (std::int64_t row = std::max<std::int64_t>(top - reach, 0); row < std::min(top + TILE_SIDE + reach, disk_.rows());
       row++) {
    grow_row(row, left, grown);
    const std::int64_t first = std::max(row - reach, top), last = std::min(row + reach, top + TILE_SIDE - 1);
    for (std::int64_t each = first; each <= last; each++) {
      closed[each - top] |= grown[reaches_[each < row ? row - each : each - row]];
    }
  }
  for (std::int64_t row = 0; row < TILE_SIDE; row++) tile->open[row] = top + row < disk_.rows() ? ~closed[row] : 0;
  return *tile;
}

/// Write the occupied cells of 64 columns of a row, with a number to both sides.
void CoarseTiles::grow_row(std::int64_t row, std::int64_t left,
                           std::array<std::uint64_t, MOST_REACH + 3>& grown) const {
  const Occupancy& occupancy = disk_.occupancy();
  const std::uint64_t here = occupancy.window(row, left);
  const std::uint64_t before = occupancy.window(row, left - TILE_SIDE);
  const std::uint64_t after =
      left + TILE_SIDE <= disk_.columns() ? occupancy.window(row, left + TILE_SIDE) : ~std::uint64_t{0};
  grown[0] = here;
  for (std::int64_t by = 1; by <= reaches_[0]; by++) {
    grown[by] = grown[by - 1] | here << by | before >> (TILE_SIDE - by) | here >> by | after << (TILE_SIDE - by);
  }
}

}  // namespace evenroad::world
