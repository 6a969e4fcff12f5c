#include "trajectory/blends.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace evenroad::trajectory {

namespace {

/// Angle below which a corner counts as straight [rad]: the largest error of the next arc.
constexpr double STRAIGHT = 1e-6;

/// A corner within that of a reversal has no arc [rad].
constexpr double REVERSAL = 1e-3;

/// A line shorter than this share of its motion is none.
constexpr double NO_LINE = 1e-12;

/// Half of the angle of a corner, and the lengths that its arc takes of both motions: 0 where there is no arc.
struct Corner {
  double half = 0.0, cut = 0.0;

  bool turns() const { return half > 0.5 * STRAIGHT; }
};

/// Return half of the angle between two directions, exact for small ones, too.
double half_angle(std::span<const double> before, std::span<const double> after) {
  double apart = 0.0, together = 0.0;
  for (std::size_t k = 0; k < before.size(); k++) {
    apart += (after[k] - before[k]) * (after[k] - before[k]);
    together += (after[k] + before[k]) * (after[k] + before[k]);
  }
  return std::atan2(std::sqrt(apart), std::sqrt(together));
}

void append(std::vector<double>& row, std::span<const double> more) { row.insert(row.end(), more.begin(), more.end()); }

}  // namespace

Blends rounded(Matrix<const double> waypoints, std::span<const double> deviation) {
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
  std::vector<Corner> corners(motions + 1);
  for (std::size_t i = 1; i < motions; i++) {
    const double half = half_angle(directions[i - 1], directions[i]);
    corners[i].half = half;
    if (!corners[i].turns() || half >= 0.5 * std::numbers::pi - REVERSAL || deviation[i] <= 0.0) continue;
    corners[i].cut =
        std::min(0.5 * std::min(lengths[i - 1], lengths[i]), deviation[i] * std::sin(half) / (1.0 - std::cos(half)));
  }
  Blends path;
  double total = 0.0;
  std::vector<double> centre(dim), out(dim), start(dim);
  const std::vector<double> nowhere(dim);
  const auto add = [&](std::span<const double> origin, std::span<const double> from, std::span<const double> along,
                       double bend) {
    path.starts.push_back(total), path.bend.push_back(bend);
    append(path.origin, origin), append(path.out, from), append(path.along, along);
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
    if (line <= NO_LINE * lengths[i]) continue;
    for (std::size_t k = 0; k < dim; k++) start[k] = waypoints(i, k) + corner.cut * after[k];
    add(start, nowhere, after, 0.0);
    total += line;
  }
  path.starts.push_back(total);
  return path;
}

}  // namespace evenroad::trajectory
