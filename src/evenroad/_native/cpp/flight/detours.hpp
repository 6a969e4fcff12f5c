// Short polylines around bodies: where a straight line is blocked, the search goes on beside the body that blocks it.
#pragma once

#include <cstdint>
#include <vector>

#include "flight/airspace.hpp"

namespace evenroad::flight {

/// A best-first search over positions beside bodies, by the length so far and the straight distance to the goal.
class Detours {
 public:
  /// Keep away from bodies by `margin` beside the radius where the polyline has its corners.
  /// Where bodies move, it is as if all were flown at one pace.
  Detours(const Airspace& airspace, double margin, double pace) : airspace_(airspace), margin_(margin), pace_(pace) {}

  /// Return the corners from one free position to another, both included; none if none were found soon.
  std::vector<Vector> find(const Vector& from, const Vector& to);

 private:
  struct Node {
    Vector at;
    double length;
    std::uint32_t parent;
  };
  struct Open {
    double least;
    std::uint32_t node;
    bool operator<(const Open& other) const { return least != other.least ? least > other.least : node > other.node; }
  };

  void add(std::uint32_t parent, const Vector& at);
  /// Add what can be reached on a straight line to a position; if it is blocked, positions beside what blocks it.
  bool go(std::uint32_t from, const Vector& to, int depth);

  const Airspace& airspace_;
  double margin_, pace_;
  Vector goal_{};
  std::vector<Node> nodes_;
  std::vector<Open> open_;
};

}  // namespace evenroad::flight
