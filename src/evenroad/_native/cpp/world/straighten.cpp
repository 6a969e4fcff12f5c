#include <algorithm>
#include <cmath>
#include <limits>

#include "world/lattice_path.hpp"

namespace evenroad::world {

namespace {

constexpr int ROUNDS = 8;
/// Share of the length that a round has to gain, or it is the last.
constexpr double WORTHWHILE = 1e-3;

double distance(Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

double length_of(const std::vector<Point>& points) {
  double total = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); i++) total += distance(points[i], points[i + 1]);
  return total;
}

/// Return the points with evenly spread ones between them, about `most` in all.
std::vector<Point> spread(const std::vector<Point>& points, std::int64_t most) {
  const double total = length_of(points);
  const auto spare = static_cast<double>(std::max<std::int64_t>(most - static_cast<std::int64_t>(points.size()), 0));
  std::vector<Point> spread;
  for (std::size_t i = 0; i + 1 < points.size(); i++) {
    const double piece = distance(points[i], points[i + 1]);
    const auto parts = 1 + static_cast<std::int64_t>(total > 0.0 && std::isfinite(total) ? spare * piece / total : 0.0);
    for (std::int64_t k = 0; k < parts; k++) {
      const double t = static_cast<double>(k) / static_cast<double>(parts);
      spread.push_back({(1.0 - t) * points[i].x + t * points[i + 1].x, (1.0 - t) * points[i].y + t * points[i + 1].y});
    }
  }
  spread.push_back(points.back());
  return spread;
}

/// Selects points of a path, and counts the motions that it tests.
class Smoother {
 public:
  explicit Smoother(const Disk& disk) : disk_(disk) {}

  std::int64_t motions() const { return motions_; }

  /// Return the path without points that need not be visited: from each on to the farthest that is found to be visible.
  std::vector<Point> skip_ahead(std::span<const Point> path) {
    std::vector<Point> kept = {path.front()};
    const std::size_t last = path.size() - 1;
    for (std::size_t at = 0; at < last;) {
      // Steps of the path itself are free; farther ones are tried at 2, 4, 8, ... until one is not, then halved.
      std::size_t near = at + 1, far = at + 1;
      for (std::size_t stride = 2; near < last; stride *= 2) {
        far = std::min(at + stride, last);
        if (!is_free(path[at], path[far])) break;
        near = far;
      }
      while (far - near > 1) {
        const std::size_t middle = (near + far) / 2;
        (is_free(path[at], path[middle]) ? near : far) = middle;
      }
      at = near;
      kept.push_back(path[at]);
    }
    return kept;
  }

  /// Return the shortest selection of the points, in their order, whose motions are free.
  std::vector<Point> best_selection(const std::vector<Point>& points) {
    std::vector<double> length(points.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(points.size());
    length[0] = 0.0;
    for (std::size_t j = 1; j < points.size(); j++) {
      // From the first on: what skips most is found first, and what it beats needs no test.
      for (std::size_t i = 0; i < j; i++) {
        const double through = length[i] + distance(points[i], points[j]);
        if (through >= length[j]) continue;
        // Pieces of a free motion, too: their ends are rounded.
        if (is_free(points[i], points[j])) length[j] = through, before[j] = i;
      }
    }
    if (!std::isfinite(length.back())) return points;
    std::vector<Point> chosen;
    for (std::size_t at = points.size() - 1; at > 0; at = before[at]) chosen.push_back(points[at]);
    chosen.push_back(points.front());
    std::reverse(chosen.begin(), chosen.end());
    return chosen;
  }

 private:
  bool is_free(Point from, Point to) {
    motions_++;
    return disk_.is_motion_free(from, to);
  }

  const Disk& disk_;
  std::int64_t motions_ = 0;
};

}  // namespace

Straightened straighten(const Disk& disk, std::span<const Point> path, std::span<const std::int64_t> spreads) {
  Smoother smoother(disk);
  std::vector<Point> points = smoother.skip_ahead(path);
  for (const std::int64_t most : spreads) {
    for (int round = 0; round < ROUNDS; round++) {
      std::vector<Point> shorter = smoother.best_selection(spread(points, most));
      const double before = length_of(points), after = length_of(shorter);
      // Never more points for the same length: what could not be selected comes back as it was spread.
      if (!(after < before)) break;
      points = std::move(shorter);
      if (before - after < WORTHWHILE * before) break;
    }
  }
  // Points on the path, or nearly so, are not needed.
  points = smoother.skip_ahead(points);
  return {std::move(points), smoother.motions()};
}

}  // namespace evenroad::world
