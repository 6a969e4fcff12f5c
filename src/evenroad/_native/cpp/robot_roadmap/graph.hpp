// The milestones and edges of a roadmap.
#pragma once

#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot_roadmap/joints.hpp"
#include "robot_roadmap/verdict.hpp"

namespace evenroad::robot_roadmap {

/// An edge as one of its milestones sees it.
struct HalfEdge {
  Number milestone;  // that it leads to
  Number next;       // half edge of the same milestone, or NONE
  Number edge;
  float length;
  Turns turns;  // by which it leads past that milestone
};

class Graph {
 public:
  /// A graph of these milestones, (n, dim), without edges.
  explicit Graph(Matrix<const double> milestones);

  /// Graph of edges, (m, 2), that lead past their second milestones by turns, (m, dim).
  Graph(Matrix<const double> milestones, Matrix<const std::int32_t> edges, Matrix<const std::int8_t> turns,
        const Joints& joints);

  /// A copy of what `milestones`, `first_halves` and `halves` returned.
  Graph(Matrix<const double> milestones, std::vector<Number> first, std::vector<HalfEdge> halves);

  std::size_t size() const { return first_.size(); }
  std::size_t edge_count() const { return halves_.size() / 2; }
  std::size_t dim() const { return columns_.size(); }

  std::span<const double> operator[](Number milestone) const {
    return std::span(milestones_).subspan(static_cast<std::size_t>(milestone) * dim(), dim());
  }

  /// One coordinate of all milestones.
  std::span<const double> column(std::size_t k) const { return columns_[k]; }

  /// The first half edge of a milestone, or NONE.
  Number first_half(Number milestone) const { return first_[milestone]; }
  const HalfEdge& half(Number number) const { return halves_[number]; }

  const std::vector<double>& milestones() const { return milestones_; }
  const std::vector<Number>& first_halves() const { return first_; }
  const std::vector<HalfEdge>& halves() const { return halves_; }

  /// Add a milestone and return its number.
  Number add(std::span<const double> q);

  /// Add an edge that leads past its second milestone by turns.
  void join(Number a, Number b, Turns turns, float length);

 private:
  std::vector<double> milestones_;            // row after row
  std::vector<std::vector<double>> columns_;  // the same by coordinate
  std::vector<Number> first_;
  std::vector<HalfEdge> halves_;
};

}  // namespace evenroad::robot_roadmap
