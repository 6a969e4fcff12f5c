// Half edges of the roadmap lie one after the other for each milestone; later ones are put before them.
#include "robot_roadmap/graph.hpp"

#include <tuple>

namespace evenroad::robot_roadmap {

Graph::Graph(Matrix<const double> milestones)
    : milestones_(milestones.data, milestones.data + milestones.rows * milestones.columns),
      columns_(milestones.columns),
      first_(milestones.rows, NONE) {
  for (std::size_t k = 0; k < dim(); k++) {
    for (std::size_t row = 0; row < milestones.rows; row++) columns_[k].push_back(milestones(row, k));
  }
}

Graph::Graph(Matrix<const double> milestones, Matrix<const std::int32_t> edges, Matrix<const std::int8_t> turns,
             const Joints& joints)
    : Graph(milestones) {
  halves_.resize(2 * edges.rows);
  // Where the next half edge of each milestone goes.
  std::vector<Number> end(size() + 1);
  for (std::size_t row = 0; row < edges.rows; row++) end[edges(row, 0) + 1]++, end[edges(row, 1) + 1]++;
  for (std::size_t i = 0; i < size(); i++) {
    if (end[i + 1] > 0) first_[i] = end[i];
    end[i + 1] += end[i];
  }
  const auto put = [&](std::size_t edge, int side, float length, Turns packed) {
    const Number here = edges(edge, side), there = edges(edge, 1 - side);
    const Number half = end[here]++;
    halves_[half] = {there, NONE, static_cast<Number>(edge), length, side == 0 ? packed : -packed};
    if (half != first_[here]) halves_[half - 1].next = half;
  };
  for (int side = 0; side < 2; side++) {
    for (std::size_t row = 0; row < edges.rows; row++) {
      const auto a = (*this)[edges(row, 0)], b = (*this)[edges(row, 1)];
      double squared = 0.0;
      Turns packed = 0;
      for (std::size_t k = 0; k < dim(); k++) {
        const double apart = b[k] + TURN * turns(row, k) - a[k];
        squared += apart * apart;
        if (joints[k].multi_turn) packed += pack(turns(row, k), k);
      }
      put(row, side, static_cast<float>(std::sqrt(squared)), packed);
    }
  }
}

Graph::Graph(Matrix<const double> milestones, std::vector<Number> first, std::vector<HalfEdge> halves)
    : Graph(milestones) {
  first_ = std::move(first);
  halves_ = std::move(halves);
}

Number Graph::add(std::span<const double> q) {
  milestones_.insert(milestones_.end(), q.begin(), q.end());
  for (std::size_t k = 0; k < dim(); k++) columns_[k].push_back(q[k]);
  first_.push_back(NONE);
  return static_cast<Number>(size()) - 1;
}

void Graph::join(Number a, Number b, Turns turns, float length) {
  const auto edge = static_cast<Number>(edge_count());
  for (const auto& [here, there, past] : {std::tuple(a, b, turns), std::tuple(b, a, -turns)}) {
    halves_.push_back({there, first_[here], edge, length, past});
    first_[here] = static_cast<Number>(halves_.size()) - 1;
  }
}

}  // namespace evenroad::robot_roadmap
