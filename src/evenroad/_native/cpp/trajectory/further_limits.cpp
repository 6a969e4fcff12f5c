#include "trajectory/further_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace evenroad::trajectory {

namespace {

using robot::MovingStates;
using robot::States;
using robot::STATES;
using robot::Vector;
using robot::Vectors;

/// Number of directions in which a tip's acceleration is limited.
constexpr std::size_t SIDES = 8;

/// Length below which a vector counts as 0 [m].
constexpr double NO_LENGTH = 1e-12;

States squared(const Vectors& a) { return dot(a, a); }

/// Eight rows of configurations, velocities and accelerations.
struct EightRows {
  std::vector<States> q, velocity, acceleration;

  explicit EightRows(std::size_t dim) : q(dim), velocity(dim), acceleration(dim) {}

  void read(Matrix<const double> rows, Matrix<const double> velocities, Matrix<const double> accelerations,
            std::size_t first) {
    robot::read_rows(rows, first, q);
    robot::read_rows(velocities, first, velocity);
    robot::read_rows(accelerations, first, acceleration);
  }
};

/// Torques as shares of efforts: of acceleration along a path, of its bend, and at rest.
class TorqueSides {
 public:
  TorqueSides(const TorqueLimits& limits, double share) : limits_(limits), states_(limits.links) {
    for (const double effort : limits.efforts) shares_.push_back(1.0 / (effort * share));
    needed_.resize(shares_.size());
  }

  void write(const EightRows& rows, std::size_t first, Used& used) {
    states_.move_to(rows.q);
    // With a squared speed of 1, velocities are directions, and accelerations are bends.
    states_.move({}, rows.velocity, {});
    copy(used.slope, first);
    states_.move(rows.velocity, rows.acceleration, {});
    copy(used.rise, first);
    states_.move({}, {}, limits_.upwards());
    copy(used.rest, first);
  }

 private:
  void copy(OwnMatrix<double>& to, std::size_t first) {
    states_.write_torques(needed_);
    for (std::size_t lane = 0; lane < std::min(STATES, to.rows - first); lane++) {
      for (std::size_t k = 0; k < needed_.size(); k++) to(first + lane, k) = needed_[k][lane] * shares_[k];
    }
  }

  const TorqueLimits& limits_;
  MovingStates states_;
  std::vector<double> shares_;
  std::vector<States> needed_;
};

/// A tip's acceleration in directions that span the plane of both of its parts: a polygon within the allowed circle.
class TipSides {
 public:
  TipSides(const TipLimits& limits, double share) : limits_(limits), states_(limits.links) {
    speed_ = limits.speed * share;
    const double most = limits.acceleration * share * std::cos(0.5 * std::numbers::pi / SIDES);
    for (std::size_t k = 0; k < SIDES; k++) {
      const double angle = std::numbers::pi * static_cast<double>(k) / SIDES;
      along_[k] = std::cos(angle) / most, across_[k] = std::sin(angle) / most;
    }
  }

  void write(const EightRows& rows, std::size_t first, std::size_t column, Used& used) {
    states_.move_to(rows.q);
    states_.move({}, rows.velocity, {});
    const Vectors pushed = states_.acceleration(limits_.link, limits_.point);
    const States length = sqrt(squared(pushed)), inverse = 1.0 / max(length, all<States>(NO_LENGTH));
    states_.move(rows.velocity, rows.acceleration, {});
    const Vectors turned = states_.acceleration(limits_.link, limits_.point);
    const States ahead = dot(pushed, turned) * inverse;
    const States aside = sqrt(max(squared(turned) - ahead * ahead, States{}));
    for (std::size_t lane = 0; lane < std::min(STATES, used.slope.rows - first); lane++) {
      const double speed = speed_ * inverse[lane];
      used.squares[first + lane] = speed * speed;
      if (!std::isfinite(limits_.acceleration)) continue;
      for (std::size_t k = 0; k < SIDES; k++) {
        used.slope(first + lane, column + k) = along_[k] * length[lane];
        used.rise(first + lane, column + k) = along_[k] * ahead[lane] + across_[k] * aside[lane];
      }
    }
  }

 private:
  const TipLimits& limits_;
  MovingStates states_;
  double speed_;
  std::array<double, SIDES> along_, across_;
};

}  // namespace

std::size_t FurtherLimits::size() const {
  return (torque ? torque->efforts.size() : 0) + (tip && std::isfinite(tip->acceleration) ? SIDES : 0);
}

Used used_by(const FurtherLimits& limits, PathStates states, double share) {
  const Matrix<double> q = states.positions, directions = states.directions, bends = states.bends;
  const std::size_t n = q.rows;
  Used used(n, limits.size());
  std::ranges::fill(used.squares, std::numeric_limits<double>::infinity());
  EightRows rows(q.columns);
  std::optional<TorqueSides> torque;
  std::optional<TipSides> tip;
  if (limits.torque) torque.emplace(*limits.torque, share);
  if (limits.tip) tip.emplace(*limits.tip, share);
  for (std::size_t first = 0; first < n; first += STATES) {
    rows.read(q, directions, bends, first);
    if (torque) torque->write(rows, first, used);
    if (tip) tip->write(rows, first, limits.torque ? limits.torque->efforts.size() : 0, used);
  }
  return used;
}

FurtherShares further_shares(const FurtherLimits& limits, Matrix<const double> q, Matrix<const double> velocity,
                             Matrix<const double> acceleration) {
  EightRows rows(q.columns);
  States torque{}, speed{}, push{};
  std::optional<MovingStates> arm, tip;
  std::vector<States> needed(q.columns);
  if (limits.torque) arm.emplace(limits.torque->links);
  if (limits.tip) tip.emplace(limits.tip->links);
  for (std::size_t first = 0; first < q.rows; first += STATES) {
    rows.read(q, velocity, acceleration, first);
    if (arm) {
      arm->move_to(rows.q);
      arm->move(rows.velocity, rows.acceleration, limits.torque->upwards());
      arm->write_torques(needed);
      for (std::size_t k = 0; k < needed.size(); k++) torque = max(torque, abs(needed[k]) / limits.torque->efforts[k]);
    }
    if (tip) {
      tip->move_to(rows.q);
      tip->move({}, rows.velocity, {});
      speed = max(speed, squared(tip->acceleration(limits.tip->link, limits.tip->point)));
      tip->move(rows.velocity, rows.acceleration, {});
      push = max(push, squared(tip->acceleration(limits.tip->link, limits.tip->point)));
    }
  }
  FurtherShares shares;
  for (std::size_t lane = 0; lane < STATES; lane++) {
    shares.torque = std::max(shares.torque, torque[lane]);
    if (!limits.tip) continue;
    shares.speed = std::max(shares.speed, std::sqrt(speed[lane]) / limits.tip->speed);
    shares.acceleration = std::max(shares.acceleration, std::sqrt(push[lane]) / limits.tip->acceleration);
  }
  return shares;
}

}  // namespace evenroad::trajectory
