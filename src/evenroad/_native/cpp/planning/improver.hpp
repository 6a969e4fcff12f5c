// Ever shorter paths: rounds of trees that only grow where a path may be shorter, and each better path drawn tight.
//
// After AO-RRT and AORRTC (K. Hauser and Y. Zhou, 2016; T. Wilson, W. Thomason, Z. Kingston and J. Gammell, 2025):
// every round plans anew below a bound on the path's length, and a bound that is drawn says from which nodes trees may
// grow.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/path_bound.hpp"
#include "planning/smoother.hpp"
#include "planning/tree_planner.hpp"

namespace evenroad::planning {

/// What an improver may spend in all: rounds, and motions checked by trees.
struct Effort {
  std::int64_t rounds, motions;
};

/// What a call of `improve` ended with: its slice used up, the effort spent, or a path that is as short as can be.
enum class Progress : std::uint8_t { PAUSED, SPENT, SHORTEST };

/// The path that is to become shorter: its motions are proved, it ends at the goal with this number, and trees found it
/// after a number of motions.
struct First {
  Path path;
  std::int64_t goal, motions;
};

/// Makes one path shorter, as long as it is allowed to; every motion of its paths is proved.
class Improver {
 public:
  /// Ends, sequences, guides and the joints of the checks must last as long as this.  Without smoothing, paths stay as
  /// trees find them.
  Improver(Matrix<const double> terminals, const Sequences& sequences, const Guides& guides, First first,
           bool is_smoothing, MotionChecks& checks);

  /// Go on until the effort is spent, or about that many batches of sixteen were checked in this call.
  ///
  /// However often it pauses, what it finds is the same.
  Progress improve(Effort most, std::int64_t batches);

  const Path& path() const { return best_; }
  /// The path along the trees that became the best one.
  const Path& along_trees() const { return along_trees_; }
  std::int64_t goal() const { return goal_; }
  double length() const { return best_.length(); }
  /// The length that no path falls below.
  double least() const { return bound_.least(); }
  std::int64_t rounds() const { return rounds_; }
  /// How many motions trees checked, and how many smoothing did.
  std::int64_t motions() const { return motions_; }
  std::int64_t smoothing_motions() const { return checks_.counts.motions - motions_; }
  /// Of all trees that are done.
  std::int64_t nodes() const { return nodes_; }

 private:
  /// More motions of a first path are not taken for the trees' work.
  static constexpr std::int64_t MOST_MOTIONS = 1'000'000;

  TreePlanner& begin_round();
  double position_of_round(double step) const;
  Growth grow(TreePlanner& trees, Effort most, std::int64_t pause);
  void take(const std::vector<double>& points, std::int64_t goal);
  void polish_best();

  Matrix<const double> terminals_;
  Sequences sequences_;
  Guides guides_;
  MotionChecks& checks_;
  bool is_smoothing_;
  PathBound bound_;
  Path best_, along_trees_;
  std::int64_t goal_;
  /// Of the round that has begun, and how many motions it may still check.
  std::optional<TreePlanner> trees_;
  std::int64_t left_ = 0;
  std::int64_t round_motions_, rounds_ = 0, best_round_ = 0, motions_ = 0, nodes_ = 0;
  /// How often the best path was polished, and whether that is enough.
  std::size_t polished_ = 0;
  bool is_polished_;
};

}  // namespace evenroad::planning
