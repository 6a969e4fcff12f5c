// The next steps of a tree: towards the next point of an even sequence, or eight steps around its nodes at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path_bound.hpp"
#include "planning/tree.hpp"

namespace evenroad::planning {

/// Multiples of the golden ratio, without their integers, fill 0 to 1 evenly.
inline constexpr double GOLDEN = 0.6180339887498949;

/// Number of steps around nodes offered at once: the middle and the end of each make a batch of sixteen.
inline constexpr std::size_t STEPS_AT_ONCE = LANES / 2;

/// A motion that would add a node at `target`.
struct Step {
  Node origin;
  std::vector<double> target;
};

/// Even sequences in place of random numbers, used in turn.
struct Sequences {
  /// Points of the unit cube.  After the last point it repeats from the first, each time with a larger shift.
  Matrix<const double> samples;
  /// Points of the unit ball.
  Matrix<const double> steps;
};

/// Offers the next steps of a tree.
class TreeSteps {
 public:
  /// Bounds on paths limit the steps.  Each round uses other points of the sequences.
  TreeSteps(const robot::Joints& joints, const Sequences& sequences, const PathBound* bound, std::size_t round);

  /// Longest step of a tree.
  double longest() const { return longest_; }

  /// Return the next steps of a tree, 0 for that of the start: one extension, or those of at most `most` steps that are
  /// free in the middle and at the end.
  std::span<const Step> next(Tree& tree, std::size_t side, std::size_t most, MotionChecks& checks);

 private:
  void write_sample();
  Node closest(const Tree& tree, std::size_t side) const;
  bool is_allowed(const Tree& tree, std::size_t side, const Step& step);
  std::span<const Step> extension(const Tree& tree, Node closest);
  std::span<const Step> ball_steps(Tree& tree, std::size_t side, Node closest, std::size_t most, MotionChecks& checks);

  const robot::Joints& joints_;
  Sequences sequences_;
  const PathBound* bound_;
  double longest_;
  /// Radius of the ball of steps along each coordinate.
  std::vector<double> radii_;
  std::size_t next_sample_ = 0, next_step_ = 0;
  std::vector<double> sample_, direction_;
  std::array<Step, STEPS_AT_ONCE> offered_;
};

}  // namespace evenroad::planning
