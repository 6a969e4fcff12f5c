// Contact of bodies by balls around them, then by balls around capsules, then by segments; hulls come last.
#include "robot/self_contact.hpp"

namespace evenroad::robot {

namespace {

/// Return the mask of lanes in which two centres are nearer to each other than `near`.
EVENROAD_INLINE Mask within(const Vec3x16& a, const Vec3x16& b, float near) {
  const Vec3x16 offset = a - b;
  return below_zero(dot(offset, offset) - near * near);
}

}  // namespace

// Segments are `centre + s half`, s from -1 to 1.  First the best t for all s is found, clipped to the range, then the
// best s for that t, clipped, then the best t for that s, clipped again.  Without the last step, contacts can be missed
// by millimetres if s was clipped (after V. Lumelsky, 1985, and C. Ericson, Real-Time Collision Detection, 2005,
// section 5.1.9).  The first t comes from components across the first segment.  The usual formula with products of
// lengths loses twice the digits for nearly parallel segments; with components, the error is about the rounding of the
// half lengths.
Floats16 squared_distance(const PlacedCapsule& a, const PlacedCapsule& b, const CapsulePair& pair) {
  const Vec3x16 r = a.centre - b.centre, e = a.half, f = b.half;
  const Floats16 ef = dot(e, f), er = dot(e, r), fr = dot(f, r);
  const Floats16 along_f = ef * pair.one_by_ee, along_r = er * pair.one_by_ee;
  const Vec3x16 across_f = minus(f, e, along_f), across_r = minus(r, e, along_r);
  Floats16 t = cut(dot(across_f, across_r) / max(dot(across_f, across_f), spread(LEAST_SQUARE)));
  const Floats16 s = cut(fma(along_f, t, -along_r));
  t = cut(fma(ef, s, fr) * pair.one_by_ff);
  const Vec3x16 offset = minus(plus(r, e, s), f, t);
  return dot(offset, offset);
}

Mask capsules_touching(const PlacedCapsule& a, const PlacedCapsule& b, const CapsulePair& pair, float reach) {
  return below_zero(squared_distance(a, b, pair) - reach * reach);
}

Mask meeting_itself(const Robot& robot, const Lengths& lengths, PlacedRobot& placed, Mask blocked, Wanted wanted,
                    Contact* found) {
  const int by_hulls = robot.first_hull_pair();
  for (int p = 0; p < static_cast<int>(robot.body_pairs.size()); p++) {
    const auto& [a, b, pairs] = robot.body_pairs[p];
    const Vec3x16& other = placed.bodies[b].centre;
    if ((within(placed.bodies[a].centre, other, lengths.body_pairs[p]) & ~blocked) == 0) continue;
    const int row = robot.bodies[b].capsules.size();
    Mask undecided = 0;
    int first_undecided = -1;
    for (int first = pairs.first; first < pairs.end; first += row) {
      const int i = robot.pairs[first].first;
      if (row > FEW && robot.capsules[i].is_ball) {
        // A ball that is far from the ball around the whole body is far from its capsules.
        const float near = lengths.capsules[i] + lengths.bodies[b].radius;
        if ((within(placed.capsules[i].centre, other, near) & ~blocked) == 0) continue;
      }
      for (int k = first; k < first + row; k++) {
        const CapsulePair& pair = robot.pairs[k];
        const auto [near, reach] = lengths.pairs[k];
        const PlacedCapsule &one = placed.capsules[pair.first], &two = placed.capsules[pair.second];
        Mask touching = within(one.centre, two.centre, near);
        if ((touching & ~blocked) == 0) continue;
        // Two balls need no more.
        if (pair.one_by_ee + pair.one_by_ff > 0) touching = capsules_touching(one, two, pair, reach);
        if (p >= by_hulls) {
          if (undecided == 0 && touching != 0) first_undecided = k;
          undecided |= touching;
          continue;
        }
        if (found != nullptr && blocked == 0 && touching != 0) *found = {Contact::With::ITSELF, -1, k};
        blocked |= with_others(touching, wanted);
        if (is_enough(blocked, wanted)) return blocked;
      }
    }
    undecided &= ~blocked;
    if (undecided == 0) continue;
    const float margin = lengths.hull_margins[p - by_hulls];
    const Mask meeting = hulls_meeting({robot.hulls, robot.bodies[a].hulls, placed.frames[robot.bodies[a].frame]},
                                       {robot.hulls, robot.bodies[b].hulls, placed.frames[robot.bodies[b].frame]},
                                       margin, undecided, wanted, &placed.kept_of_itself);
    if (found != nullptr && blocked == 0 && meeting != 0) *found = {Contact::With::ITSELF, -1, first_undecided};
    blocked |= with_others(meeting, wanted);
    if (is_enough(blocked, wanted)) return blocked;
  }
  return blocked;
}

}  // namespace evenroad::robot
