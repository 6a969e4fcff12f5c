// A path is pulled taut corner by corner: a corner slides along one of its legs, or is cut into two.  Both make the
// path shorter for any obstacles.  The distance is found by bisection, with exact motions.
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/time_limit.hpp"
#include "world/lattice_path.hpp"

namespace evenroad::world {

namespace {

constexpr int ROUNDS = 12;
/// Share of the length that a round must gain, or it is the last; and that a new corner must gain.
constexpr double WORTHWHILE = 2e-4, WORTH_A_CORNER = 2e-4;
/// Distance of a corner, or twice that, from the farthest point that it can be pulled to, in pixels.  A robot that
/// drives along the path, in steps of time, can then pass it.
constexpr double CLOSE = 1.0 / 64.0;
constexpr int HALVINGS = 20;

Point between(Point a, Point b, double share) { return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)}; }

double length_of(const std::vector<Point>& points) {
  double total = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); i++) total += distance(points[i], points[i + 1]);
  return total;
}

/// Pulls a path, and counts the motions that it tests.
class Smoother {
 public:
  explicit Smoother(const Disk& disk) : disk_(disk), close_(CLOSE * disk.frame().scale) {}

  std::int64_t motions() const { return motions_; }

  /// Return the path without unnecessary points: each is joined to the farthest visible one that is found.
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

  /// Pull all corners once, from the first to the last, and remove unnecessary ones.
  void pull(std::vector<Point>& points) {
    std::size_t kept = 1;
    for (std::size_t next = 1; next + 1 < points.size(); next++) {
      const Point before = points[kept - 1], after = points[next + 1];
      Point corner = points[next];
      if (is_free(before, after)) continue;
      corner = slid(before, corner, after);
      corner = slid(after, corner, before);
      points[kept++] = corner;
    }
    points[kept++] = points.back();
    points.resize(kept);
  }

  /// Return the path with two corners for each that is worth it.
  std::vector<Point> cut(const std::vector<Point>& points, double least) {
    std::vector<Point> cut = {points.front()};
    for (std::size_t i = 1; i + 1 < points.size(); i++) {
      const Point before = cut.back(), corner = points[i], after = points[i + 1];
      const double most = 0.5 * std::min(distance(before, corner), distance(corner, after));
      const auto at = [&](Point leg, double away) { return between(corner, leg, away / distance(corner, leg)); };
      const double away = farthest(most, [&](double each) { return is_free(at(before, each), at(after, each)); });
      const Point first = at(before, away), second = at(after, away);
      if (away > 0.0 && 2.0 * away - distance(first, second) > least && is_free(before, first) &&
          is_free(second, after)) {
        cut.push_back(first), cut.push_back(second);
      } else {
        cut.push_back(corner);
      }
    }
    cut.push_back(points.back());
    return cut;
  }

 private:
  bool is_free(Point from, Point to) {
    motions_++;
    clock_.look();
    return disk_.is_motion_free(from, to);
  }

  /// Return slightly less than the largest number up to `most` for which a test holds; it holds for 0.
  template <class Holds>
  double farthest(double most, const Holds& holds) {
    if (holds(most)) return most;
    double good = 0.0, bad = most;
    for (int i = 0; i < HALVINGS && bad - good > close_; i++) {
      const double middle = 0.5 * (good + bad);
      (holds(middle) ? good : bad) = middle;
    }
    return std::max(good - close_, 0.0);
  }

  /// Return the position of a corner that slides along its leg to `before` while `after` is visible.
  Point slid(Point before, Point corner, Point after) {
    const double leg = distance(before, corner);
    if (leg <= close_) return corner;
    const auto at = [&](double away) { return between(corner, before, away / leg); };
    const Point slid = at(farthest(leg, [&](double away) { return is_free(at(away), after); }));
    // A piece of a free motion is tested, too, because its end is rounded.
    return is_free(before, slid) ? slid : corner;
  }

  const Disk& disk_;
  double close_;
  ClockWatch clock_{16};
  std::int64_t motions_ = 0;
};

}  // namespace

Straightened straighten(const Disk& disk, std::span<const Point> path) {
  Smoother smoother(disk);
  std::vector<Point> points = smoother.skip_ahead(path);
  double before = length_of(points);
  for (int round = 0; round < ROUNDS; round++) {
    smoother.pull(points);
    points = smoother.cut(points, WORTH_A_CORNER * before);
    const double after = length_of(points);
    if (!(before - after > WORTHWHILE * before)) break;
    before = after;
  }
  smoother.pull(points);
  return {std::move(points), smoother.motions()};
}

}  // namespace evenroad::world
