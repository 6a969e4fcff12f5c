// A table of bytes over a grid, in square tiles that are made when first needed.  A query pays only for the part of the
// map that it uses.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "world/cell_states.hpp"

namespace evenroad::world {

/// Threads may read it at once.  The contents of a tile depend only on its position, and the first one made is kept.
class Tiles {
 public:
  Tiles(std::int64_t rows, std::int64_t columns, int shift)
      : shift_(shift),
        wide_(((columns - 1) >> shift) + 1),
        tiles_((((rows - 1) >> shift) + 1) * wide_),
        asked_(tiles_.size()) {}

  /// Return a byte; make(square) returns those of a tile that is not there yet.
  template <class Make>
  std::uint8_t at(std::int64_t row, std::int64_t column, const Make& make) const {
    const std::int64_t number = (row >> shift_) * wide_ + (column >> shift_);
    const std::uint8_t* tile = tiles_[number].load(std::memory_order_acquire);
    if (tile == nullptr) [[unlikely]] {
      const Square square{row >> shift_ << shift_, column >> shift_ << shift_, std::int64_t{1} << shift_};
      tile = keep(number, make(square));
    }
    const std::int64_t inside = (std::int64_t{1} << shift_) - 1;
    return tile[(row & inside) << shift_ | (column & inside)];
  }

  /// Return the same, or `unknown` where a tile is not there and was hardly needed yet: to make one takes as long
  /// as some hundred slow checks.
  template <class Make>
  std::uint8_t at(std::int64_t row, std::int64_t column, const Make& make, std::uint8_t unknown) const {
    const std::int64_t number = (row >> shift_) * wide_ + (column >> shift_);
    if (tiles_[number].load(std::memory_order_acquire) == nullptr && asked_[number] < OFTEN) [[unlikely]] {
      asked_[number]++;
      return unknown;
    }
    return at(row, column, make);
  }

 private:
  static constexpr std::uint8_t OFTEN = 100;

  /// Store a tile; tiles with a single value are shared.
  const std::uint8_t* keep(std::int64_t number, std::unique_ptr<std::uint8_t[]> made) const {
    const std::scoped_lock lock(keeping_);
    if (const std::uint8_t* other = tiles_[number].load(std::memory_order_acquire); other != nullptr) return other;
    const std::uint8_t value = made[0];
    const std::uint8_t* kept = made.get();
    if (std::all_of(kept, kept + (std::int64_t{1} << 2 * shift_), [&](std::uint8_t each) { return each == value; })) {
      if (uniform_[value] == nullptr) uniform_[value] = std::move(made);
      kept = uniform_[value].get();
    } else {
      kept_.push_back(std::move(made));
    }
    tiles_[number].store(kept, std::memory_order_release);
    return kept;
  }

  int shift_;
  std::int64_t wide_;
  mutable std::vector<std::atomic<const std::uint8_t*>> tiles_;
  mutable std::vector<std::atomic<std::uint8_t>> asked_;
  mutable std::mutex keeping_;
  mutable std::vector<std::unique_ptr<std::uint8_t[]>> kept_;
  mutable std::array<std::unique_ptr<std::uint8_t[]>, 256> uniform_;
};

}  // namespace evenroad::world
