// Nodes of a certificate: sets of shapes of one frame, which are halved as docs/certificates.md says.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "robot/simplex.hpp"

namespace evenroad::certificates {

using robot::Vector;

/// Convex elements of one kind: each is the hull of some corners with a ball, or a disc, around them.
struct Elements {
  std::vector<double> points;         // xyz of the corners that differ
  std::vector<std::int64_t> corners;  // numbers of points, the same count for each element
  std::size_t count = 0;
  double radius = 0.0, disc = 0.0;
  Vector axis{};
  bool is_box = false;
};

/// Some elements of a shape.
struct Part {
  std::shared_ptr<const Elements> shape;
  std::vector<std::int64_t> rows;
};

/// Points in an order by place: some eights of points are a group, eight groups a larger one, and so on.
class Corners {
 public:
  explicit Corners(std::vector<Vector>&& points);

  /// Return the point that is farthest along a functional.
  Vector farthest(const Vector& along) const;

 private:
  struct Found {
    double most;
    Vector at;
  };

  void look(std::size_t group, const Vector& along, Found& found) const;
  void visit(std::size_t level, std::size_t number, const Vector& along, Found& found) const;

  std::vector<double> points_;              // eight x, eight y, eight z, and so on; the last point is repeated
  std::vector<std::vector<double>> boxes_;  // of each level: eight middles and half extents, xyz, of what is below
  std::vector<std::size_t> counts_;         // of these boxes
};

/// Corners around each of which are the same ball and the same disc.
struct Rounded {
  double radius = 0.0, disc = 0.0;
  Vector axis{};
  Corners corners;
};

/// Elements of one frame, and the box around them.
class Node {
 public:
  Node(std::int64_t frame, std::vector<Part>&& parts);

  /// A node of whole shapes.
  Node(std::int64_t frame, const std::vector<std::shared_ptr<const Elements>>& shapes);

  std::int64_t frame = 0;
  double reach = 0.0;  // largest distance from the frame's origin
  Vector centre{}, box[3]{};
  std::size_t elements = 0, corners = 0;

  /// Return a half, 0 or 1, of a node of several elements.  Both are made once, by the first thread that needs one.
  const Node& half(int side) const;

  /// Return the place of the node that is farthest along a functional of its frame.
  Vector farthest(const Vector& along) const;

  /// Return how far the box around the node reaches along a functional of its frame.
  double box_reach(const Vector& along) const;

 private:
  void halve() const;

  std::vector<Part> parts_;
  std::vector<Rounded> rounded_;
  mutable std::once_flag halved_;
  mutable std::unique_ptr<const Node> halves_[2];
};

}  // namespace evenroad::certificates
