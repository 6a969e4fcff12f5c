// How the nodes of a certificate move along curves, and by how much a direction separates two of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "certificates/nodes.hpp"

namespace evenroad::certificates {

/// A rotation by its rows.
using Turn = std::array<Vector, 3>;

/// The joints that move frames: joint k moves frame k + 1, whose parent comes before it.
struct Frames {
  std::span<const std::int64_t> parent, column;
  std::span<const double> turn, shift, axis, factor, offset;
  std::span<const std::uint8_t> slides;
  std::size_t count() const { return parent.size(); }
};

/// Curves of degree 2, each by its three control points, (curves, 3, joints).
struct Curves {
  std::span<const double> points;
  std::size_t joints = 0;
  std::size_t count() const { return points.size() / (3 * joints); }
  std::span<const double> at(std::size_t curve, std::size_t control) const {
    return points.subspan((3 * curve + control) * joints, joints);
  }
};

/// All values of the joints from `low` to `high`.  A cell is halved along one of `columns` after another.
struct Ranges {
  std::span<const double> low, high;
  std::span<const std::int64_t> columns;
};

/// A pair of nodes during a part of a motion: the part `number` of 2^level; or in this cell of a box.
struct Task {
  std::int64_t motion = 0, number = 0, level = 0, pair = 0;
  const Node *first = nullptr, *second = nullptr;
  double half() const { return 1.0 / static_cast<double>(std::uint64_t{2} << level); }
  double begin() const { return static_cast<double>(motion) + 2.0 * static_cast<double>(number) * half(); }
  double middle() const { return begin() + half(); }
};

/// How something turns and shifts.
struct Screw {
  Vector spin{}, drift{};
};

/// One of the two nodes of a task in the middle of its stretch, and how it moves against the other one.
struct Moving {
  const Node* node = nullptr;
  Turn turn{};
  Vector origin{};
  Screw screw{};
};

/// What is known of a task: its two nodes, half of its length, a bound of their acceleration, and how far they are from
/// where the curve takes them at most.  In a cell of a box the nodes move along each diagonal, of which `others` has
/// all but the first.
struct Moved {
  Moving nodes[2];
  double half = 0.0, stray = 0.0, loose = 0.0;
  std::vector<std::array<Screw, 2>> others;
  std::array<Screw, 2> screws() const { return {nodes[0].screw, nodes[1].screw}; }
  /// How far the nodes are at most from where their velocity takes them.
  double strayed() const { return 0.5 * half * half * stray + loose; }
};

/// How a frame moves against the root: its directions turn by at most the sum of rates, plus that of their changes.
/// `loose` and `twisted` are squares of how far what it carries, and its directions, are from where the curve takes
/// them.
struct Carried {
  Moving moving;
  double half = 0.0, stray = 0.0, loose = 0.0, turning = 0.0, bending = 0.0, twisted = 0.0;
};

/// Return a place of a node's frame in the root's frame.
Vector placed(const Moving& moving, const Vector& own);

/// Return the middle of a node's box in the root's frame.
Vector middle_of(const Moving& moving);

/// Return a functional of the root's frame as one of the node's own frame.
Vector as_seen(const Moving& moving, const Vector& functional);

class Motions {
 public:
  /// Configurations are as far as `tolerance` from the curves.
  Motions(const Frames& frames, const Curves& curves, double tolerance);

  /// Joints are anywhere in a box.
  Motions(const Frames& frames, const Ranges& box);

  bool in_box() const { return !box_.low.empty(); }

  /// How often a motion, or a box, is halved at most.
  std::int64_t deepest() const;

  Moved moved(const Task& task);

  /// Return the same of a frame and what is as far as `reach` from its origin, against the root.
  Carried carried(const Task& task, std::int64_t frame, double reach);

 private:
  struct State {
    std::vector<Turn> turn;
    std::vector<Vector> origin, turning, along;
    std::vector<double> rate, bend;
  };

  void add_frame(double most);
  const State& state(const Task& task);
  void find_cell(const Task& task);
  Carried carried(const State& at, double half, std::int64_t frame, std::size_t shared, double reach);
  void add_diagonals(const State& at, const Task& task, std::size_t shared, Moved& moved) const;

  Frames frames_;
  Curves curves_;
  Ranges box_;
  double off_ = 0.0;  // square of the tolerance, times the largest number of joints that one column moves
  std::vector<double> low_, middle_, high_;       // of the cell of a box
  std::vector<std::vector<std::size_t>> chains_;  // joints above each frame, from the root
  std::vector<double> slide_, shift_;             // how far each joint slides at most, and is from the one before
  std::vector<double> levers_;                    // memory of one call
  std::unordered_map<std::uint64_t, State> states_;
};

enum class By { BOXES, CORNERS };

/// Return by how much a unit direction separates the nodes of a task all the time, beyond what they stray.
double gap(const Moved& moved, const Vector& direction, By by);

}  // namespace evenroad::certificates
