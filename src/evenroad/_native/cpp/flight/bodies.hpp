// What a ball must not touch: boxes, cylinders, spheres, capsules, triangles and the points of clouds, in a tree.
//
// A parabola is free of a convex body if a plane that touches the body keeps it off: the plane at the point of the body
// that is nearest to the middle of the curve.  How far a parabola keeps from a plane is a quadratic, whose least value
// is known.  Where the plane does not do, the curve is halved.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "flight/motion.hpp"
#include "robot/exact_obstacle.hpp"

namespace evenroad::flight {

/// A triangle of a mesh, larger by a rounding.
struct Triangle {
  Vector corners[3];
  double rounding;
};

/// A point of a cloud.
struct Ball {
  Vector centre;
  double radius;
};

/// A solid, which may move: as given at time 0.
struct Solid {
  robot::Exact shape;
  Vector velocity;
};

/// The shortest interval of a curve that is halved further [m]: a curve this near to contact is not called free.
constexpr double TOLERANCE = 1e-3;

class Bodies {
 public:
  /// The solids of some numbers may move: they are tested one by one, and not through the tree.
  Bodies(std::vector<Solid> solids, std::vector<Triangle> triangles, std::vector<Ball> balls,
         std::vector<std::uint32_t> movers);

  /// Let a solid that may move be at a position at time 0, with a velocity.
  void move(std::uint32_t mover, const Vector& centre, const Vector& velocity) {
    std::copy(centre.begin(), centre.end(), solids_[mover].shape.centre);
    solids_[mover].velocity = velocity;
  }

  /// Say whether a ball is free at a time.
  bool is_free(const Vector& at, double time, double radius) const;
  /// Say whether a ball is proved free along a parabola that begins at a time.
  bool is_free(const Parabola& curve, double time, double radius) const;
  /// Return the share of a straight flight, which begins at a time, that is nearest to the first body that a ball
  /// touches; none if none is touched.
  std::optional<double> first_contact(const Parabola& line, double time, double radius) const;
  /// Return how far it is in a direction to where all bodies are at a distance at a time; none if it is beyond `most`.
  std::optional<double> exit_along(const Vector& from, const Vector& direction, double time, double distance,
                                   double most) const;
  /// Return the distance of a point from the nearest body at a time, at most `most`, and the number of the body.
  struct Nearest {
    double distance;
    std::int64_t body;
  };
  Nearest nearest(const Vector& at, double time, double most) const;
  std::span<const std::uint32_t> movers() const { return movers_; }
  /// Return the bodies that do not move.
  std::span<const std::uint32_t> statics() const { return still_->order; }
  /// Say whether a point is this near to a body that does not move.
  bool is_near(std::uint32_t body, const Vector& at, double distance) const {
    const Near near = near_to(body, at);
    return squared_length(at - near.point) <= (distance + near.rounding) * (distance + near.rounding);
  }
  /// Return the largest coordinate of a body.
  double farthest() const;
  /// Write the corners of a box around a body.
  void write_box(std::uint32_t body, Vector& low, Vector& high) const;
  std::size_t count() const { return solids_.size() + still_->triangles.size() + still_->balls.size(); }

 private:
  /// A box around bodies; the first of two children follows at once.
  struct Node {
    Vector low, high;
    std::uint32_t first, count, second;
  };
  /// Where the core of a body is nearest to a point, and by how much the body is larger than its core.
  struct Near {
    Vector point;
    double rounding;
  };

  Near near_to(std::uint32_t body, const Vector& at) const;
  std::uint32_t build(std::uint32_t first, std::uint32_t end);
  Vector solid_velocity(std::uint32_t body) const { return body < solids_.size() ? solids_[body].velocity : Vector{}; }
  Parabola seen_from(std::uint32_t mover, const Parabola& curve, double time) const;
  double nearest_share(std::uint32_t body, const Vector& from, const Vector& to) const;
  bool clears(std::uint32_t body, const Parabola& curve, double radius) const;
  /// Call `visit(body)` for each body whose box a segment, widened by half extents, touches, until one returns false.
  template <class Visit>
  bool visit(const Vector& from, const Vector& to, const Vector& width, const Visit& visit) const;

  /// What does not change when solids move: copies share it.
  struct Still {
    std::vector<Triangle> triangles;
    std::vector<Ball> balls;
    std::vector<std::uint32_t> order;
    std::vector<Node> nodes;
  };

  std::vector<Solid> solids_;
  std::vector<std::uint32_t> movers_;
  std::shared_ptr<Still> still_;
};

}  // namespace evenroad::flight
