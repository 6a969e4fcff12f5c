// A roadmap in one scene: what is known of its milestones and edges, and those that were inserted there.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "robot_roadmap/graph.hpp"

namespace evenroad::robot_roadmap {

class SceneGraph {
 public:
  Joints joints;
  std::vector<Verdict> milestones, edges;

  /// Nothing is known; `roadmap_edges` of the edges are free of the robot itself and of the static scene.
  SceneGraph(std::shared_ptr<const Graph> graph, Joints joints, std::size_t roadmap_edges);

  const Graph& graph() const { return *graph_; }
  std::size_t size() const { return graph_->size(); }

  /// Return whether an edge is the roadmap's, and so free of the robot itself and of the static scene.
  bool is_of_roadmap(Number edge) const { return static_cast<std::size_t>(edge) < roadmap_edges_; }
  std::size_t roadmap_edges() const { return roadmap_edges_; }

  /// Return the same roadmap in another scene, where nothing is known but which milestones narrower ranges forbid.
  SceneGraph within(std::span<const double> low, std::span<const double> high) const;

  /// Insert the waypoints of a path, (p, dim), as milestones; its motions are proved free in the scene.
  ///
  /// Nothing is inserted where joints turn so far that packed turns would overflow.
  void insert(Matrix<const double> path);

 private:
  struct Place {
    Number milestone;
    Turns turns;
  };
  bool is_turned_too_far(Matrix<const double> path) const;
  Graph& own_graph();
  Place insert(std::span<const double> q);
  void join(Number a, Number b, Turns turns, Verdict verdict);

  std::shared_ptr<const Graph> graph_;
  /// The same where it is this scene's own.
  std::shared_ptr<Graph> own_;
  std::size_t roadmap_edges_;
};

}  // namespace evenroad::robot_roadmap
