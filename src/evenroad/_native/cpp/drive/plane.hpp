// Points, poses and motions in the plane of a padded grid (see world/disk.hpp): lengths are in cells, and angles turn
// from the direction of columns to that of rows.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace evenroad::drive {

constexpr double PI = std::numbers::pi;

struct Vec {
  double x = 0.0, y = 0.0;
};

inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y}; }
inline Vec operator*(double s, Vec a) { return {s * a.x, s * a.y}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vec a) { return std::sqrt(dot(a, a)); }

/// Return an angle in [-pi, pi).
inline double wrapped(double angle) { return angle - 2.0 * PI * std::floor((angle + PI) / (2.0 * PI)); }

struct Pose {
  double x = 0.0, y = 0.0, angle = 0.0;
};

/// An order of poses, by which a motion and its reverse are driven alike.
inline bool is_before(const Pose& a, const Pose& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.angle < b.angle;
}

/// A pose with its cosine and sine: it moves points of a body to where they are.
class Placed {
 public:
  explicit Placed(const Pose& pose) : at_{pose.x, pose.y}, cosine_(std::cos(pose.angle)), sine_(std::sin(pose.angle)) {}
  Vec operator()(Vec v) const { return {at_.x + cosine_ * v.x - sine_ * v.y, at_.y + sine_ * v.x + cosine_ * v.y}; }

 private:
  Vec at_;
  double cosine_, sine_;
};

/// A motion from t = 0 to 1: a turn about a centre, or a straight drive, which may turn evenly on its way.
struct Motion {
  Pose from;
  Vec by;  ///< By how much the reference point moves; of straight drives alone.
  double turn;
  Vec centre;
  bool is_about;  ///< Whether it turns about the centre.

  static Motion straight(const Pose& q, double length) {
    return {q, {length * std::cos(q.angle), length * std::sin(q.angle)}, 0.0, {}, false};
  }
  static Motion arc(const Pose& q, double curvature, double length) {
    const Vec centre{q.x - std::sin(q.angle) / curvature, q.y + std::cos(q.angle) / curvature};
    return {q, {}, curvature * length, centre, true};
  }
  static Motion on_the_spot(const Pose& q, double turn) { return {q, {}, turn, {q.x, q.y}, true}; }
  static Motion line(const Pose& a, const Pose& b) {
    return {a, {b.x - a.x, b.y - a.y}, wrapped(b.angle - a.angle), {}, false};
  }

  Pose at(double t) const {
    if (!is_about) return {from.x + t * by.x, from.y + t * by.y, from.angle + t * turn};
    const double c = std::cos(t * turn), s = std::sin(t * turn);
    const Vec d = Vec{from.x, from.y} - centre;
    return {centre.x + c * d.x - s * d.y, centre.y + s * d.x + c * d.y, from.angle + t * turn};
  }
};

}  // namespace evenroad::drive
