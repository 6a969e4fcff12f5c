// The words are those of J. Reeds and L. Shepp, 1990, in the formulas of sections 8.1 to 8.11, and of L. Dubins, 1957.
// Lengths are in radii here, the start is the origin, and symmetries make all words of a few.
#include "drive/words.hpp"

#include <initializer_list>
#include <iterator>

namespace evenroad::drive {

namespace {

/// A turn, or a drive, that is shorter comes of rounding: to the right it is no full turn to the left [rad].
constexpr double NO_TURN = 1e-10;

/// A point by its distance from the origin and its direction, which is rounding where it is that near.
struct Polar {
  double x, y, r;
  Polar(double x_of, double y_of) : x(x_of), y(y_of), r(std::sqrt(x * x + y * y)) {}
  double angle() const { return r < NO_TURN ? 0.0 : std::atan2(y, x); }
};

/// Return an angle in [0, 2 pi).
double turned_left(double angle) {
  const double turn = angle - 2.0 * PI * std::floor(angle / (2.0 * PI));
  return turn < 2.0 * PI - NO_TURN ? turn : 0.0;
}

/// Return an angle in [-pi, pi], one that rounding has moved below 0, or beyond pi, where it was.
double forwards(double angle) {
  const double turn = wrapped(angle);
  return std::abs(turn) < NO_TURN ? 0.0 : turn < NO_TURN - PI ? turn + 2.0 * PI : turn;
}

/// The same of an angle that rounding has moved above 0, or beyond -pi.
double backwards(double angle) { return -forwards(-angle); }

/// The first and the last turn of a word of four or five.
struct Outer {
  double first, last;
};

}  // namespace

/// The words of one symmetry: what is written as a turn to the left is one to the right where `side` is -1, and what is
/// forwards is backwards where `gear` is -1.
class Curves {
 public:
  Curves(Words& words, const Steering& steering, const Pose& to, int side, int gear)
      : words_(words),
        steering_(steering),
        side_(side),
        gear_(gear),
        x_(gear * to.x),
        y_(side * to.y),
        phi_(gear * side * to.angle),
        sine_(std::sin(phi_)),
        cosine_(std::cos(phi_)),
        same_(x_ - sine_, y_ - 1.0 + cosine_),
        other_(x_ + sine_, y_ - 1.0 - cosine_) {}

  /// Words that drive forwards.
  void add_dubins() {
    const double first = same_.angle();
    add({{1, turned_left(first)}, {0, same_.r}, {1, turned_left(phi_ - first)}});
    if (other_.r >= 2.0) {
      const double u = std::sqrt(other_.r * other_.r - 4.0), t = turned_left(other_.angle() + std::atan2(2.0, u));
      add({{1, t}, {0, u}, {-1, turned_left(t - phi_)}});
    }
    if (same_.r <= 4.0) {
      const double u = -2.0 * std::asin(0.25 * same_.r), t = turned_left(first + 0.5 * u + PI);
      add({{1, t}, {-1, 2.0 * PI + u}, {1, turned_left(phi_ - t + u)}});
    }
  }

  void add_reeds_shepp() {
    add_straight();
    for (const bool is_flipped : {false, true}) add_with_cusp(is_flipped);
    add_four();
  }

 private:
  /// A turn, a straight drive, a turn.
  void add_straight() {
    const double first = forwards(same_.angle()), last = forwards(phi_ - first);
    if (first >= 0.0 && last >= 0.0) add({{1, first}, {0, same_.r}, {1, last}});
    if (other_.r < 2.0) return;
    const double u = std::sqrt(other_.r * other_.r - 4.0), t = forwards(other_.angle() + std::atan2(2.0, u));
    if (const double v = forwards(t - phi_); t >= 0.0 && v >= 0.0) add({{1, t}, {0, u}, {-1, v}});
  }

  /// Three turns, or four pieces, that begin and end in different directions; flipped, they are driven from their end.
  void add_with_cusp(bool is_flipped) {
    const double x = is_flipped ? x_ * cosine_ + y_ * sine_ : x_, y = is_flipped ? x_ * sine_ - y_ * cosine_ : y_;
    const Polar same(x - sine_, y - 1.0 + cosine_), other(x + sine_, y - 1.0 - cosine_);
    const double angle = same.angle();
    if (same.r <= 4.0) {
      const double u = -2.0 * std::asin(0.25 * same.r), t = forwards(angle + 0.5 * u + PI);
      const double v = wrapped(phi_ - t + u);
      if (t >= 0.0 && u <= 0.0) add({{1, t}, {-1, u}, {1, v}}, is_flipped);
    }
    if (same.r >= 2.0) {
      const double r = std::sqrt(same.r * same.r - 4.0), u = 2.0 - r, t = forwards(angle + std::atan2(r, -2.0));
      const double v = backwards(phi_ - 0.5 * PI - t);
      if (t >= 0.0 && u <= 0.0 && v <= 0.0) add({{1, t}, {-1, -0.5 * PI}, {0, u}, {1, v}}, is_flipped);
    }
    if (other.r >= 2.0) {
      const double t = forwards(Polar(1.0 + cosine_ - y, x + sine_).angle()), u = 2.0 - other.r;
      const double v = backwards(t + 0.5 * PI - phi_);
      if (t >= 0.0 && u <= 0.0 && v <= 0.0) add({{1, t}, {-1, -0.5 * PI}, {0, u}, {-1, v}}, is_flipped);
    }
  }

  /// Four turns, or two turns on both sides of a straight drive.
  void add_four() {
    const double xi = x_ + sine_, eta = y_ - 1.0 - cosine_, square = xi * xi + eta * eta;
    if (const double rho = 0.25 * (2.0 + std::sqrt(square)); rho <= 1.0) {
      const double u = std::acos(rho);
      const auto [first, last] = outer(xi, eta, u, -u);
      const double t = forwards(first), v = backwards(last);
      if (t >= 0.0 && v <= 0.0) add({{1, t}, {-1, u}, {1, -u}, {-1, v}});
    }
    if (const double rho = (20.0 - square) / 16.0; rho >= 0.0 && rho <= 1.0) {
      const double u = -std::acos(rho);
      const auto [first, last] = outer(xi, eta, u, u);
      const double t = forwards(first), v = forwards(last);
      if (t >= 0.0 && v >= 0.0) add({{1, t}, {-1, u}, {1, u}, {-1, v}});
    }
    if (square < 4.0) return;
    const double u = 4.0 - std::sqrt(square - 4.0);
    if (u > 0.0) return;
    const double t = forwards(std::atan2((4.0 - u) * xi - 2.0 * eta, -2.0 * xi + (u - 4.0) * eta));
    const double v = forwards(t - phi_);
    if (t >= 0.0 && v >= 0.0) add({{1, t}, {-1, -0.5 * PI}, {0, u}, {1, -0.5 * PI}, {-1, v}});
  }

  Outer outer(double xi, double eta, double u, double v) const {
    const double d = wrapped(u - v), a = std::sin(u) - std::sin(d), b = std::cos(u) - std::cos(d) - 1.0;
    const double angle = std::atan2(eta * a - xi * b, xi * a + eta * b);
    const bool is_opposite = 2.0 * (std::cos(d) - std::cos(v) - std::cos(u)) + 3.0 < 0.0;
    const double first = wrapped(is_opposite ? angle + PI : angle);
    return {first, wrapped(first - u + v - phi_)};
  }

  void add(std::initializer_list<Piece> pieces, bool is_flipped = false) {
    Word word;
    word.count = static_cast<int>(pieces.size());
    int i = 0;
    for (const Piece& piece : pieces) {
      word.piece[is_flipped ? word.count - 1 - i : i] = {piece.side * side_, gear_ * piece.length};
      i++;
    }
    words_.add(steering_, word);
  }

  Words& words_;
  const Steering& steering_;
  int side_, gear_;
  double x_, y_, phi_, sine_, cosine_;
  Polar same_, other_;
};

// A car without reverse that is sought from its goal drives backwards alone: the plane is mirrored for it.
Words::Words(const Steering& steering, const Pose& from, const Pose& to, bool is_backwards) {
  const int flip = is_backwards && !steering.is_reversing ? -1 : 1;
  const double unit = steering.per_radian(), c = std::cos(from.angle), s = std::sin(from.angle);
  const double dx = (to.x - from.x) / unit, dy = (to.y - from.y) / unit, turn = wrapped(to.angle - from.angle);
  if (steering.radius == 0.0) {
    const Polar by(c * dx + s * dy, c * dy - s * dx);
    for (const int gear : {1, -1}) {
      if (!steering.is_reversing && gear != flip) continue;
      const double heading = by.r < NO_TURN ? 0.0 : wrapped(gear > 0 ? by.angle() : by.angle() + PI);
      for (const double first : {heading, heading - std::copysign(2.0 * PI, heading)}) {
        for (const double whole : {0.0, 2.0 * PI}) {
          const double rest = wrapped(turn - heading), last = rest - std::copysign(whole, rest);
          Word word;
          word.count = 3;
          word.piece = {Piece{first < 0.0 ? -1 : 1, std::abs(first)}, Piece{0, gear * by.r},
                        Piece{last < 0.0 ? -1 : 1, std::abs(last)}};
          add(steering, word);
        }
      }
    }
    return;
  }
  const Pose goal{flip * (c * dx + s * dy), c * dy - s * dx, flip * turn};
  for (const int side : {1, -1}) {
    if (!steering.is_reversing) {
      // Forwards in the mirrored plane is backwards in this one.
      Curves(*this, steering, goal, side, 1).add_dubins();
      continue;
    }
    for (const int gear : {1, -1}) Curves(*this, steering, goal, side, gear).add_reeds_shepp();
  }
  if (flip > 0) return;
  for (std::size_t i = 0; i < count_; i++) {
    for (int k = 0; k < words_[i].count; k++) words_[i].piece[k].length *= -1.0;
  }
}

/// Add a word whose lengths are in radii.
void Words::add(const Steering& steering, Word word) {
  for (int k = 0; k < word.count; k++) {
    word.piece[k].length *= steering.per_radian();
    word.length += std::abs(word.piece[k].length);
  }
  word.cost = word.length + steering.cusp * cusps(steering, word.pieces());
  words_[count_++] = word;
}

const Word& Words::best() const {
  return *std::ranges::min_element(all(), {}, [](const Word& word) { return word.cost; });
}

std::vector<Word> Words::cheapest(double most) const {
  std::vector<Word> found;
  std::ranges::copy_if(all(), std::back_inserter(found), [&](const Word& word) { return word.cost < most; });
  std::ranges::stable_sort(found, {}, [](const Word& word) { return word.cost; });
  return found;
}

Word Word::in(double unit) const {
  Word word = *this;
  for (Piece& each : word.piece) each.length /= unit;
  word.length /= unit, word.cost /= unit;
  return word;
}

Curve::Curve(const Steering& steering, const Pose& a, const Pose& b)
    : from(a), is_reversed(steering.is_reversing && is_before(b, a)) {
  if (is_reversed) from = b;
  word = Words(steering, from, is_reversed ? a : b).best();
}

Pose Curve::at(const Steering& steering, double share) const {
  return pose_after(steering, from, word.pieces(), (is_reversed ? 1.0 - share : share) * word.length);
}

}  // namespace evenroad::drive
