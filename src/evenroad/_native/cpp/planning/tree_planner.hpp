// RRT-Connect for arms: two trees grow from the start and from the goals until they meet.
//
// The algorithm is that of J. Kuffner and S. LaValle, 2000, with an even sequence in place of random samples.  Nodes
// that were extended often enough also get steps around them: one batch of sixteen has the middle and the end of eight
// steps, and only steps free at both are checked in full.
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

/// The outcome of a call of `grow`: its slice used up, the budget of motions spent, start or goals not free, or a path
/// found.
enum class Growth : std::uint8_t { PAUSED, SPENT, NOT_FREE, SOLVED };

/// Two trees, which of them grows next, and where they met.
class TreePlanner {
 public:
  /// `terminals` are the start and the goals; straight motions to the first goals are tried at once.  Terminals,
  /// sequences and the joints of the checks must outlive this.  A bound limits the length of the path.  Each round uses
  /// other points of the sequences.
  TreePlanner(Matrix<const double> terminals, const Sequences& sequences, MotionChecks& checks,
              const PathBound* bound = nullptr, std::size_t round = 0);

  /// Plant the trees, and add the waypoints of a path of proved motions to this goal.  The tree of the start gets those
  /// up to the first position along the path, the tree of the goals those from the second on.  Call it before `grow`.
  void begin_along(const Path& path, std::int64_t goal, double first, double second);

  /// Grow until the trees meet, this many motions are spent, or about this many batches of sixteen were checked in this
  /// call; the next call continues.
  Growth grow(std::int64_t most_motions, std::int64_t batches);

  /// The configurations from the start to the goal that was reached, in sequence; none without a path.
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
  /// The trees of the start and of the goals.
  std::array<Tree, 2> trees_;
  /// The goal of each root of the second tree.
  std::vector<std::int64_t> goals_;
  bool is_begun_ = false;
  std::size_t growing_ = 0;
  /// Number of goals to which a straight motion was tried.
  Node straight_ = 0;
  /// The nodes at which the trees met last, one of each, or none.
  std::array<Node, 2> met_{NO_NODE, NO_NODE};
  std::int64_t most_motions_ = 0;
  /// Number of times in a row that the tree offered no step.
  std::int64_t idle_ = 0;
  std::vector<double> here_, there_, direction_, target_;
  std::vector<double> path_;
  std::int64_t goal_ = -1;
};

}  // namespace evenroad::planning
