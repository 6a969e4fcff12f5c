#include "flight/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

constexpr std::uint32_t PER_LEAF = 2;
/// A curve is halved before the tree is searched until it keeps this near to its chord, as a share of the radius.
constexpr double NEAR_CHORD = 1.0;
/// Number of halvings after which a curve is as short as its tolerance, with much to spare.
constexpr std::size_t DEEPEST = 64;
/// Number of halvings of an interval around the nearest point of a segment.
constexpr int HALVINGS_OF_SHARE = 7;
/// Shortest step on a way out, as a share of the distance that is to be kept.
constexpr double LEAST_EXIT = 0.05;

/// Return the point of a box or a cylinder that is nearest to a point.
Vector nearest_on(const robot::Exact& o, const Vector& at) {
  const Vector d{at[0] - o.centre[0], at[1] - o.centre[1], at[2] - o.centre[2]};
  Vector own;
  for (std::size_t k = 0; k < 3; k++)
    own[k] = d[0] * o.rotation[k] + d[1] * o.rotation[3 + k] + d[2] * o.rotation[6 + k];
  own[2] = std::clamp(own[2], -o.half[2], o.half[2]);
  if (o.form == robot::Form::CYLINDER) {
    const double aside = std::sqrt(own[0] * own[0] + own[1] * own[1]);
    if (aside > o.half[0]) own[0] *= o.half[0] / aside, own[1] *= o.half[0] / aside;
  } else {
    for (std::size_t k = 0; k < 2; k++) own[k] = std::clamp(own[k], -o.half[k], o.half[k]);
  }
  Vector found;
  for (std::size_t k = 0; k < 3; k++) {
    const double* row = o.rotation + 3 * k;
    found[k] = o.centre[k] + row[0] * own[0] + row[1] * own[1] + row[2] * own[2];
  }
  return found;
}

/// Return the point of a segment that is nearest to a point.
Vector nearest_on(const Vector& from, const Vector& to, const Vector& at) {
  const Vector along = to - from;
  const double squared = squared_length(along);
  return from + along * (squared > 0.0 ? std::clamp(dot(at - from, along) / squared, 0.0, 1.0) : 0.0);
}

/// Return the point of a triangle that is nearest to a point.
Vector nearest_on(const Triangle& triangle, const Vector& at) {
  const auto& [a, b, c] = triangle.corners;
  const Vector normal = cross(b - a, c - a);
  const double squared = squared_length(normal);
  if (squared > 0.0) {
    const auto inside = [&](const Vector& from, const Vector& to) {
      return dot(cross(to - from, at - from), normal) >= 0.0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a)) return at - normal * (dot(at - a, normal) / squared);
  }
  Vector best = nearest_on(a, b, at);
  for (const Vector& other : {nearest_on(b, c, at), nearest_on(c, a, at)}) {
    if (squared_length(other - at) < squared_length(best - at)) best = other;
  }
  return best;
}

/// A segment that is tested against many boxes.
class Segment {
 public:
  Segment(const Vector& from, const Vector& to) : from_(from) {
    for (std::size_t k = 0; k < 3; k++) inverse_[k] = 1.0 / (to[k] - from[k]);
  }

  /// Say whether it meets a box that is larger by half extents.
  bool meets(const Vector& low, const Vector& high, const Vector& width) const {
    double enter = 0.0, leave = 1.0;
    for (std::size_t k = 0; k < 3; k++) {
      const double below = low[k] - width[k] - from_[k], above = high[k] + width[k] - from_[k];
      if (std::isinf(inverse_[k])) {
        if (below > 0.0 || above < 0.0) return false;
        continue;
      }
      const double first = below * inverse_[k], last = above * inverse_[k];
      enter = std::max(enter, std::min(first, last)), leave = std::min(leave, std::max(first, last));
    }
    return enter <= leave;
  }

 private:
  Vector from_, inverse_;
};

}  // namespace

Bodies::Bodies(std::vector<Solid> solids, std::vector<Triangle> triangles, std::vector<Ball> balls,
               std::vector<std::uint32_t> movers)
    : solids_(std::move(solids)),
      movers_(std::move(movers)),
      still_(std::make_shared<Still>(Still{std::move(triangles), std::move(balls), {}, {}})) {
  std::vector<bool> is_moving(count(), false);
  for (const std::uint32_t mover : movers_) is_moving[mover] = true;
  for (std::uint32_t body = 0; body < count(); body++) {
    if (!is_moving[body]) still_->order.push_back(body);
  }
  if (!still_->order.empty()) build(0, static_cast<std::uint32_t>(still_->order.size()));
}

std::uint32_t Bodies::build(std::uint32_t first, std::uint32_t end) {
  const auto number = static_cast<std::uint32_t>(still_->nodes.size());
  constexpr double far = std::numeric_limits<double>::infinity();
  Node node{{far, far, far}, {-far, -far, -far}, first, end - first, 0};
  Vector low, high;
  for (std::uint32_t i = first; i < end; i++) {
    write_box(still_->order[i], low, high);
    for (std::size_t k = 0; k < 3; k++) {
      node.low[k] = std::min(node.low[k], low[k]), node.high[k] = std::max(node.high[k], high[k]);
    }
  }
  still_->nodes.push_back(node);
  if (node.count <= PER_LEAF) return number;
  const Vector size = node.high - node.low;
  const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const auto middle = [&](std::uint32_t body) {
    Vector lower, upper;
    write_box(body, lower, upper);
    return std::pair(lower[axis] + upper[axis], body);
  };
  const std::uint32_t half = first + node.count / 2;
  std::nth_element(still_->order.begin() + first, still_->order.begin() + half, still_->order.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
  build(first, half);
  const std::uint32_t second = build(half, end);
  still_->nodes[number].second = second, still_->nodes[number].count = 0;
  return number;
}

void Bodies::write_box(std::uint32_t body, Vector& low, Vector& high) const {
  if (body < solids_.size()) {
    const robot::Exact& shape = solids_[body].shape;
    double extents[3];
    robot::write_extents(shape, extents);
    for (std::size_t k = 0; k < 3; k++) low[k] = shape.centre[k] - extents[k], high[k] = shape.centre[k] + extents[k];
    return;
  }
  body -= static_cast<std::uint32_t>(solids_.size());
  if (body < still_->triangles.size()) {
    const Triangle& each = still_->triangles[body];
    for (std::size_t k = 0; k < 3; k++) {
      const auto [least, most] = std::minmax({each.corners[0][k], each.corners[1][k], each.corners[2][k]});
      low[k] = least - each.rounding, high[k] = most + each.rounding;
    }
    return;
  }
  const Ball& ball = still_->balls[body - still_->triangles.size()];
  for (std::size_t k = 0; k < 3; k++) low[k] = ball.centre[k] - ball.radius, high[k] = ball.centre[k] + ball.radius;
}

double Bodies::farthest() const {
  double farthest = 0.0;
  const auto add = [&](const Vector& low, const Vector& high) {
    for (std::size_t k = 0; k < 3; k++) farthest = std::max({farthest, std::abs(low[k]), std::abs(high[k])});
  };
  if (!still_->nodes.empty()) add(still_->nodes[0].low, still_->nodes[0].high);
  Vector low, high;
  for (const std::uint32_t mover : movers_) write_box(mover, low, high), add(low, high);
  return farthest;
}

Bodies::Near Bodies::near_to(std::uint32_t body, const Vector& at) const {
  if (body < solids_.size()) return {nearest_on(solids_[body].shape, at), solids_[body].shape.rounding};
  body -= static_cast<std::uint32_t>(solids_.size());
  if (body < still_->triangles.size())
    return {nearest_on(still_->triangles[body], at), still_->triangles[body].rounding};
  const Ball& ball = still_->balls[body - still_->triangles.size()];
  return {ball.centre, ball.radius};
}

template <class Visit>
bool Bodies::visit(const Vector& from, const Vector& to, const Vector& width, const Visit& visit) const {
  if (still_->nodes.empty()) return true;
  const Segment segment(from, to);
  std::array<std::uint32_t, DEEPEST> waiting;
  waiting[0] = 0;
  for (std::size_t left = 1; left > 0;) {
    const Node& node = still_->nodes[waiting[--left]];
    if (!segment.meets(node.low, node.high, width)) continue;
    if (node.count == 0) {
      waiting[left++] = node.second, waiting[left++] = static_cast<std::uint32_t>(&node - still_->nodes.data()) + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; i++) {
      if (!visit(still_->order[i])) return false;
    }
  }
  return true;
}

bool Bodies::is_free(const Vector& at, double time, double radius) const {
  return is_free(Parabola{at, {}, {}, 0.0}, time, radius);
}

bool Bodies::is_free(const Parabola& curve, double time, double radius) const {
  const double h = curve.duration;
  if (norm(curve.acceleration) * h * h * 0.125 > NEAR_CHORD * std::max(radius, TOLERANCE)) {
    const double half = 0.5 * h;
    return is_free({curve.position, curve.velocity, curve.acceleration, half}, time, radius) &&
           is_free({curve.at(half), curve.velocity_at(half), curve.acceleration, half}, time + half, radius);
  }
  for (const std::uint32_t mover : movers_) {
    if (!clears(mover, seen_from(mover, curve, time), radius)) return false;
  }
  Vector width;
  for (std::size_t k = 0; k < 3; k++) width[k] = radius + std::abs(curve.acceleration[k]) * h * h * 0.125;
  return visit(curve.position, curve.at(h), width, [&](std::uint32_t body) { return clears(body, curve, radius); });
}

bool Bodies::clears(std::uint32_t body, const Parabola& curve, double radius) const {
  struct Interval {
    double from, to;
  };
  std::array<Interval, DEEPEST> waiting;
  waiting[0] = {0.0, curve.duration};
  ClockWatch clock(1024);
  for (std::size_t left = 1; left > 0;) {
    const auto [from, to] = waiting[--left];
    clock.look();
    const double middle = 0.5 * (from + to);
    const Vector at = curve.at(middle);
    const Near near = near_to(body, at);
    const double away = norm(at - near.point), least = radius + near.rounding;
    if (!(away > least)) return false;
    const Vector normal = (at - near.point) * (1.0 / away);
    const auto height = [&](double t) { return dot(curve.at(t) - near.point, normal); };
    double lowest = std::min(height(from), height(to));
    if (const double bend = dot(curve.acceleration, normal); bend > 0.0) {
      const double t = -dot(curve.velocity, normal) / bend;
      if (from < t && t < to) lowest = std::min(lowest, height(t));
    }
    if (lowest > least) continue;
    const double speed =
        std::sqrt(std::max(squared_length(curve.velocity_at(from)), squared_length(curve.velocity_at(to))));
    if (speed * (to - from) < TOLERANCE || left + 2 > DEEPEST) return false;
    waiting[left++] = {middle, to}, waiting[left++] = {from, middle};
  }
  return true;
}

/// A curve as it looks from a body that moves, which is where it is at time 0.
Parabola Bodies::seen_from(std::uint32_t mover, const Parabola& curve, double time) const {
  const Vector& velocity = solids_[mover].velocity;
  return {curve.position - velocity * time, curve.velocity - velocity, curve.acceleration, curve.duration};
}

std::optional<double> Bodies::first_contact(const Parabola& line, double time, double radius) const {
  constexpr double none = 2.0;
  double first = none;
  const auto look = [&](std::uint32_t body, const Parabola& seen) {
    if (!clears(body, seen, radius)) {
      first = std::min(first, nearest_share(body, seen.position, seen.at(seen.duration)));
    }
    return true;
  };
  for (const std::uint32_t mover : movers_) look(mover, seen_from(mover, line, time));
  visit(line.position, line.at(line.duration), {radius, radius, radius},
        [&](std::uint32_t body) { return look(body, line); });
  return first == none ? std::nullopt : std::optional(first);
}

/// The distance of a convex body is convex along a segment: where it grows, the nearest point lies behind.
double Bodies::nearest_share(std::uint32_t body, const Vector& from, const Vector& to) const {
  double low = 0.0, high = 1.0;
  for (int halved = 0; halved < HALVINGS_OF_SHARE; halved++) {
    const double middle = 0.5 * (low + high);
    const Vector at = from + (to - from) * middle;
    (dot(at - near_to(body, at).point, to - from) >= 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

std::optional<double> Bodies::exit_along(const Vector& from, const Vector& direction, double time, double distance,
                                         double most) const {
  double along = 0.0;
  const auto gap = [&](std::uint32_t body) {
    const Vector at = from + direction * along - solid_velocity(body) * time;
    const Near near = near_to(body, at);
    return norm(at - near.point) - near.rounding;
  };
  const auto leave = [&](std::uint32_t body) {
    const double begin = along;
    for (double left = distance - gap(body); left > 0.0 && along <= most; left = distance - gap(body)) {
      along += std::max(left, LEAST_EXIT * distance);
    }
    return along == begin;
  };
  while (along <= most) {
    const Vector at = from + direction * along;
    const bool is_out = std::ranges::all_of(movers_, leave) && visit(at, at, {distance, distance, distance}, leave);
    if (is_out) return along;
  }
  return std::nullopt;
}

Bodies::Nearest Bodies::nearest(const Vector& at, double time, double most) const {
  Nearest found{most, -1};
  const auto look = [&](std::uint32_t body, const Vector& seen) {
    const Near near = near_to(body, seen);
    const double away = std::max(norm(seen - near.point) - near.rounding, 0.0);
    if (away < found.distance) found = {away, body};
    return true;
  };
  for (const std::uint32_t body : movers_) look(body, at - solids_[body].velocity * time);
  visit(at, at, {most, most, most}, [&](std::uint32_t body) { return look(body, at); });
  return found;
}

}  // namespace evenroad::flight
