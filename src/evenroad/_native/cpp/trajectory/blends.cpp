#include "trajectory/blends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace evenroad::trajectory {

namespace {

/// Angle below which a corner counts as straight [rad]: the largest error of the next arc.
constexpr double STRAIGHT = 1e-6;

/// A corner within this angle of a reversal has no arc [rad].
constexpr double REVERSAL = 1e-3;

/// Shares of the whole path below which a line, and an arc's part of a line, count as 0.  Lengths are sums along the
/// path, and have its rounding.
constexpr double NO_LINE = 1e-12, NO_ARC = 1e-11;

/// Share of the whole path below which two waypoints are equal.
constexpr double NO_MOTION = 1e-11;

/// Distance from the straight line past it below which a waypoint lies on the line: a share of the path, and one of its
/// largest coordinate.
constexpr double OFF_PATH = 1e-13, OFF_ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();

/// Half of the angle of a corner, and the lengths of its arc on both motions; 0 without an arc.
struct Corner {
  double half = 0.0, cut = 0.0;

  bool turns() const { return half > 0.5 * STRAIGHT; }
};

/// Return half of the angle between two directions, also exact for small angles.
double half_angle(std::span<const double> before, std::span<const double> after) {
  double difference = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < before.size(); k++) {
    difference += (after[k] - before[k]) * (after[k] - before[k]);
    sum += (after[k] + before[k]) * (after[k] + before[k]);
  }
  return std::atan2(std::sqrt(difference), std::sqrt(sum));
}

/// Return whether a point is within a distance of the straight line from one point to another.
bool is_between(std::span<const double> point, std::span<const double> from, std::span<const double> to, double off) {
  double along = 0.0, squared = 0.0, away = 0.0;
  for (std::size_t k = 0; k < point.size(); k++) {
    along += (point[k] - from[k]) * (to[k] - from[k]);
    squared += (to[k] - from[k]) * (to[k] - from[k]);
  }
  const double share = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  for (std::size_t k = 0; k < point.size(); k++) {
    const double gap = point[k] - from[k] - share * (to[k] - from[k]);
    away += gap * gap;
  }
  return away <= off * off;
}

}  // namespace

std::vector<std::size_t> bends_of(Matrix<const double> waypoints, double same) {
  double whole = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < waypoints.rows; i++) {
    double squared = 0.0;
    for (std::size_t k = 0; k < waypoints.columns; k++) {
      largest = std::max(largest, std::abs(waypoints(i, k)));
      const double step = i > 0 ? waypoints(i, k) - waypoints(i - 1, k) : 0.0;
      squared += step * step;
    }
    whole += std::sqrt(squared);
  }
  const double gap = std::max(same, NO_MOTION * whole), off = OFF_PATH * whole + OFF_ROUNDING * largest;
  const auto is_same = [&](std::size_t i, std::size_t j) {
    return std::ranges::equal(waypoints[i], waypoints[j], [&](double a, double b) { return std::abs(a - b) <= gap; });
  };
  std::vector<std::size_t> bends{0};
  // The waypoint after the last bend, which may also be one.
  std::size_t next = 0;
  for (std::size_t i = 1; i < waypoints.rows; i++) {
    if (is_same(i, next)) continue;
    if (next != 0 && !is_between(waypoints[next], waypoints[bends.back()], waypoints[i], off)) bends.push_back(next);
    next = i;
  }
  if (next != 0) bends.push_back(waypoints.rows - 1);
  return bends;
}

RoundedPath rounded(Matrix<const double> waypoints, std::span<const double> deviation) {
  const std::size_t motions = waypoints.rows - 1, dim = waypoints.columns;
  OwnMatrix<double> directions(motions, dim);
  std::vector<double> lengths(motions);
  for (std::size_t i = 0; i < motions; i++) {
    double squared = 0.0;
    for (std::size_t k = 0; k < dim; k++) {
      directions(i, k) = waypoints(i + 1, k) - waypoints(i, k);
      squared += directions(i, k) * directions(i, k);
    }
    lengths[i] = std::sqrt(squared);
    for (double& each : directions[i]) each /= lengths[i];
  }
  const double whole = std::reduce(lengths.begin(), lengths.end());
  std::vector<Corner> corners(motions + 1);
  for (std::size_t i = 1; i < motions; i++) {
    const double half = half_angle(directions[i - 1], directions[i]);
    corners[i].half = half;
    if (!corners[i].turns() || half >= 0.5 * std::numbers::pi - REVERSAL || deviation[i] <= 0.0) continue;
    const double cut =
        std::min(0.5 * std::min(lengths[i - 1], lengths[i]), deviation[i] * std::sin(half) / (1.0 - std::cos(half)));
    if (cut > NO_ARC * whole) corners[i].cut = cut;
  }
  RoundedPath path(dim);
  double total = 0.0;
  std::vector<double> centre(dim), out(dim), start(dim);
  const std::vector<double> nowhere(dim);
  const auto add = [&](std::span<const double> origin, std::span<const double> from, std::span<const double> along,
                       double bend) {
    path.starts.push_back(total), path.bend.push_back(bend);
    path.origin.append(origin), path.out.append(from), path.along.append(along);
  };
  for (std::size_t i = 0; i < motions; i++) {
    const Corner& corner = corners[i];
    const std::span<const double> after = directions[i];
    if (corner.cut > 0.0) {
      const std::span<const double> before = directions[i - 1];
      const double radius = corner.cut / std::tan(corner.half);
      double squared = 0.0;
      for (std::size_t k = 0; k < dim; k++) squared += (after[k] - before[k]) * (after[k] - before[k]);
      const double inward = radius / std::cos(corner.half) / std::sqrt(squared);
      for (std::size_t k = 0; k < dim; k++) {
        centre[k] = waypoints(i, k) + (after[k] - before[k]) * inward;
        out[k] = (waypoints(i, k) - corner.cut * before[k] - centre[k]) / radius;
      }
      add(centre, out, before, 1.0 / radius);
      path.corners.push_back(total + radius * corner.half);
      total += radius * 2.0 * corner.half;
    } else if (i > 0) {
      path.corners.push_back(total);
      if (corner.turns()) path.stops.push_back(total);
    }
    const double line = lengths[i] - corner.cut - corners[i + 1].cut;
    if (line <= NO_LINE * whole) continue;
    for (std::size_t k = 0; k < dim; k++) start[k] = waypoints(i, k) + corner.cut * after[k];
    add(start, nowhere, after, 0.0);
    total += line;
  }
  path.starts.push_back(total);
  return path;
}

}  // namespace evenroad::trajectory
