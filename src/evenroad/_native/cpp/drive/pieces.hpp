// A car, and what it drives: pieces of constant steering, one after the other.
#pragma once

#include <span>
#include <vector>

#include "drive/checks.hpp"

namespace evenroad::drive {

/// A turn to the left (side 1) or right (-1), or a straight drive (0); backwards where the length is negative.
struct Piece {
  int side = 0;
  double length = 0.0;

  bool operator==(const Piece&) const = default;
};

/// How a car steers, in units of length of its own.
struct Steering {
  double radius;      ///< Least turning radius; 0 turns on the spot.
  double spot;        ///< Length that counts for a radian of a turn on the spot.
  bool is_reversing;  ///< Whether it may drive backwards.
  double cusp = 0.0;  ///< Length that counts for a change of direction.

  /// Length of a radian of any turn.
  double per_radian() const { return radius > 0.0 ? radius : spot; }
  bool is_on_the_spot(const Piece& piece) const { return radius == 0.0 && piece.side != 0; }
  /// The same in another unit.
  Steering in(double unit) const { return {radius / unit, spot / unit, is_reversing, cusp / unit}; }

  Motion motion(const Pose& from, const Piece& piece) const;
  Pose after(const Pose& from, const Piece& piece) const { return motion(from, piece).at(1.0); }
};

/// Counts changes between forwards and backwards, piece by piece.
class Gears {
 public:
  explicit Gears(const Steering& steering) : steering_(steering) {}
  void drive(const Piece& piece);
  int cusps() const { return cusps_; }

 private:
  const Steering& steering_;
  double before_ = 0.0;
  int cusps_ = 0;
};

/// Return how often pieces change between forwards and backwards.
int cusps(const Steering& steering, std::span<const Piece> pieces);

/// Return the length of pieces, with what their changes of direction count.
double cost(const Steering& steering, std::span<const Piece> pieces);

/// Return the pose after a length of pieces.
Pose pose_after(const Steering& steering, Pose from, std::span<const Piece> pieces, double length);

/// Say whether all poses along pieces are free, of which the first is.
bool are_free(Checks& checks, const Steering& steering, const Pose& from, std::span<const Piece> pieces);

/// Return how much of the length of pieces is proved free from their begin on, at most `tolerance` less than is free;
/// 0 where the first pose is not.
double free_length(Checks& checks, const Steering& steering, const Pose& from, std::span<const Piece> pieces,
                   double tolerance);

}  // namespace evenroad::drive
