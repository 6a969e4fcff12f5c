// The motions of a robot's links and the torques for them, by Newton and Euler's equations, eight states at once.
//
// Forces are summed from the tips to the root (Luh, Walker and Paul 1980).  Each vector is in its own frame.  A step
// from frame to frame is then a rotation about z and a constant rotation.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "common/lanes.hpp"
#include "common/matrix.hpp"
#include "robot/chain.hpp"

namespace evenroad::robot {

/// A frame that a joint moves, `before` in its parent's frame, and the mass that is fixed to it.
struct MovingLink {
  ChainJoint joint;
  int parent;  // less than its own number; -1 is the root, which does not move
  double mass;
  Vector centre;                  // of the mass
  std::array<double, 9> inertia;  // about the centre, row by row
};

/// Parents come first.
struct MovingLinks {
  std::size_t dim;  // of a configuration
  std::vector<MovingLink> links;
};

/// Number of states that are computed at once.
constexpr std::size_t STATES = 8;
using States = Lanes<double, STATES>;

struct Vectors {
  States x{}, y{}, z{};
};

EVENROAD_INLINE Vectors operator+(const Vectors& a, const Vectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
EVENROAD_INLINE Vectors operator*(const Vectors& a, double b) { return {a.x * b, a.y * b, a.z * b}; }

EVENROAD_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
EVENROAD_INLINE Vectors cross(const Vectors& a, const Vector& b) {
  return {a.y * b[2] - a.z * b[1], a.z * b[0] - a.x * b[2], a.x * b[1] - a.y * b[0]};
}
EVENROAD_INLINE Vectors cross(const Vector& a, const Vectors& b) {
  return {a[1] * b.z - a[2] * b.y, a[2] * b.x - a[0] * b.z, a[0] * b.y - a[1] * b.x};
}
EVENROAD_INLINE States dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Eight states of a robot's links.
class MovingStates {
 public:
  explicit MovingStates(const MovingLinks& links);

  /// Take configurations, (dim,).
  void move_to(std::span<const States> q);

  /// Set velocities, none for links at rest, and accelerations, (dim,); the root has the acceleration `pulled`.
  void move(std::span<const States> velocity, std::span<const States> acceleration, const Vector& pulled);

  /// Return the acceleration of a point of a link, in the link's frame.
  Vectors acceleration(std::size_t link, const Vector& point) const;

  /// Write the torques, (dim,), that this motion needs.
  void write_torques(std::span<States> torques);

 private:
  /// The angular velocity of a frame, and its angular and linear accelerations.
  struct Motion {
    Vectors turn, turned, pushed;
  };
  struct Load {
    Vectors force, moment;
  };

  const MovingLinks& links_;
  /// The angle or slide of each joint.
  std::vector<States> sines_, cosines_, slides_;
  std::vector<Motion> motions_;
  std::vector<Load> loads_;
};

/// Read up to eight rows from `first` on, coordinate by coordinate; the last row is repeated.
void read_rows(Matrix<const double> rows, std::size_t first, std::span<States> columns);

/// Write the torques of states, (n, dim) each; the root has the acceleration `pulled`.
void write_torques(const MovingLinks& links, Matrix<const double> q, Matrix<const double> velocity,
                   Matrix<const double> acceleration, const Vector& pulled, Matrix<double> torques);

}  // namespace evenroad::robot
