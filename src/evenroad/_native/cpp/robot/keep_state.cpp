#include "robot/keep_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace evenroad::robot {

namespace {

using Turn9 = std::array<double, 9>;  // a rotation, row by row

const double TURNED = 0.1 / std::sqrt(2.0);  // metres that an entry of a rotation counts

Vector point_at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// Return a' b of two rotations.
Turn9 between(const Turn9& a, const Turn9& b) {
  Turn9 product{};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) product[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
  }
  return product;
}

/// Return a' v.
Vector turned_back(const Turn9& a, const Vector& v) {
  return {a[0] * v[0] + a[3] * v[1] + a[6] * v[2], a[1] * v[0] + a[4] * v[1] + a[7] * v[2],
          a[2] * v[0] + a[5] * v[1] + a[8] * v[2]};
}

/// Return how a rotation's entries change where it turns by w.
Turn9 change(const Turn9& turn, const Vector& w) {
  Turn9 changed;
  for (int j = 0; j < 3; j++) {
    const Vector moved = cross(w, {turn[j], turn[3 + j], turn[6 + j]});
    for (int i = 0; i < 3; i++) changed[3 * i + j] = moved[i];
  }
  return changed;
}

/// The numbers of a circle by their names.
struct Circle {
  Vector centre, along, out, across;
  double radius;
  const double* turn;
  Vector origin;

  explicit Circle(const std::vector<double>& numbers)
      : centre(point_at(&numbers[0])),
        along(point_at(&numbers[3])),
        out(point_at(&numbers[6])),
        across(point_at(&numbers[9])),
        radius(numbers[12]),
        turn(&numbers[13]),
        origin(point_at(&numbers[22])) {}

  /// Return the door's angle at a place of the tip, and its distance from the hinge.
  std::pair<double, double> polar(const Vector& tip) const {
    const Vector gap = tip - centre;
    const double x = dot(gap, out), y = dot(gap, across);
    return {std::atan2(y, x), std::max(std::sqrt(x * x + y * y), 1e-9)};
  }

  /// Return the rotation of the tip at the door's angle (Rodrigues).
  Turn9 door(double angle) const {
    const double sine = std::sin(angle), versine = 1.0 - std::cos(angle);
    Turn9 turned;
    for (int j = 0; j < 3; j++) {
      const Vector column = {turn[j], turn[3 + j], turn[6 + j]};
      const Vector once = cross(along, column), twice = cross(along, once);
      for (int i = 0; i < 3; i++) turned[3 * i + j] = column[i] + sine * once[i] + versine * twice[i];
    }
    return turned;
  }
};

}  // namespace

KeepState::KeepState(const Keeps& keeps) : keeps_(keeps), axes_(keeps.chains.size()), tips_(keeps.chains.size()) {
  for (std::size_t i = 0; i < axes_.size(); i++) axes_[i].resize(keeps.chains[i].joints.size());
  moves_.assign(axes_.size(), std::vector<double>(6 * keeps.dim()));
}

void KeepState::move_to(std::span<const double> q) {
  q_ = q;
  for (std::size_t i = 0; i < axes_.size(); i++) tips_[i] = keeps_.chains[i].tip_pose(q, axes_[i]);
}

void KeepState::derive() {
  for (std::size_t i = 0; i < axes_.size(); i++) keeps_.chains[i].write_derivative(tips_[i], axes_[i], moves_[i]);
}

void KeepState::write_residual(const Keep& keep, std::span<double> to) const {
  switch (keep.kind) {
    case KeepKind::LINEAR: {
      const Pose& tip = tips_[keep.first];
      for (std::size_t row = 0; row < keep.rows; row++) {
        const double* numbers = &keep.numbers[13 * row];
        double total = 0.0;
        for (int k = 0; k < 9; k++) total += numbers[k] * tip.rotation[k];
        to[row] = total + dot(point_at(numbers + 9), tip.origin) - numbers[12];
      }
      return;
    }
    case KeepKind::BOX:
      for (int k = 0; k < 3; k++) {
        const double at = tips_[keep.first].origin[k];
        to[k] = at - std::min(std::max(at, keep.numbers[k]), keep.numbers[3 + k]);
      }
      return;
    case KeepKind::CIRCLE: {
      const Circle circle(keep.numbers);
      const Pose& tip = tips_[keep.first];
      const auto [angle, far] = circle.polar(tip.origin);
      const Turn9 door = circle.door(angle);
      to[0] = far - circle.radius;
      to[1] = dot(tip.origin - circle.origin, circle.along);
      for (int k = 0; k < 9; k++) to[2 + k] = TURNED * (tip.rotation[k] - door[k]);
      return;
    }
    case KeepKind::TOGETHER: {
      const Pose &a = tips_[keep.first], &b = tips_[keep.second];
      const Turn9 turn = between(a.rotation, b.rotation);
      const Vector gap = turned_back(a.rotation, b.origin - a.origin);
      for (int k = 0; k < 3; k++) to[k] = gap[k] - keep.numbers[9 + k];
      for (int k = 0; k < 9; k++) to[3 + k] = TURNED * (turn[k] - keep.numbers[k]);
      return;
    }
    case KeepKind::JOINTS:
      for (std::size_t k = 0; k < q_.size(); k++) {
        to[k] = q_[k] - std::min(std::max(q_[k], keep.numbers[k]), keep.numbers[q_.size() + k]);
      }
      return;
  }
}

void KeepState::write_column(const Keep& keep, std::size_t joint, std::span<double> to) const {
  switch (keep.kind) {
    case KeepKind::LINEAR: {
      const auto [moved, turned] = twist(keep.first, joint);
      const Turn9 changed = change(tips_[keep.first].rotation, turned);
      for (std::size_t row = 0; row < keep.rows; row++) {
        const double* numbers = &keep.numbers[13 * row];
        double total = dot(point_at(numbers + 9), moved);
        for (int k = 0; k < 9; k++) total += numbers[k] * changed[k];
        to[row] = total;
      }
      return;
    }
    case KeepKind::BOX: {
      const Vector moved = twist(keep.first, joint).first;
      for (int k = 0; k < 3; k++) {
        const double at = tips_[keep.first].origin[k];
        to[k] = at < keep.numbers[k] || at > keep.numbers[3 + k] ? moved[k] : 0.0;
      }
      return;
    }
    case KeepKind::CIRCLE: {
      const Circle circle(keep.numbers);
      const Pose& tip = tips_[keep.first];
      const auto [angle, far] = circle.polar(tip.origin);
      const auto [moved, turned] = twist(keep.first, joint);
      const Vector radial = circle.out * std::cos(angle) + circle.across * std::sin(angle);
      const double swing = dot(cross(circle.along, radial), moved) / far;
      const Turn9 own = change(tip.rotation, turned), door = change(circle.door(angle), circle.along * swing);
      to[0] = dot(radial, moved);
      to[1] = dot(circle.along, moved);
      for (int k = 0; k < 9; k++) to[2 + k] = TURNED * (own[k] - door[k]);
      return;
    }
    case KeepKind::TOGETHER: {
      const Pose &a = tips_[keep.first], &b = tips_[keep.second];
      const auto [a_moved, a_turned] = twist(keep.first, joint);
      const auto [b_moved, b_turned] = twist(keep.second, joint);
      const Vector moved = b_moved - a_moved + cross(b.origin - a.origin, a_turned), turned = b_turned - a_turned;
      const Vector gap = turned_back(a.rotation, moved);
      const Turn9 changed = change(between(a.rotation, b.rotation), turned_back(a.rotation, turned));
      for (int k = 0; k < 3; k++) to[k] = gap[k];
      for (int k = 0; k < 9; k++) to[3 + k] = TURNED * changed[k];
      return;
    }
    case KeepKind::JOINTS:
      std::fill(to.begin(), to.end(), 0.0);
      to[joint] = q_[joint] < keep.numbers[joint] || q_[joint] > keep.numbers[q_.size() + joint] ? 1.0 : 0.0;
      return;
  }
}

std::pair<Vector, Vector> KeepState::twist(std::size_t tip, std::size_t joint) const {
  const std::vector<double>& rows = moves_[tip];
  const std::size_t dim = q_.size();
  return {{rows[joint], rows[dim + joint], rows[2 * dim + joint]},
          {rows[3 * dim + joint], rows[4 * dim + joint], rows[5 * dim + joint]}};
}

}  // namespace evenroad::robot
