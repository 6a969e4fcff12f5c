// The occupied cells of a map, one bit each, with a ring of occupied cells around them for the outside.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::world {

/// Rows and columns include the ring; everything beyond it to the left and right is occupied, too.
class Occupancy {
 public:
  explicit Occupancy(Matrix<const bool> map)
      : rows_(static_cast<std::int64_t>(map.rows) + 2),
        columns_(static_cast<std::int64_t>(map.columns) + 2),
        words_((columns_ + 63) / 64 + 2),
        bits_(rows_ * words_, ~std::uint64_t{0}) {
    for (std::int64_t row = 1; row + 1 < rows_; row++) {
      const bool* cells = map.data + (row - 1) * (columns_ - 2);
      std::uint64_t* words = bits_.data() + row * words_ + 1;
      // Column 0 is the ring: the cells of a word are those from one before it.
      for (std::int64_t first = 0; first < columns_; first += 64, words++) {
        const std::int64_t begin = std::max<std::int64_t>(first, 1), end = std::min(first + 64, columns_ - 1);
        if (end - begin == 64) {
          *words = packed(cells + begin - 1);
          continue;
        }
        std::uint64_t free = 0;
        for (std::int64_t column = begin; column < end; column++) {
          free |= std::uint64_t{!cells[column - 1]} << (column - first);
        }
        *words = ~free;
      }
    }
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t columns() const { return columns_; }

  /// Return 64 columns of a row from one on, which is at least -64 and at most the number of columns.
  std::uint64_t window(std::int64_t row, std::int64_t first) const {
    const std::uint64_t at = static_cast<std::uint64_t>(first + 64);
    const std::uint64_t* word = bits_.data() + row * words_ + (at >> 6);
    const std::uint64_t shift = at & 63;
    return shift == 0 ? word[0] : word[0] >> shift | word[1] << (64 - shift);
  }

  /// Return whether a cell of a row is occupied, from a column of the map to another one, both included.
  bool any(std::int64_t row, std::int64_t first, std::int64_t last) const {
    for (; last - first >= 64; first += 64) {
      if (window(row, first) != 0) return true;
    }
    return window(row, first) << (63 - (last - first)) != 0;
  }

  /// Return the distance in columns to the nearest occupied cell to the left, 0 in one; more than `most` if it is
  /// farther.
  std::int64_t to_left(std::int64_t row, std::int64_t column, std::int64_t most) const {
    for (std::int64_t away = 0; away <= most; away += 64) {
      if (const std::uint64_t seen = window(row, std::max<std::int64_t>(column - away - 63, -64)); seen != 0) {
        return away + std::countl_zero(seen);
      }
    }
    return most + 1;
  }

  /// The same to the right.
  std::int64_t to_right(std::int64_t row, std::int64_t column, std::int64_t most) const {
    for (std::int64_t away = 0; away <= most; away += 64) {
      if (const std::uint64_t seen = window(row, column + away); seen != 0) return away + std::countr_zero(seen);
    }
    return most + 1;
  }

 private:
  /// Return 64 cells as bits, eight at a time: a product moves the lowest bit of each of eight bytes into the highest
  /// byte.
  static std::uint64_t packed(const bool* cells) {
    static_assert(std::endian::native == std::endian::little, "bytes are in the order of their bits");
    constexpr std::uint64_t GATHER = 0x0102040810204080;
    std::uint64_t word = 0;
    for (int byte = 0; byte < 8; byte++) {
      std::uint64_t eight;
      std::memcpy(&eight, cells + 8 * byte, sizeof(eight));
      word |= (eight * GATHER >> 56) << 8 * byte;
    }
    return word;
  }

  std::int64_t rows_, columns_, words_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace evenroad::world
