// Points in blocks of 32; the sums over pairs compute a block at once.
#pragma once

#include <cstddef>
#include <vector>

#include "common/lanes.hpp"
#include "common/matrix.hpp"

namespace evenroad::points {

#if defined(EVENROAD_SANITIZED)
// GCC takes minutes to compile wide vectors with a check of every lane.
constexpr std::size_t WIDTH = 8;
#else
constexpr std::size_t WIDTH = 32;
#endif
using Block = Lanes<double, WIDTH>;

/// Rows in blocks, the last one filled up with zeros.
class Blocks {
 public:
  explicit Blocks(Matrix<const double> rows)
      : count_((rows.columns + WIDTH - 1) / WIDTH), blocks_(rows.rows * count_, Block{}) {
    for (std::size_t k = 0; k < rows.rows; k++) {
      for (std::size_t j = 0; j < rows.columns; j++) blocks_[k * count_ + j / WIDTH][j % WIDTH] = rows(k, j);
    }
  }

  std::size_t count() const { return count_; }
  const Block& operator()(std::size_t row, std::size_t block) const { return blocks_[row * count_ + block]; }

 private:
  std::size_t count_;
  std::vector<Block> blocks_;
};

/// Return 1 in the lanes of points and 0 in those that fill the last block up.
inline Block filled(std::size_t n) {
  Block ones = Block{} + 1.0;
  for (std::size_t lane = n % WIDTH; n % WIDTH != 0 && lane < WIDTH; lane++) ones[lane] = 0.0;
  return ones;
}

}  // namespace evenroad::points
