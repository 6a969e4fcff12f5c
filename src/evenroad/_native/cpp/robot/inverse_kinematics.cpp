#include "robot/inverse_kinematics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/time_limit.hpp"
#include "robot/damped_solve.hpp"

namespace evenroad::robot {

namespace {

constexpr double EXACT = 1e-10;  // a smaller error counts as 0 [m, rad]
constexpr double LONGEST = 0.8;  // largest movement of a joint in a step [rad or m]
constexpr int LOOK = 8;          // steps after which the error must have halved
constexpr double DAMPING = 0.03;
constexpr int SOLVED_A_LOOK = 4;  // configurations between two looks at the clock
constexpr double INF = std::numeric_limits<double>::infinity();

/// By how much a tip has to move and to turn, or does so with a coordinate: in the root's frame.
using Twist = std::array<double, 6>;

/// Return the turn, axis times angle, that takes an axis of the tip to where it is to point.
Vector turn_of_axis(const Pose& tip, const PoseTask& task) {
  const auto& r = tip.rotation;
  const Vector a = {dot({r[0], r[1], r[2]}, task.axis), dot({r[3], r[4], r[5]}, task.axis),
                    dot({r[6], r[7], r[8]}, task.axis)};
  Vector across = cross(a, task.direction);
  double sine = norm(across);
  const double cosine = dot(a, task.direction);
  if (sine < 1e-12 && cosine < 0.0) {
    // Opposite: any axis across will do.
    across = std::abs(a[0]) < 0.9 ? Vector{0.0, a[2], -a[1]} : Vector{-a[2], 0.0, a[0]};
    sine = 1e-12;
    const double length = norm(across);
    for (double& each : across) each = each * sine / length;
  }
  return across * (sine > 1e-12 ? std::atan2(sine, cosine) / sine : 1.0);
}

/// Return the turn, axis times angle, that takes the tip's rotation to the wanted one.
Vector turn_of_all(const Pose& tip, const PoseTask& task) {
  // From the goal times the tip's inverse: twice the axis times the sine, and one plus twice the cosine.
  const auto &goal = task.pose.rotation, &own = tip.rotation;
  Vector twice{};
  double trace = 0.0;
  for (int k = 0; k < 3; k++) {
    twice[0] += goal[6 + k] * own[3 + k] - goal[3 + k] * own[6 + k];
    twice[1] += goal[k] * own[6 + k] - goal[6 + k] * own[k];
    twice[2] += goal[3 + k] * own[k] - goal[k] * own[3 + k];
    trace += goal[k] * own[k] + goal[3 + k] * own[3 + k] + goal[6 + k] * own[6 + k];
  }
  const double sine = 0.5 * norm(twice), angle = std::atan2(sine, 0.5 * (trace - 1.0));
  if (sine > 1e-9) return twice * (0.5 * angle / sine);
  // Half a turn has no axis here: one is as good as another, and the next step will see it.
  if (angle > 1.0) twice[0] += 2.0 * angle;
  return twice * 0.5;
}

Twist error_of(const Pose& tip, const PoseTask& task) {
  Twist error{};
  if (task.placed) {
    for (int axis = 0; axis < 3; axis++) error[axis] = task.pose.origin[axis] - tip.origin[axis];
  }
  if (task.turn != Turn::NOT) {
    const Vector turn = task.turn == Turn::ALL ? turn_of_all(tip, task) : turn_of_axis(tip, task);
    std::copy(turn.begin(), turn.end(), error.begin() + 3);
  }
  return error;
}

/// Reduce an error by its tolerance, slightly less than allowed; return the square of the rest, 0 if covered.
double uncovered(Twist& error, const PoseTask& task) {
  const double tolerances[] = {task.position_tolerance, task.angle_tolerance};
  double total = 0.0;
  for (int part = 0; part < 2; part++) {
    const double allowed = tolerances[part];
    const std::span<double, 3> of(&error[3 * part], 3);
    const double squared = of[0] * of[0] + of[1] * of[1] + of[2] * of[2], size = std::sqrt(squared);
    const double scale = size <= std::max(allowed, EXACT) ? 0.0 : 1.0 - 0.5 * allowed / size;
    total += squared * scale * scale;
    for (double& each : of) each *= scale;
  }
  return total;
}

/// A chain within limits, with memory for the steps of a configuration.
class Solver {
 public:
  Solver(const Chain& chain, const Limits& limits)
      : chain_(chain),
        limits_(limits),
        axes_(chain.joints.size()),
        jacobian_(chain.dim),
        used_(chain.dim),
        step_(chain.dim) {}

  /// Move a configuration until its tip reaches the wanted pose; return the squared error.
  double solve(std::span<double> q, const PoseTask& task, int steps) {
    double before = INF;
    for (int count = 0;; count++) {
      const Pose tip = chain_.tip_pose(q, axes_);
      Twist error = error_of(tip, task);
      const double missing = uncovered(error, task);
      if (missing == 0.0 || count == steps) return missing;
      if (count % LOOK == 0) {
        // An error that is infinite or no number ends, too.
        if (!(missing < 0.25 * before)) return missing;
        before = missing;
      }
      write_jacobian(tip, task);
      write_step(q, error, DAMPING * missing + 1e-16);
      double largest = LONGEST;
      for (const double each : step_) largest = std::max(largest, std::abs(each));
      for (std::size_t k = 0; k < q.size(); k++) {
        q[k] = std::min(std::max(q[k] + step_[k] * (LONGEST / largest), limits_.low[k]), limits_.high[k]);
      }
    }
  }

 private:
  /// Write the Jacobian of the tip, for the constrained parts of the task.
  void write_jacobian(const Pose& tip, const PoseTask& task) {
    std::fill(jacobian_.begin(), jacobian_.end(), Twist{});
    for (std::size_t i = 0; i < axes_.size(); i++) {
      const ChainJoint& joint = chain_.joints[i];
      const Vector axis = axes_[i].direction * joint.multiplier;
      Twist& column = jacobian_[joint.coordinate];
      if (task.placed) {
        const Vector moves = joint.slides ? axis : cross(axis, tip.origin - axes_[i].origin);
        for (int k = 0; k < 3; k++) column[k] += moves[k];
      }
      if (joint.slides || task.turn == Turn::NOT) continue;
      // If only one axis has a direction, a turn about it changes nothing.
      const double along = task.turn == Turn::BY_AXIS ? dot(axis, task.direction) : 0.0;
      for (int k = 0; k < 3; k++) column[3 + k] += axis[k] - along * task.direction[k];
    }
  }

  /// Write the step of all coordinates that do not leave their limits by it.
  void write_step(std::span<const double> q, const Twist& error, double damping) {
    std::fill(used_.begin(), used_.end(), 1.0);
    for (std::size_t tried = 0; tried < q.size(); tried++) {
      write_least_squares(error, damping);
      bool stuck = false;
      for (std::size_t k = 0; k < q.size(); k++) {
        if ((q[k] >= limits_.high[k] && step_[k] > 0.0) || (q[k] <= limits_.low[k] && step_[k] < 0.0)) {
          used_[k] = 0.0;
          stuck = true;
        }
      }
      if (!stuck) return;
    }
  }

  /// Write the step of the coordinates that are used.
  void write_least_squares(const Twist& error, double damping) {
    double square[36];
    for (std::size_t i = 0; i < 6; i++) {
      for (std::size_t j = 0; j <= i; j++) {
        double total = i == j ? damping : 0.0;
        for (std::size_t k = 0; k < step_.size(); k++) total += used_[k] * jacobian_[k][i] * jacobian_[k][j];
        square[6 * i + j] = total;
      }
    }
    Twist solved = error;
    solve_damped({square, 6, 6}, solved, damping);
    for (std::size_t k = 0; k < step_.size(); k++) {
      double total = 0.0;
      for (int i = 0; i < 6; i++) total += jacobian_[k][i] * solved[i];
      step_[k] = used_[k] * total;
    }
  }

  const Chain& chain_;
  const Limits& limits_;
  std::vector<Axis> axes_;
  std::vector<Twist> jacobian_;      // a column for each coordinate
  std::vector<double> used_, step_;  // 1 or 0 for each coordinate, and by how much it moves
};

}  // namespace

std::vector<double> reach(const Chain& chain, const PoseTask& task, const Limits& limits, int steps, std::size_t enough,
                          Matrix<double> q) {
  Solver solver(chain, limits);
  ClockWatch clock(SOLVED_A_LOOK);
  std::vector<double> missing(q.rows, INF);
  for (std::size_t i = 0, found = 0; i < q.rows && found < enough; i++) {
    clock.look();
    missing[i] = solver.solve(q[i], task, steps);
    found += missing[i] == 0.0;
  }
  return missing;
}

std::vector<double> follow(const Chain& chain, PoseTask task, std::span<const double> from,
                           std::span<const double> towards, Matrix<const double> poses, const Limits& limits, int steps,
                           double longest) {
  Solver solver(chain, limits);
  ClockWatch clock(SOLVED_A_LOOK);
  std::vector<double> path, before(from.begin(), from.end()), q = before;
  for (std::size_t i = 0; i < poses.rows; i++) {
    clock.look();
    std::copy_n(poses[i].begin(), 9, task.pose.rotation.begin());
    std::copy_n(poses[i].begin() + 9, 3, task.pose.origin.begin());
    for (std::size_t k = 0; i > 0 && k < towards.size(); k++) {
      q[k] += (towards[k] - q[k]) / static_cast<double>(poses.rows - i);
    }
    if (solver.solve(q, task, steps) > 0.0) break;
    for (std::size_t k = 0; k < q.size(); k++) {
      if (i > 0 && std::abs(q[k] - before[k]) > longest) return path;
    }
    path.insert(path.end(), q.begin(), q.end());
    before = q;
  }
  return path;
}

}  // namespace evenroad::robot
