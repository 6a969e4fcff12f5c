#include "drive/pieces.hpp"

#include <cmath>

namespace evenroad::drive {

namespace {

/// A shorter piece is none, as far as a change of direction is concerned [radians of a turn].
constexpr double NO_LENGTH = 1e-9;
/// Number of halves after which rounding is left of a length.
constexpr int MOST_HALVES = 60;

}  // namespace

Motion Steering::motion(const Pose& from, const Piece& piece) const {
  if (piece.side == 0) return Motion::straight(from, piece.length);
  if (radius == 0.0) return Motion::on_the_spot(from, piece.side * piece.length / spot);
  return Motion::arc(from, piece.side / radius, piece.length);
}

void Gears::drive(const Piece& piece) {
  if (std::abs(piece.length) <= NO_LENGTH * steering_.per_radian() || steering_.is_on_the_spot(piece)) return;
  if (before_ * piece.length < 0.0) cusps_++;
  before_ = piece.length;
}

int cusps(const Steering& steering, std::span<const Piece> pieces) {
  Gears gears(steering);
  for (const Piece& piece : pieces) gears.drive(piece);
  return gears.cusps();
}

double cost(const Steering& steering, std::span<const Piece> pieces) {
  double sum = steering.cusp * cusps(steering, pieces);
  for (const Piece& piece : pieces) sum += std::abs(piece.length);
  return sum;
}

Pose pose_after(const Steering& steering, Pose from, std::span<const Piece> pieces, double length) {
  for (const Piece& piece : pieces) {
    const double own = std::abs(piece.length);
    if (length <= own) return steering.after(from, {piece.side, std::copysign(length, piece.length)});
    from = steering.after(from, piece), length -= own;
  }
  return from;
}

// Poses first: they cost less than motions, and refuse most of what is blocked.
bool are_free(Checks& checks, const Steering& steering, const Pose& from, std::span<const Piece> pieces) {
  Pose at = from;
  for (const Piece& piece : pieces) {
    at = steering.after(at, piece);
    if (!checks.is_free(at)) return false;
  }
  at = from;
  for (const Piece& piece : pieces) {
    const Motion motion = steering.motion(at, piece);
    if (!checks.is_free_between(motion)) return false;
    at = motion.at(1.0);
  }
  return true;
}

double free_length(Checks& checks, const Steering& steering, const Pose& from, std::span<const Piece> pieces,
                   double tolerance) {
  if (!checks.is_free(from)) return 0.0;
  Pose at = from;
  double driven = 0.0;
  for (const Piece& piece : pieces) {
    const Motion motion = steering.motion(at, piece);
    if (!checks.is_free(motion)) {
      // What is free of a piece is found by halves: each is proved as a motion of its own.
      double low = 0.0, high = std::abs(piece.length);
      for (int k = 0; k < MOST_HALVES && high - low > tolerance; k++) {
        const double middle = 0.5 * (low + high);
        const Piece part{piece.side, std::copysign(middle, piece.length)};
        (checks.is_free(steering.motion(at, part)) ? low : high) = middle;
      }
      return driven + low;
    }
    driven += std::abs(piece.length), at = motion.at(1.0);
  }
  return driven;
}

}  // namespace evenroad::drive
