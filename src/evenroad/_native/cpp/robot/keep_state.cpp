#include "robot/keep_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace evenroad::robot {

namespace {

using Turn9 = std::array<double, 9>;  // a rotation, row by row

const double TURNED = 0.1 / std::sqrt(2.0);  // metres that an entry of a rotation counts

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Return a' b of two rotations.
Turn9 between(const Turn9& a, const Turn9& b) {
  Turn9 product{};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) product[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
  }
  return product;
}

/// Return a' v.
Point turned_back(const Turn9& a, const Point& v) {
  return {a[0] * v[0] + a[3] * v[1] + a[6] * v[2], a[1] * v[0] + a[4] * v[1] + a[7] * v[2],
          a[2] * v[0] + a[5] * v[1] + a[8] * v[2]};
}

/// Return how a rotation's entries change where it turns by w.
Turn9 change(const Turn9& turn, const Point& w) {
  Turn9 changed;
  for (int j = 0; j < 3; j++) {
    const double column[] = {turn[j], turn[3 + j], turn[6 + j]};
    const Point moved = cross(w.data(), column);
    for (int i = 0; i < 3; i++) changed[3 * i + j] = moved[i];
  }
  return changed;
}

/// The numbers of a circle by their names.
struct Circle {
  const double *centre, *along, *out, *across;
  double radius;
  const double *turn, *origin;

  explicit Circle(const std::vector<double>& numbers)
      : centre(&numbers[0]),
        along(&numbers[3]),
        out(&numbers[6]),
        across(&numbers[9]),
        radius(numbers[12]),
        turn(&numbers[13]),
        origin(&numbers[22]) {}

  /// Return the door's angle at a place of the tip, and its distance from the hinge.
  std::pair<double, double> polar(const Point& tip) const {
    const double gap[] = {tip[0] - centre[0], tip[1] - centre[1], tip[2] - centre[2]};
    const double x = dot(gap, out), y = dot(gap, across);
    return {std::atan2(y, x), std::max(std::sqrt(x * x + y * y), 1e-9)};
  }

  /// Return the rotation of the tip at the door's angle (Rodrigues).
  Turn9 door(double angle) const {
    const double sine = std::sin(angle), versine = 1.0 - std::cos(angle);
    Turn9 turned;
    for (int j = 0; j < 3; j++) {
      const double column[] = {turn[j], turn[3 + j], turn[6 + j]};
      const Point once = cross(along, column), twice = cross(along, once.data());
      for (int i = 0; i < 3; i++) turned[3 * i + j] = column[i] + sine * once[i] + versine * twice[i];
    }
    return turned;
  }
};

/// Return the way from one tip to another.
Point offset(const Pose& a, const Pose& b) {
  return {b.origin[0] - a.origin[0], b.origin[1] - a.origin[1], b.origin[2] - a.origin[2]};
}

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
        to[row] = total + dot(numbers + 9, tip.origin.data()) - numbers[12];
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
      const double rise[] = {tip.origin[0] - circle.origin[0], tip.origin[1] - circle.origin[1],
                             tip.origin[2] - circle.origin[2]};
      to[0] = far - circle.radius;
      to[1] = dot(rise, circle.along);
      for (int k = 0; k < 9; k++) to[2 + k] = TURNED * (tip.rotation[k] - door[k]);
      return;
    }
    case KeepKind::TOGETHER: {
      const Pose &a = tips_[keep.first], &b = tips_[keep.second];
      const Turn9 turn = between(a.rotation, b.rotation);
      const Point gap = turned_back(a.rotation, offset(a, b));
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
        double total = dot(numbers + 9, moved.data());
        for (int k = 0; k < 9; k++) total += numbers[k] * changed[k];
        to[row] = total;
      }
      return;
    }
    case KeepKind::BOX: {
      const Point moved = twist(keep.first, joint).first;
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
      Point radial;
      for (int k = 0; k < 3; k++) radial[k] = std::cos(angle) * circle.out[k] + std::sin(angle) * circle.across[k];
      const Point tangent = cross(circle.along, radial.data());
      const double swing = dot(tangent.data(), moved.data()) / far;
      const Point of_door = {circle.along[0] * swing, circle.along[1] * swing, circle.along[2] * swing};
      const Turn9 own = change(tip.rotation, turned), door = change(circle.door(angle), of_door);
      to[0] = dot(radial.data(), moved.data());
      to[1] = dot(circle.along, moved.data());
      for (int k = 0; k < 9; k++) to[2 + k] = TURNED * (own[k] - door[k]);
      return;
    }
    case KeepKind::TOGETHER: {
      const Pose &a = tips_[keep.first], &b = tips_[keep.second];
      const auto [a_moved, a_turned] = twist(keep.first, joint);
      const auto [b_moved, b_turned] = twist(keep.second, joint);
      const Point away = offset(a, b), carried = cross(away.data(), a_turned.data());
      Point moved, turned;
      for (int k = 0; k < 3; k++) {
        moved[k] = b_moved[k] - a_moved[k] + carried[k];
        turned[k] = b_turned[k] - a_turned[k];
      }
      const Point gap = turned_back(a.rotation, moved);
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

std::pair<Point, Point> KeepState::twist(std::size_t tip, std::size_t joint) const {
  const std::vector<double>& rows = moves_[tip];
  const std::size_t dim = q_.size();
  return {{rows[joint], rows[dim + joint], rows[2 * dim + joint]},
          {rows[3 * dim + joint], rows[4 * dim + joint], rows[5 * dim + joint]}};
}

}  // namespace evenroad::robot
