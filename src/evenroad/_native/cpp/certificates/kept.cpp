// How far a direction or a point is off, at both ends of a stretch, and how far it strays from that in between.
#include "certificates/kept.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::certificates {

namespace {

constexpr double SLACK = 5e-10;  // half of what a checker lets a limit be exceeded by

Vector seen_along(const Turn& along, const Vector& v) { return {dot(along[0], v), dot(along[1], v), dot(along[2], v)}; }

double off(const Kept& kept, const Vector& at) {
  if (kept.kind == KeptKind::AXIS) return std::sqrt(squared_length(at - kept.target));
  const Vector seen = seen_along(kept.along, at);
  Vector out{};
  for (int axis = 0; axis < 3; axis++) {
    out[axis] = std::max({kept.low[axis] - seen[axis], seen[axis] - kept.high[axis], 0.0});
  }
  return std::sqrt(squared_length(out));
}

}  // namespace

Keeping keeping(Motions& motions, const Kept& kept, const Task& task) {
  const bool is_axis = kept.kind == KeptKind::AXIS;
  const double reach = is_axis ? 0.0 : std::sqrt(squared_length(kept.own));
  const Carried carried = motions.carried(task, kept.frame, reach);
  const Moving& moving = carried.moving;
  const Vector from = is_axis ? Vector{} : moving.origin, own = placed(moving, kept.own) - moving.origin + from;
  const Vector velocity = cross(moving.screw.spin, own) + (is_axis ? Vector{} : moving.screw.drift);
  const double accelerated = is_axis ? carried.turning * carried.turning + carried.bending : carried.stray;
  const double strayed =
      0.5 * carried.half * carried.half * accelerated + std::sqrt(is_axis ? carried.twisted : carried.loose);
  // A convex function is largest at an end.
  const double worst = std::max(off(kept, own + velocity * carried.half), off(kept, own - velocity * carried.half));
  if (worst + strayed <= kept.limit + SLACK) return Keeping::KEPT;
  return off(kept, own) > kept.limit + SLACK ? Keeping::LEFT : Keeping::OPEN;
}

}  // namespace evenroad::certificates
