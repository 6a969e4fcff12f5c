// What a search has come to: states, ways to them and to goals, and the queue of ways that it has still to go.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "robot_roadmap/scene_graph.hpp"
#include "robot_roadmap/terminal.hpp"

namespace evenroad::robot_roadmap {

/// A milestone after turns.
struct State {
  Number milestone;
  Number sibling;  // the state of the same milestone that was made before, or NONE
  Turns turns;
  Number reached;  // the way it was reached by, or NONE
  double left;     // how far it is to a goal by the bound; infinite where limits forbid it
  double least;    // the least cost it was offered at
};

/// A way from the start to a state or a goal; its last motion came from where the way before ends.
struct Way {
  Number state;   // that it leads to, or NONE
  Number goal;    // that it leads to, a row of the terminals; 0 where it is a state
  Number before;  // NONE where it has one motion
  Number edge;    // NONE of a link, and of a motion straight to a goal
  double cost;
};

class SearchTree {
 public:
  /// The bound is multiplied by `greed`, 1 for the shortest path.
  SearchTree(const SceneGraph& graph, std::span<const Terminal> terminals, double greed);

  void clear();

  /// Return the state of a milestone after turns, a new one if there was none; NONE where limits forbid it.
  Number state_at(Number milestone, Turns turns);

  State& state(Number number) { return states_[number]; }
  const State& state(Number number) const { return states_[number]; }
  const Way& way(Number number) const { return ways_[number]; }

  /// Put a way into the queue; the bound of what is left decides its place.
  void offer(const Way& way, double left);

  bool is_exhausted() const { return queue_.empty(); }

  /// Take the way of which cost and bound are least out of the queue.
  Number take();

  /// Write where a way leads to; NONE is the start.
  void write_end(Number way, std::span<double> q) const;

 private:
  struct Waiting {
    double key;
    Number way;
  };
  double bound(const State& state);

  const SceneGraph& graph_;
  std::span<const Terminal> terminals_;
  double greed_;
  std::vector<Number> last_state_;  // of each milestone, or NONE
  std::vector<State> states_;
  std::vector<Way> ways_;
  std::vector<Waiting> queue_;  // a heap
  std::vector<double> q_;
};

}  // namespace evenroad::robot_roadmap
