// Constraints of a certificate: a direction of a link stays near another, or a point of a link in a box.
#pragma once

#include "certificates/motions.hpp"

namespace evenroad::certificates {

enum class KeptKind { AXIS, POINT };

/// A direction `own` of a frame that stays within a distance `limit` of the unit vector `target`; or a point `own` of a
/// frame that stays within `limit` of the box from `low` to `high`, along the rows of `along`.
struct Kept {
  KeptKind kind = KeptKind::AXIS;
  std::int64_t frame = 0;
  double limit = 0.0;
  Vector own{}, target{};
  Turn along{};
  Vector low{}, high{};
};

enum class Keeping { KEPT, OPEN, LEFT };

/// Return whether a constraint is shown to be kept during a whole task, or is not kept in its middle.
Keeping keeping(Motions& motions, const Kept& kept, const Task& task);

}  // namespace evenroad::certificates
