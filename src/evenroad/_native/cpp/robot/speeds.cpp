// A point that a joint turns has a speed equal to its distance from the joint's axis.  Its acceleration is a sum over
// pairs of joints.  With rates r of joints, counted from the root, it is at most
//
//   sum over m of r_m arm_m (2 sum over j < m of turn_j + turn_m)
//
// where arm_m is the largest distance of the point from axis m (1 if that slides), and turn_j is r_j (0 if that
// slides). The velocity of a point by joint m is turned by the joints before it, and by m itself.
#include "robot/speeds.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

/// Error of velocities in single precision, as a share: some tens of roundings.
constexpr double LOST = 2e-5;

/// Write sums over the coordinates of arms times movements, and times weights if there are any.
void write_sums(const OwnMatrix<double>& arms, std::span<const double> direction, std::span<double> sums,
                std::span<const double> weights = {}) {
  std::fill(sums.begin(), sums.end(), 0.0);
  for (std::size_t k = 0; k < direction.size(); k++) {
    const double size = std::abs(direction[k]) * (weights.empty() ? 1.0 : weights[k]);
    const auto row = arms[k];
    for (std::size_t i = 0; i < sums.size(); i++) sums[i] += row[i] * size;
  }
}

/// Return an upper bound of the square roots of all lanes.
double largest_root(Floats16 squares) { return std::sqrt(static_cast<double>(largest(squares))); }

/// Write the factor of each coordinate's movement in the acceleration; return the sum of all turns.
double write_weights(const Robot& robot, std::span<const double> direction, std::span<double> weights) {
  std::fill(weights.begin(), weights.end(), -1.0);
  double turns = 0.0;
  bool one_each = true;
  for (const Frame& frame : robot.frames) {
    const double turn = frame.slides ? 0.0 : std::abs(frame.multiplier * direction[frame.coordinate]);
    double& weight = weights[frame.coordinate];
    one_each &= weight < 0.0;
    weight = 2.0 * turns + turn;
    turns += turn;
  }
  // For coordinates that move several frames, the order of joints is unknown.
  for (double& weight : weights) weight = one_each ? std::max(weight, 0.0) : 2.0 * turns;
  return turns;
}

}  // namespace

Speeds::Speeds(const Robot& robot)
    : directions(robot.dim()),
      capsules(robot.arms.columns),
      pairs(robot.pair_arms.columns),
      shapes(robot.bodies.size()),
      velocities_(robot.frames.size() + 1),
      accelerations_(robot.arms.columns),
      shape_accelerations_(robot.bodies.size()),
      weights_(robot.dim()) {}

void Speeds::take_anywhere(const Robot& robot, std::span<const double> direction) {
  write_sums(robot.arms, direction, capsules);
  write_sums(robot.pair_arms, direction, pairs);
  write_sums(robot.shape_arms, direction, shapes);
}

void Speeds::take_here(const Robot& robot, const PlacedRobot& placed, std::span<const double> longest, double half) {
  const Floats16 still{};
  velocities_[0].along = velocities_[0].turning = {still, still, still};
  double slides = 0.0;
  for (std::size_t i = 0; i < robot.frames.size(); i++) {
    const Frame& frame = robot.frames[i];
    const Velocity& below = velocities_[frame.parent];
    Velocity& here = velocities_[i + 1];
    const PlacedFrame& at = placed.frames[i + 1];
    const Vec3x16 axis{at.rows[0].z, at.rows[1].z, at.rows[2].z};
    here.along = below.along + cross(below.turning, at.origin - placed.frames[frame.parent].origin);
    here.turning = below.turning;
    Vec3x16& moved = frame.slides ? here.along : here.turning;
    moved = plus(moved, axis, spread(static_cast<float>(frame.multiplier)) * directions[frame.coordinate]);
    if (frame.slides) slides += std::abs(frame.multiplier * longest[frame.coordinate]);
  }
  const double turns = write_weights(robot, longest, weights_);
  const double lost = LOST * (slides + turns * robot.reach);
  write_sums(robot.arms, longest, accelerations_, weights_);
  write_sums(robot.shape_arms, longest, shape_accelerations_, weights_);
  for (int i = robot.fixed_capsules(); i < static_cast<int>(capsules.size()); i++) {
    const int frame = robot.bodies[robot.capsules[i].body].frame;
    const auto& [along, turning] = velocities_[frame];
    const PlacedCapsule& capsule = placed.capsules[i];
    const Vec3x16 middle = along + cross(turning, capsule.centre - placed.frames[frame].origin);
    Floats16 square = dot(middle, middle);
    if (!robot.capsules[i].is_ball) {
      // No point of a segment is faster than the faster endpoint.
      const Vec3x16 end = cross(turning, capsule.half), one = middle + end, other = middle - end;
      square = max(dot(one, one), dot(other, other));
    }
    capsules[i] = std::min(capsules[i], largest_root(square) + half * accelerations_[i] + lost);
  }
  for (std::size_t b = robot.fixed_bodies; b < robot.bodies.size(); b++) {
    const Body& body = robot.bodies[b];
    if (body.shape < 0) continue;
    // Its middle moves, and the points around it also turn about it.
    const HullNode<float>& root = robot.shapes.nodes[body.shape];
    const auto& [along, turning] = velocities_[body.frame];
    const PlacedFrame& frame = placed.frames[body.frame];
    const Vec3x16 middle = along + cross(turning, frame.turned(spread3(root.centre)));
    const double here = largest_root(dot(middle, middle)) + root.radius * largest_root(dot(turning, turning));
    shapes[b] = std::min(shapes[b], here + half * shape_accelerations_[b] + lost);
  }
  for (std::size_t k = 0; k < robot.pairs.size(); k++) {
    const auto& [first, second, one, two] = robot.pairs[k];
    pairs[k] = std::min(pairs[k], capsules[first] + capsules[second]);
  }
}

double Speeds::fastest() const {
  double most = 0.0;
  for (const auto* each : {&capsules, &pairs, &shapes}) {
    for (const double speed : *each) most = std::max(most, speed);
  }
  return most;
}

}  // namespace evenroad::robot
