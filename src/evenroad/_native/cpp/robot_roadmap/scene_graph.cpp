// Scenes share the roadmap's graph until a milestone is inserted in one of them, which then has its own.
#include "robot_roadmap/scene_graph.hpp"

#include <algorithm>
#include <cmath>

#include "robot_roadmap/terminal.hpp"

namespace evenroad::robot_roadmap {

namespace {

/// Number of nearest milestones that an inserted one may be joined to; a search evaluates these edges when it needs to.
constexpr std::size_t JOINED = 8;

/// Return by how many turns a joint is out of the range of milestones.
double turns_out(double value, const Joint& joint) {
  return joint.multi_turn ? std::rint((value - joint.middle) / TURN) : 0.0;
}

}  // namespace

SceneGraph::SceneGraph(std::shared_ptr<const Graph> graph, Joints of, std::size_t roadmap_edges)
    : joints(std::move(of)),
      milestones(graph->size(), Verdict::UNKNOWN),
      edges(graph->edge_count(), Verdict::UNKNOWN),
      graph_(std::move(graph)),
      roadmap_edges_(roadmap_edges) {}

SceneGraph SceneGraph::within(std::span<const double> low, std::span<const double> high) const {
  std::vector<Joint> narrower = joints.all();
  for (std::size_t k = 0; k < narrower.size(); k++) {
    narrower[k].low = std::max(narrower[k].low, low[k]);
    narrower[k].high = std::min(narrower[k].high, high[k]);
  }
  // What this scene has inserted stays its own.
  SceneGraph fresh(own_ ? std::make_shared<const Graph>(*own_) : graph_, Joints(std::move(narrower)), roadmap_edges_);
  for (std::size_t k = 0; k < joints.size(); k++) {
    if (joints[k].multi_turn) continue;
    const auto column = graph_->column(k);
    for (std::size_t i = 0; i < size(); i++) {
      if (column[i] < low[k] || column[i] > high[k]) fresh.milestones[i] = Verdict::BLOCKED;
    }
  }
  return fresh;
}

void SceneGraph::insert(Matrix<const double> path) {
  if (path.rows == 0 || is_turned_too_far(path)) return;
  Place before{NONE, 0};
  for (std::size_t row = 0; row < path.rows; row++) {
    const Place here = insert(path[row]);
    if (before.milestone != NONE && before.milestone != here.milestone) {
      join(before.milestone, here.milestone, here.turns - before.turns, Verdict::PROVED);
    }
    before = here;
  }
}

bool SceneGraph::is_turned_too_far(Matrix<const double> path) const {
  for (std::size_t k = 0; k < joints.size(); k++) {
    for (std::size_t row = 0; row < path.rows; row++) {
      const double turns = turns_out(path(row, k), joints[k]);
      if (std::abs(turns) > MOST_TURNS) return true;
      if (row > 0 && std::abs(turns - turns_out(path(row - 1, k), joints[k])) > MOST_STEP) return true;
    }
  }
  return false;
}

Graph& SceneGraph::own_graph() {
  if (!own_) graph_ = own_ = std::make_shared<Graph>(*graph_);
  return *own_;
}

/// Return the milestone at a free configuration, a new one if there is none, and its turns.
///
/// A new one may be joined to its nearest ones by edges that are not evaluated yet.
SceneGraph::Place SceneGraph::insert(std::span<const double> q) {
  std::vector<double> inside(q.begin(), q.end());
  Turns turns = 0;
  for (std::size_t k = 0; k < q.size(); k++) {
    const double out = turns_out(q[k], joints[k]);
    inside[k] = q[k] - TURN * out;
    if (joints[k].multi_turn) turns += pack(out, k);
  }
  Terminal guest(q);
  guest.measure(*this);
  std::vector<std::pair<float, Number>> near;
  for (std::size_t i = 0; i < size(); i++) {
    if (milestones[i] == Verdict::BLOCKED) continue;
    const auto number = static_cast<Number>(i);
    if (guest.away[i] == 0.0F && std::ranges::equal(graph()[number], inside)) {
      milestones[i] = Verdict::FREE;
      return {number, turns};
    }
    near.emplace_back(guest.away[i], number);
  }
  const std::size_t count = std::min(JOINED, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  const Number added = own_graph().add(inside);
  milestones.push_back(Verdict::FREE);
  for (std::size_t rank = 0; rank < count; rank++) {
    const Number other = near[rank].second;
    join(added, other, guest.turns[other] - turns, Verdict::UNKNOWN);
  }
  return {added, turns};
}

/// Join two milestones by a motion that leads past the second by turns.
void SceneGraph::join(Number a, Number b, Turns turns, Verdict verdict) {
  std::vector<double> from(joints.size()), to(joints.size());
  joints.write_turned(graph()[a], 0, from);
  joints.write_turned(graph()[b], turns, to);
  own_graph().join(a, b, turns, static_cast<float>(joints.distance(from, to)));
  edges.push_back(verdict);
}

}  // namespace evenroad::robot_roadmap
