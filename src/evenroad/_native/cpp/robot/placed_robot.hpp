// The poses of frames, bodies and capsules at sixteen configurations.
#pragma once

#include <array>

#include "robot/robot.hpp"
#include "robot/rough_boxes.hpp"

namespace evenroad::robot {

using Doubles16 = Lanes<double, 16>;

/// A frame in the root's frame.
struct PlacedFrame {
  Vec3x16 rows[3];  // of its rotation
  Vec3x16 origin;

  /// Return directions of this frame in the root's frame, and the inverse.
  EVENROAD_INLINE Vec3x16 turned(Vec3x16 v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  EVENROAD_INLINE Vec3x16 turned_back(Vec3x16 v) const { return combine(rows[0], v.x, rows[1], v.y, rows[2], v.z); }
};

/// Return parameters on segments `centre + s half`, clipped to s from -1 to 1.
EVENROAD_INLINE Floats16 cut(Floats16 share) { return clamp(share, spread(-1), spread(1)); }

struct PlacedBody {
  Vec3x16 centre, half;  // half extents of the box around its capsules, along the root's axes
  RoughBoxes rough;      // that box: written by the check against obstacles
};

struct PlacedCapsule {
  Vec3x16 centre, half;  // half is the vector to an endpoint of the segment
  RoughBoxes rough;      // around its spheres: as above
};

/// The last decision about two nodes of trees of hulls.
struct Kept {
  int first = -1, second = -1;
  Vec3 normal;  // of a plane that separated them, in the frame of the second; 0 if none is known
  Vec3 point;   // of the first that was near the second, in the frame of the first
  bool has_point = false;
};

/// The end of the last search for a plane between two leaves.
struct KeptEnd {
  int first = -1, second = -1;
  Ended ended;
};

class KeptOfPairs {
 public:
  /// Return the slot of the end of a search between two leaves.
  Ended& end_of(int first, int second) {
    KeptEnd& kept = searches_[static_cast<std::size_t>(37 * first + second) % searches_.size()];
    if (kept.first != first || kept.second != second) kept.first = first, kept.second = second, kept.ended.size = 0;
    return kept.ended;
  }

  /// Return the slot of two nodes; an entry of others there is overwritten.
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
  KeptOfPairs kept, kept_of_itself;  // caches for obstacles and for the robot itself; no result depends on them

  /// Memory for a robot's poses, with those that no joint moves filled in.
  explicit PlacedRobot(const Robot& robot);

  /// Write the moving poses for sixteen configurations: sixteen numbers per coordinate.
  void move_to(const Robot& robot, const Lengths& lengths, std::span<const Doubles16> states);

  /// Write the boxes around bodies again, for other lengths.
  void write_boxes(const Robot& robot, const Lengths& lengths);
};

/// Number of capsules up to which a body needs no box around all of them.
constexpr int FEW = 3;

}  // namespace evenroad::robot
