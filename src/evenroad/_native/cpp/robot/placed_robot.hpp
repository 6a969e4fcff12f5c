// Where frames, bodies and capsules are at sixteen configurations.
#pragma once

#include <array>

#include "robot/robot.hpp"

namespace evenroad::robot {

using Doubles16 = Lanes<double, 16>;

/// A frame in the root's frame.
struct PlacedFrame {
  Vec3x16 rows[3];  // of its rotation
  Vec3x16 origin;

  /// Return directions of this frame as the root's frame sees them, and the other way round.
  EVENROAD_INLINE Vec3x16 turned(Vec3x16 v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  EVENROAD_INLINE Vec3x16 turned_back(Vec3x16 v) const { return combine(rows[0], v.x, rows[1], v.y, rows[2], v.z); }
};

/// Return places of segments `centre + s half` cut to the segments, s from -1 to 1.
EVENROAD_INLINE Floats16 cut(Floats16 share) { return clamp(share, spread(-1), spread(1)); }

struct PlacedBody {
  Vec3x16 centre, half;  // half extents of the box around its capsules, along the root's axes
  Box16 around;          // in all lanes: written by the check against obstacles
};

struct PlacedCapsule {
  Vec3x16 centre, half;  // half is the way to an end of the segment
  Box16 around;
};

/// What decided about two nodes of trees of hulls last.
struct Kept {
  int first = -1, second = -1;
  Vec3 normal;  // of a plane that separated them, in the frame of the second; 0 where none is known
  Vec3 point;   // of the first that was near the second, in the frame of the first
  bool has_point = false;
};

/// Where the last search for a plane between two leaves ended.
struct KeptEnd {
  int first = -1, second = -1;
  Ended ended;
};

class KeptOfPairs {
 public:
  /// Return the same of the end of a search between two leaves.
  Ended& end_of(int first, int second) {
    KeptEnd& kept = searches_[static_cast<std::size_t>(37 * first + second) % searches_.size()];
    if (kept.first != first || kept.second != second) kept.first = first, kept.second = second, kept.ended.size = 0;
    return kept.ended;
  }

  /// Return where that of two nodes is kept; what is there of others is forgotten.
  Kept& of(int first, int second) {
    Kept& kept = kept_[static_cast<std::size_t>(37 * first + second) % kept_.size()];
    if (kept.first != first || kept.second != second) kept = {first, second, {}, {}, false};
    return kept;
  }

 private:
  std::array<Kept, 512> kept_;
  std::array<KeptEnd, 64> searches_;
};

struct PlacedRobot {
  std::vector<PlacedFrame> frames;  // the root's first
  std::vector<PlacedBody> bodies;
  std::vector<PlacedCapsule> capsules;
  KeptOfPairs kept, kept_of_itself;  // of true shapes and obstacles, of hulls of the robot: no answer depends on them

  /// Room for a robot's places, with those that no joint moves.
  explicit PlacedRobot(const Robot& robot);

  /// Write what moves for sixteen configurations: sixteen numbers a coordinate.
  void move_to(const Robot& robot, const Lengths& lengths, std::span<const Doubles16> states);

  /// Write the boxes around bodies again, for other lengths.
  void write_boxes(const Robot& robot, const Lengths& lengths);
};

/// Bodies of so few capsules need no box around all of them.
constexpr int FEW = 3;

}  // namespace evenroad::robot
