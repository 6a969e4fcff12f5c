// RRT-Connect for arms: two trees grow from the start and from the goals until they meet.
//
// After J. Kuffner and S. LaValle, 2000, with an even sequence in place of random samples, and with steps around nodes
// that were extended often enough: one batch of sixteen holds the middle and the end of eight of them, and only those
// free at both are looked at in full.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/path_bound.hpp"
#include "planning/tree.hpp"
#include "planning/tree_steps.hpp"

namespace evenroad::planning {

/// What a call of `grow` ended with: its slice used up, the budget of motions spent, start or goals not free, or a path
/// found.
enum class Growth : std::uint8_t { PAUSED, SPENT, NOT_FREE, SOLVED };

/// Two trees, which of them grows next, and where they met.
class TreePlanner {
 public:
  /// `terminals` are the start and the goals, of which the first are tried straight on.  Ends, sequences and the joints
  /// of the checks must last as long as this.  With a bound, the path is shorter than that allows; each round is driven
  /// by other points of the sequences.
  TreePlanner(Matrix<const double> terminals, const Sequences& sequences, MotionChecks& checks,
              const PathBound* bound = nullptr, std::size_t round = 0);

  /// Plant the trees, and add the waypoints of a path of proved motions to this goal: to that of the start those up to
  /// the first place along the path, to that of the goals those from the second on.  Call it before `grow`.
  void begin_along(const Path& path, std::int64_t goal, double first, double second);

  /// Grow until the trees meet, that many motions are spent, or about that many batches of sixteen were checked in this
  /// call; the next call goes on.
  Growth grow(std::int64_t most_motions, std::int64_t batches);

  /// The configurations from the start to the goal that was reached, one after the other; none without a path.
  const std::vector<double>& path() const { return path_; }

  /// Which of the goals was reached, -1 without a path.
  std::int64_t goal() const { return goal_; }

  const Tree& tree(std::size_t number) const { return trees_[number]; }

 private:
  void plant();
  bool is_planted() const { return !trees_[0].empty() && !trees_[1].empty(); }
  std::size_t growing_tree();
  bool grow_once();
  Node other_end(std::size_t tree, Node found) const;
  bool join_straight(Node goal);
  bool join(std::size_t tree, Node found, Node other);
  Node reach(std::size_t tree, Node found, Node other);
  bool have_met() const { return met_[0] != NO_NODE; }
  bool is_path_proved();
  bool is_branch_proved(std::size_t tree, Node leaf);
  void write_path();
  bool is_spent() const { return checks_.counts.motions >= most_motions_; }

  Matrix<const double> terminals_;
  MotionChecks& checks_;
  const PathBound* bound_;
  TreeSteps steps_;
  /// From the start, and from the goals.
  std::array<Tree, 2> trees_;
  /// Which of the goals the roots of the second tree are.
  std::vector<std::int64_t> goals_;
  bool is_begun_ = false;
  std::size_t growing_ = 0;
  /// How many goals were tried straight on.
  Node straight_ = 0;
  /// Where the trees met last: a node of each, or none.
  std::array<Node, 2> met_{NO_NODE, NO_NODE};
  std::int64_t most_motions_ = 0;
  /// How often in a row the tree had no step to offer.
  std::int64_t idle_ = 0;
  std::vector<double> here_, there_, direction_, target_;
  std::vector<double> path_;
  std::int64_t goal_ = -1;
};

}  // namespace evenroad::planning
