#include "flight/least_time.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

/// By how many cells a step may change when an axis accelerates fully, and by how many with the rounding.
constexpr int FULL = 4, CHANGE = FULL + 1;
/// Instants between two periods at which bodies are looked at, in fourths of a period; positions there are fourths of
/// cells.
constexpr int FOURTHS = 4;
/// By how many fourths of a cell a flight may be beside its chord after one, two and three fourths of a period.
constexpr int BESIDE[] = {0, (3 * FULL + 7) / 8, (FULL + 1) / 2, (3 * FULL + 7) / 8};
/// Parts of the last period.
constexpr int PARTS = 16;
/// Periods are shortened by this factor until the lattice is large enough; its cells are larger by a rounding.
constexpr double FINER = 0.9, A_HAIR_MORE = 1.0 + 1e-9;
/// Largest number of corners that are looked at for all bodies, and of periods.
constexpr std::size_t MOST_CORNERS = 20'000'000;
constexpr int MOST_PERIODS = 1000;
constexpr int WORD = 64;

/// Positions and steps of one axis.
struct LatticeAxis {
  std::size_t axis;
  double low, cell;
  int cells, fastest;
  double acceleration, goal, last;

  int cell_of(double x) const { return static_cast<int>(std::floor((x - low) / cell)); }
  int steps() const { return 2 * fastest + 1; }
};

/// One bit for each cell, in words along the first axis.
struct Plane {
  int words = 0, rows = 0;
  std::vector<std::uint64_t> bits = std::vector<std::uint64_t>(static_cast<std::size_t>(words * rows));

  std::uint64_t word(int number, int row) const {
    if (number < 0 || number >= words || row < 0 || row >= rows) return 0;
    return bits[static_cast<std::size_t>(row * words + number)];
  }
  void set(int cell, int row) {
    bits[static_cast<std::size_t>(row * words + cell / WORD)] |= std::uint64_t{1} << (cell % WORD);
  }
  /// Return the 64 cells from one on.
  std::uint64_t from(int cell, int row) const {
    const int number = cell >> 6, shift = cell & 63;
    const std::uint64_t first = word(number, row) >> shift;
    return shift == 0 ? first : first | word(number + 1, row) << (WORD - shift);
  }
};

LatticeAxis lattice_axis(const Airspace& airspace, const State& start, const State& goal, double most, double period,
                         std::size_t axis) {
  const double speed = airspace.limits().speed[axis], acceleration = airspace.limits().acceleration[axis];
  const double cell = acceleration * period * period / FULL * A_HAIR_MORE;
  const double from = start.position[axis], to = goal.position[axis], middle = 0.5 * (from + to);
  // Farther away there is no time to come back.
  const double low = std::max(airspace.bounds().low[axis], middle - 0.5 * speed * most) - cell;
  const double high = std::min(airspace.bounds().high[axis], middle + 0.5 * speed * most) + cell;
  const double cells = std::min((high - low) / cell + 1.0, 1e6), steps = std::min(speed * period / cell + 1.0, 1e4);
  return {axis,
          low,
          cell,
          static_cast<int>(cells),
          static_cast<int>(std::ceil(steps)) - 1,
          acceleration,
          to,
          goal.velocity[axis]};
}

/// Which cells are in one body for certain, as seen from a fourth of a cell: all of a box is, if its corners are.
class BlockedCells {
 public:
  BlockedCells(const Airspace& airspace, const LatticeAxis& first, const LatticeAxis& second)
      : first_(first), second_(second) {
    for (Plane& plane : planes_) plane = Plane{first.cells / WORD + 1, second.cells};
    std::size_t corners = 0;
    for (const std::uint32_t body : airspace.bodies().statics()) {
      look_at_clock();
      add(airspace, body, corners);
    }
  }

  /// Return which of 64 cells are blocked, where both positions are in fourths of cells.
  std::uint64_t from(int fourths, int row_fourths, int part) const {
    return planes_[number(part, fourths & 3, row_fourths & 3)].from(fourths >> 2, row_fourths >> 2);
  }

 private:
  static std::size_t number(int part, int along, int across) {
    return static_cast<std::size_t>(16 * std::min(part, FOURTHS - part) + 4 * along + across);
  }

  void add(const Airspace& airspace, std::uint32_t body, std::size_t& corners) {
    const Bodies& bodies = airspace.bodies();
    const double reach = airspace.surely_touching();
    const std::size_t third = 3 - first_.axis - second_.axis;
    Vector low, high;
    bodies.write_box(body, low, high);
    const auto range = [&](const LatticeAxis& along) {
      const double fourth = along.cell / FOURTHS;
      const double from = (low[along.axis] - reach - along.low) / fourth;
      const double to = (high[along.axis] + reach - along.low) / fourth;
      return std::pair{static_cast<int>(std::max(std::floor(from), -2.0 * FOURTHS)),
                       static_cast<int>(std::min(std::ceil(to), FOURTHS * (along.cells + 2.0)))};
    };
    const auto is_inside = [&](double along, double across) {
      Vector at;
      at[first_.axis] = along, at[second_.axis] = across;
      for (const double end : {airspace.bounds().low[third], airspace.bounds().high[third]}) {
        at[third] = end;
        if (!bodies.is_near(body, at, reach)) return false;
      }
      return true;
    };
    const auto [left, right] = range(first_);
    const auto [bottom, top] = range(second_);
    if (right <= left || top <= bottom) return;
    const auto middle = [&](std::size_t axis) { return 0.5 * (low[axis] + high[axis]); };
    if (!is_inside(middle(first_.axis), middle(second_.axis))) return;
    corners += static_cast<std::size_t>(right - left) * static_cast<std::size_t>(top - bottom);
    if (corners > MOST_CORNERS) return;
    // From where to where each row of corners is inside.
    std::vector<std::pair<int, int>> rows;
    for (int row = bottom; row <= top; row++) {
      const double across = second_.low + row * second_.cell / FOURTHS;
      const auto inside = [&](int corner) { return is_inside(first_.low + corner * first_.cell / FOURTHS, across); };
      int from = left, to = right;
      while (from <= to && !inside(from)) from++;
      while (from <= to && !inside(to)) to--;
      rows.emplace_back(from, to);
    }
    for (const int part : {0, 1, 2}) {
      const int beside = BESIDE[part];
      for (int from = bottom + beside; from + FOURTHS + beside <= top; from++) {
        const auto &below = rows[static_cast<std::size_t>(from - beside - bottom)],
                   &above = rows[static_cast<std::size_t>(from + FOURTHS + beside - bottom)];
        const int first = std::max(below.first, above.first) + beside;
        const int last = std::min(below.second, above.second) - beside - FOURTHS;
        if (from < 0 || from >> 2 >= second_.cells) continue;
        for (int at = std::max(first, 0); at <= last && at >> 2 < first_.cells; at++) {
          planes_[number(part, at & 3, from & 3)].set(at >> 2, from >> 2);
        }
      }
    }
  }

  LatticeAxis first_, second_;
  std::array<Plane, 48> planes_;
};

/// Sets of cells, one for each pair of steps, word after word: all steps of 64 cells lie together.
class Reachable {
 public:
  Reachable(const LatticeAxis& first, const LatticeAxis& second, const BlockedCells& blocked)
      : first_(first), second_(second), words_(first.cells / WORD + 1) {
    now_.resize(block() * static_cast<std::size_t>(words_ * second.cells));
    next_.resize(now_.size()), allowed_.resize(now_.size());
    for_each_block([&](std::size_t begin, int word, int row) {
      for (int up = -second_.fastest; up <= second_.fastest; up++) {
        for (int on = -first_.fastest; on <= first_.fastest; on++, begin++) {
          std::uint64_t free = ~blocked.from(FOURTHS * WORD * word, FOURTHS * row, 0);
          for (int part = 1; part < FOURTHS; part++) {
            const int back = FOURTHS - part;
            free &= ~blocked.from(FOURTHS * WORD * word - back * on, FOURTHS * row - back * up, part);
          }
          const int left = first_.cells - WORD * word;
          allowed_[begin] = left >= WORD ? free : left <= 0 ? 0 : free & ((std::uint64_t{1} << left) - 1);
        }
      }
    });
  }

  bool add(int cell, int row, int on, int up) {
    if (!is_known(cell, row, on, up)) return false;
    now_[index(cell / WORD, row, on, up)] |= std::uint64_t{1} << (cell % WORD);
    return true;
  }
  bool has(int cell, int row, int on, int up) const {
    return is_known(cell, row, on, up) && (now_[index(cell / WORD, row, on, up)] >> (cell % WORD) & 1) != 0;
  }

  /// Go on for a period.
  void advance() {
    widen();
    for_each_block([&](std::size_t begin, int word, int row) {
      if (row % 16 == 0) look_at_clock();
      for (int up = -second_.fastest; up <= second_.fastest; up++) {
        for (int on = -first_.fastest; on <= first_.fastest; on++, begin++) {
          const int from = row - up, cell = WORD * word - on, number = cell >> 6, shift = cell & 63;
          std::uint64_t found = 0;
          if (allowed_[begin] != 0 && from >= 0 && from < second_.cells) {
            if (number >= 0 && number < words_) found = now_[index(number, from, on, up)] >> shift;
            if (shift != 0 && number + 1 >= 0 && number + 1 < words_) {
              found |= now_[index(number + 1, from, on, up)] << (WORD - shift);
            }
          }
          next_[begin] = found & allowed_[begin];
        }
      }
    });
    std::swap(now_, next_);
  }

 private:
  std::size_t block() const { return static_cast<std::size_t>(first_.steps() * second_.steps()); }
  std::size_t index(int word, int row, int on, int up) const {
    return static_cast<std::size_t>(row * words_ + word) * block() +
           static_cast<std::size_t>((up + second_.fastest) * first_.steps() + on + first_.fastest);
  }
  bool is_known(int cell, int row, int on, int up) const {
    return cell >= 0 && cell < first_.cells && row >= 0 && row < second_.cells && std::abs(on) <= first_.fastest &&
           std::abs(up) <= second_.fastest;
  }
  template <class Visit>
  void for_each_block(const Visit& visit) {
    for (int row = 0; row < second_.cells; row++) {
      for (int word = 0; word < words_; word++) visit(index(word, row, -first_.fastest, -second_.fastest), word, row);
    }
  }

  /// Let all steps change by what an acceleration can do, the second axis first.
  void widen() {
    const auto steps = static_cast<std::size_t>(first_.steps()), rows = static_cast<std::size_t>(second_.steps());
    std::vector<std::uint64_t> wide(steps * (rows + 2 * CHANGE)), line(steps + 2 * CHANGE);
    for_each_block([&](std::size_t begin, int, int) {
      std::uint64_t* block_begin = now_.data() + begin;
      if (std::all_of(block_begin, block_begin + steps * rows, [](std::uint64_t bits) { return bits == 0; })) return;
      std::ranges::fill(wide, 0);
      std::copy(block_begin, block_begin + steps * rows, wide.begin() + static_cast<std::ptrdiff_t>(steps * CHANGE));
      join_windows(wide.data(), rows + 2 * CHANGE, steps);
      for (std::size_t row = 0; row < rows; row++) {
        std::ranges::fill(line, 0);
        std::copy_n(wide.data() + row * steps, steps, line.begin() + CHANGE);
        join_windows(line.data(), steps + 2 * CHANGE, 1);
        std::copy_n(line.data(), steps, block_begin + row * steps);
      }
    });
  }

  /// Make each of many rows what it and the 2 CHANGE rows behind it have.
  static void join_windows(std::uint64_t* rows, std::size_t count, std::size_t width) {
    constexpr std::size_t window = 2 * CHANGE + 1;
    const auto join = [&](std::size_t ahead) {
      for (std::size_t i = 0; i + ahead * width < count * width; i++) rows[i] |= rows[i + ahead * width];
    };
    std::size_t joined = 1;
    for (; 2 * joined <= window; joined *= 2) join(joined);
    if (joined < window) join(window - joined);
  }

  LatticeAxis first_, second_;
  int words_;
  std::vector<std::uint64_t> now_, next_, allowed_;
};

/// Return the cells and steps of an axis from which a flight may come to the goal within a part of the next period.
std::vector<std::pair<int, int>> arriving(const LatticeAxis& along, double period, int part) {
  const double until = period * (part + 1) / PARTS, middle = period * (part + 0.5) / PARTS;
  const double spare = std::abs(along.last) * period / PARTS;
  const auto may_come = [&](int cell, double after) {
    const double nearest = along.low + cell * along.cell, to = along.goal - along.last * (middle + after);
    const double most = 0.5 * along.acceleration * (until + after) * (until + after) + spare + 1e-6 * along.cell;
    return to >= nearest - most && to <= nearest + along.cell + most;
  };
  std::vector<std::pair<int, int>> found;
  for (int cell = 0; cell < along.cells; cell++) {
    if (!may_come(cell, 0.0)) continue;
    for (int step = -along.fastest; step <= along.fastest; step++) {
      if (may_come(cell - step, period)) found.emplace_back(cell, step);
    }
  }
  return found;
}

}  // namespace

double least_time_among(const Airspace& airspace, const State& start, const State& goal, double most,
                        std::size_t words) {
  const double direct = least_time(start, goal, airspace.limits());
  const Vector sizes = airspace.bounds().high - airspace.bounds().low;
  const auto third = static_cast<std::size_t>(std::min_element(sizes.begin(), sizes.end()) - sizes.begin());
  const std::size_t one = third == 0 ? 1 : 0, other = third == 2 ? 1 : 2;
  const auto lattice = [&](double period, std::size_t axis) {
    return lattice_axis(airspace, start, goal, most, period, axis);
  };
  const auto words_of = [&](double period) {
    const LatticeAxis first = lattice(period, one), second = lattice(period, other);
    return static_cast<double>(first.cells / WORD + 1) * second.cells * first.steps() * second.steps();
  };
  // So few periods are looked at that shorter ones would not reach the largest time.
  const auto fits = [&](double period) {
    return MOST_PERIODS * period >= most && words_of(period) <= static_cast<double>(words);
  };
  double period = 0.5 * direct;
  if (direct >= most || !fits(period)) return std::min(direct, most);
  while (fits(period * FINER)) period *= FINER;
  const LatticeAxis first = lattice(period, one), second = lattice(period, other);
  Reachable reachable(first, second, BlockedCells(airspace, first, second));
  // Before it begins, a flight is as if it had kept its velocity.
  const auto begin = [&](const LatticeAxis& along) {
    const double at = start.position[along.axis];
    const int cell = along.cell_of(at);
    return std::pair{cell, cell - along.cell_of(at - start.velocity[along.axis] * period)};
  };
  const auto [cell, on] = begin(first);
  const auto [row, up] = begin(second);
  if (!reachable.add(cell, row, on, up)) return direct;
  for (int number = 0; number * period < most; number++) {
    for (int part = 0; part < PARTS; part++) {
      const double time = period * (number + static_cast<double>(part) / PARTS);
      if (time <= direct - period / PARTS) continue;
      const auto on_first = arriving(first, period, part), on_second = arriving(second, period, part);
      for (const auto& [x, dx] : on_first) {
        for (const auto& [y, dy] : on_second) {
          if (reachable.has(x, y, dx, dy)) return std::clamp(time, direct, most);
        }
      }
    }
    reachable.advance();
  }
  return most;
}

}  // namespace evenroad::flight
