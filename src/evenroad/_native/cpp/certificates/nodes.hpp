// Nodes of a certificate: sets of shapes of one frame, which are halved as docs/certificates.md says.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "robot/simplex.hpp"

namespace evenroad::certificates {

using robot::Vector;

/// Convex elements of one kind: each is the hull of some corners with a ball, or a disc, around them.
struct Elements {
  std::span<const double> points;         // xyz of the corners that differ
  std::span<const std::int64_t> corners;  // numbers of points, the same count for each element
  std::size_t count = 0;
  double radius = 0.0, disc = 0.0;
  Vector axis{};
  bool is_box = false;
};

/// Some elements of a shape.
struct Part {
  std::size_t shape = 0;
  std::vector<std::int64_t> rows;
  std::vector<std::int64_t> points;  // that the elements have for corners
};

struct Node {
  std::int64_t frame = 0;
  double reach = 0.0;  // largest distance from the frame's origin
  Vector centre{}, box[3]{};
  std::vector<Part> parts;
  std::size_t elements = 0, corners = 0;
  std::int64_t halves[2] = {-1, -1};
};

/// A growing table of nodes.
class Nodes {
 public:
  explicit Nodes(std::vector<Elements> shapes) : shapes_(std::move(shapes)) {}

  /// Add a node of whole shapes.
  void add_whole(std::int64_t frame, std::span<const std::int64_t> shapes);

  const Node& operator[](std::int64_t node) const { return nodes_[static_cast<std::size_t>(node)]; }
  std::size_t size() const { return nodes_.size(); }

  /// Return a half, 0 or 1, of a node of several elements.
  std::int64_t half(std::int64_t node, int side);

  /// Return the place of a node that is farthest along a functional of its frame.
  Vector farthest(std::int64_t node, const Vector& along) const;

  /// Return how far the box around a node reaches along a functional of its frame.
  double box_reach(std::int64_t node, const Vector& along) const;

 private:
  std::int64_t add(std::int64_t frame, std::vector<Part>&& parts);
  Vector middle(std::size_t shape, std::int64_t row) const;

  std::vector<Elements> shapes_;
  std::vector<Node> nodes_;
};

}  // namespace evenroad::certificates
