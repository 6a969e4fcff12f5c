// A tree of configurations: its nodes, their costs from the root, and searches for the nearest node and for the node
// that was tried least often.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robot/joints.hpp"

namespace evenroad::planning {

using Node = std::int64_t;

/// The number of a missing node, such as the parent of a root.
inline constexpr Node NO_NODE = -1;

/// Nodes are numbered as they were added, so parents come before their children.
class Tree {
 public:
  explicit Tree(const robot::Joints& joints);

  Node size() const { return static_cast<Node>(parents_.size()); }
  bool empty() const { return parents_.empty(); }
  ConstConfiguration operator[](Node node) const { return {&nodes_[static_cast<std::size_t>(node) * dim_], dim_}; }
  Node parent(Node node) const { return parents_[static_cast<std::size_t>(node)]; }
  bool is_root(Node node) const { return parent(node) == NO_NODE; }
  std::span<const double> nodes() const { return nodes_; }

  /// Number of times that the tree grew from a node.
  std::int64_t& tried(Node node) { return tried_[static_cast<std::size_t>(node)]; }

  /// Whether the motion from a node's parent is proved.
  bool is_proved(Node node) const { return proved_[static_cast<std::size_t>(node)] != 0; }
  void set_proved(Node node) { proved_[static_cast<std::size_t>(node)] = 1; }

  /// Length of the path from the root to a node.
  double cost(Node node) const { return costs_[static_cast<std::size_t>(node)]; }

  /// Add a configuration of another array at a distance from its parent; return its number.
  Node add(ConstConfiguration q, Node parent, double distance);

  /// Return the node nearest to a configuration, the first of equals; distances are of single precision.
  Node nearest(ConstConfiguration q) const;

  /// Return the nearest node through which the path from the root to a configuration is at most this long, or NO_NODE.
  Node nearest_within(ConstConfiguration q, double longest) const;

  /// Return the node that was tried least often, the first of equals.
  Node least_tried() const;

  /// Remove a node and all that descend from it; the others move up and keep their order.
  void remove_branch(Node node);

 private:
  template <class Admitted>
  Node nearest_of(ConstConfiguration q, Admitted admitted) const;
  void write_columns(Node node);
  void enlarge();

  std::size_t dim_, capacity_ = 0;
  std::vector<double> nodes_, costs_;
  /// The nodes by coordinate, `capacity_` numbers each; unused entries are far away.
  std::vector<float> columns_;
  /// The costs of the nodes, in single precision, `capacity_` numbers.
  std::vector<float> cost_column_;
  std::vector<float> periods_;
  std::vector<Node> parents_;
  std::vector<std::int64_t> tried_;
  std::vector<std::uint8_t> proved_;
};

}  // namespace evenroad::planning
