// A start or goal of a query: how far the milestones are from it, and which of them it may be linked to.
#pragma once

#include <span>
#include <vector>

#include "robot_roadmap/joints.hpp"
#include "robot_roadmap/verdict.hpp"

namespace evenroad::robot_roadmap {

class SceneGraph;

struct Terminal {
  std::vector<double> q;
  std::vector<float> away;              // of each milestone, after the turns that bring it nearest
  std::vector<Turns> turns;             // those
  std::vector<Verdict> links;           // what is known of the motion to each milestone
  std::vector<Number> near;             // milestones that a link is tried to, in order
  double radius = 0.0;                  // how far the farthest of them is
  Verdict straight = Verdict::UNKNOWN;  // what is known of the motion from the start to this goal

  explicit Terminal(std::span<const double> q) : q(q.begin(), q.end()) {}

  /// Write how far each milestone is.
  void measure(const SceneGraph& graph);

  /// Return whether a milestone after its turns equals this; a distance of 0 in single precision may not mean it.
  bool is_at(const SceneGraph& graph, Number milestone) const;
};

/// Choose at most so many milestones that one of the terminals, start first, is tried to be linked to: near ones, or
/// towards the others.  A terminal at a free milestone needs no other.
void choose_links(const SceneGraph& graph, std::span<Terminal> terminals, std::size_t number, std::size_t most);

}  // namespace evenroad::robot_roadmap
