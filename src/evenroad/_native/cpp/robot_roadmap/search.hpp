// The search of a roadmap, which stops where a motion has to be evaluated.
//
// A lazy A* (Cohen, Phillips and Likhachev 2015): an edge is evaluated when the search would go along it, a milestone
// before the first edge to it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot_roadmap/search_tree.hpp"

namespace evenroad::robot_roadmap {

/// What is asked: from a start, the first row, to one of the goals.
struct Question {
  Matrix<const double> start_and_goals;
  std::size_t links;  // that are tried of each of them, at most
  double greed;       // factor of the bound, 1 for the shortest path
};

/// Something to be evaluated.
struct Check {
  enum class Kind : std::uint8_t { MILESTONE, EDGE, LINK, STRAIGHT };
  Kind kind;
  Number terminal;   // of a link, and the goal of a motion straight to it
  Number milestone;  // itself, or of a link
  Number edge;
};

enum class Progress : std::uint8_t { CHECK, FOUND, NO_PATH };

class Search {
 public:
  /// The graph must last as long as this, and get no milestones meanwhile.
  Search(SceneGraph& graph, const Question& question);
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  /// Go on until something has to be evaluated, there is a path, or there is none.
  Progress advance();

  /// What has to be evaluated: a milestone, `from()`, or a motion; of a link the start or goal comes first.
  const Check& check() const { return check_; }
  std::span<const double> from() const { return from_; }
  std::span<const double> to() const { return to_; }

  /// Take the result of `check()`.
  void record(Verdict verdict);

  /// Make the last motion of the path that is not proved yet the one to be evaluated; return whether there is one.
  bool find_unproved();

  /// Search anew, with all that is known by now.
  void begin_again();

  /// Return the waypoints of the path that was found, one after the other.
  std::vector<double> path() const;

  /// The goal that it leads to.
  Number goal() const { return tree_.way(pending_).goal - 1; }

  /// Whether there is a path, all that is known taken together; and whether something has to be evaluated.
  bool has_found() const { return progress_ == Progress::FOUND; }
  bool is_asking() const { return progress_ == Progress::CHECK; }

  const SceneGraph& graph() const { return graph_; }
  std::size_t size() const { return size_; }  // of the graph, when the search was made
  std::vector<Terminal>& terminals() { return terminals_; }

  /// Evaluations so far.
  std::int64_t configurations = 0, motions = 0;

 private:
  enum class Phase : std::uint8_t { BEGIN, STRAIGHT, GOALS, OPEN, SEARCH };

  Progress next();
  void begin();
  bool ask_straight();
  Progress ask_goal_link();
  void open();
  Progress search();
  void expand(Number number);
  Progress ask_milestone(Number state);
  Progress ask_motion(Number way);
  Check check_of(const Way& way) const;
  Verdict& verdict_of(const Check& check);

  SceneGraph& graph_;
  std::size_t size_;
  std::vector<Terminal> terminals_;
  std::size_t links_;
  bool are_near_first_;
  SearchTree tree_;
  Phase phase_ = Phase::BEGIN;
  Progress progress_ = Progress::NO_PATH;
  Number pending_ = NONE;  // the way at hand
  Check check_{};
  std::vector<double> from_, to_;
};

}  // namespace evenroad::robot_roadmap
