#include "picture/painter.hpp"

#include <algorithm>
#include <limits>

#include "picture/nearest.hpp"

namespace evenroad::picture {

namespace {

/// Pixels are drawn this many times as large, then shrunk, so that edges are smooth.
constexpr std::size_t FINER = 2, SAMPLES = FINER * FINER;
/// Side of the shadow map [pixels], and depth below a surface that is certainly in its own shadow [m].
constexpr std::size_t SHADOW = 1024;
constexpr double BIAS = 0.006;
/// Offsets at which a point is compared with the shadow map, so that edges of shadows are soft [pixels].
constexpr std::array<std::array<double, 2>, 4> TAPS{{{-0.7, -1.9}, {1.9, -0.7}, {0.7, 1.9}, {-1.9, 0.7}}};
/// Distance of the lines on the floor, its size, and the distance at which it fades [m].
constexpr double TILE = 0.25, FAR = 40.0, FADES = 1.5, FADED = 4.5;
/// Largest 1 / depth that is drawn: nearer triangles may reach behind the camera.
constexpr double NEAREST = 900.0;

/// The shadow map of the light: a point lies in shadow if another surface is nearer to the light.
class Shadow {
 public:
  Shadow(const Studio& studio, const Triangles& triangles, std::size_t count)
      : axes_(studio.light), map_(SHADOW, SHADOW, -std::numeric_limits<float>::infinity()) {
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (std::size_t t = 0; t < count; t++) {
      for (std::size_t i = 0; i < 3; i++) {
        for (std::size_t axis = 0; axis < 2; axis++) {
          const double at = dot(axes_[axis], triangles.corner(t, i));
          low[axis] = std::min(low[axis], at), high[axis] = std::max(high[axis], at);
        }
      }
    }
    scale_ = static_cast<double>(SHADOW) / (std::max(high[0] - low[0], high[1] - low[1]) + 0.02);
    shift_ = {0.01 - low[0], 0.01 - low[1]};
    for (std::size_t t = 0; t < count; t++) {
      Flat flat;
      for (std::size_t i = 0; i < 3; i++) flat[i] = seen(triangles.corner(t, i));
      // For closed bodies, the faces towards the light suffice.
      if (triangles.closed[t] && area(flat) < 0.0) continue;
      map_.add(flat, 0);
    }
  }

  /// Return the share of the light, 0 to 1, that reaches a point.
  double light_at(Vector point) const {
    const Seen at = seen(point);
    const double last = static_cast<double>(SHADOW) - 3.0;
    if (!(at.column > 3.0 && at.row > 3.0 && at.column < last && at.row < last)) return 1.0;
    int reached = 0;
    for (const auto& [right, down] : TAPS) {
      const auto column = static_cast<std::size_t>(at.column + right), row = static_cast<std::size_t>(at.row + down);
      reached += map_.near[row * SHADOW + column] <= at.near + BIAS;
    }
    return 0.25 * reached;
  }

 private:
  Seen seen(Vector point) const {
    return {scale_ * (dot(axes_[0], point) + shift_[0]), scale_ * (dot(axes_[1], point) + shift_[1]),
            dot(axes_[2], point)};
  }

  std::array<Vector, 3> axes_;
  std::array<double, 2> shift_{};
  double scale_ = 1.0;
  Nearest map_;
};

/// A part of a picture, drawn larger: its first pixel, and its depth buffer.
struct Window {
  std::size_t column, row;
  Nearest found;

  std::size_t columns() const { return found.columns / FINER; }
  std::size_t rows() const { return found.rows / FINER; }

  /// Whether a pixel of the picture is in it.
  bool holds(std::size_t x, std::size_t y) const {
    return x >= column && y >= row && x < column + columns() && y < row + rows();
  }

  /// The positions of a pixel's samples.
  std::array<std::size_t, SAMPLES> samples(std::size_t x, std::size_t y) const {
    std::array<std::size_t, SAMPLES> samples_behind{};
    const std::size_t first = FINER * (y - row) * found.columns + FINER * (x - column);
    for (std::size_t i = 0; i < SAMPLES; i++) samples_behind[i] = first + i / FINER * found.columns + i % FINER;
    return samples_behind;
  }
};

/// The renderer of a picture: the projection of bodies, and the colours of pixels.
struct Painter {
  const Camera& camera;
  const Studio& studio;
  const Triangles& triangles;
  std::vector<Flat> flats;
  Shadow shadow;

  Painter(const Camera& camera, const Studio& studio, const Triangles& triangles, std::span<const Layer> layers)
      : camera(camera), studio(studio), triangles(triangles), shadow(studio, triangles, layers[0].end) {
    flats.reserve(triangles.closed.size());
    for (std::size_t t = 0; t < triangles.closed.size(); t++) {
      Flat flat;
      for (std::size_t i = 0; i < 3; i++) flat[i] = seen(triangles.corner(t, i));
      flats.push_back(flat);
    }
  }

  /// Return the depth buffer of some triangles, in their window.
  Window nearest(std::size_t first, std::size_t end) const;

  Vector body(std::size_t t, std::size_t column, std::size_t row, bool in_shadow) const;
  Vector background(std::size_t column, std::size_t row) const;

 private:
  Seen seen(Vector point) const {
    const Vector away = point - camera.eye;
    const double near = 1.0 / std::max(dot(camera.forward, away), 1e-3);
    const double pixels = static_cast<double>(FINER) * camera.scale * near;
    const auto half = [](std::size_t side) { return 0.5 * static_cast<double>(FINER * side); };
    return {half(camera.columns) + pixels * dot(camera.right, away), half(camera.rows) - pixels * dot(camera.up, away),
            near};
  }
};

Window Painter::nearest(std::size_t first, std::size_t end) const {
  const auto shown = [this](std::size_t t) {
    const Flat& flat = flats[t];
    const bool behind = std::any_of(flat.begin(), flat.end(), [](const Seen& each) { return each.near > NEAREST; });
    return !behind && !(triangles.closed[t] && area(flat) > 0.0);
  };
  double low[2] = {1e300, 1e300}, high[2] = {0.0, 0.0};
  for (std::size_t t = first; t < end; t++) {
    if (!shown(t)) continue;
    for (const Seen& each : flats[t]) {
      low[0] = std::min(low[0], each.column), high[0] = std::max(high[0], each.column);
      low[1] = std::min(low[1], each.row), high[1] = std::max(high[1], each.row);
    }
  }
  const auto pixel = [](double position, std::size_t most) {
    return static_cast<std::size_t>(std::clamp(position / static_cast<double>(FINER), 0.0, static_cast<double>(most)));
  };
  const std::size_t column = pixel(low[0], camera.columns), row = pixel(low[1], camera.rows);
  const std::size_t columns = std::max(pixel(high[0] + FINER, camera.columns), column) - column;
  const std::size_t rows = std::max(pixel(high[1] + FINER, camera.rows), row) - row;
  Window window{column, row, Nearest(FINER * columns, FINER * rows, 0.0F)};
  for (std::size_t t = first; t < end; t++) {
    if (!shown(t)) continue;
    Flat flat = flats[t];
    for (Seen& each : flat) {
      each.column -= static_cast<double>(FINER * column), each.row -= static_cast<double>(FINER * row);
    }
    window.found.add(flat, static_cast<std::int32_t>(t));
  }
  return window;
}

/// Return the colour of a triangle's point in the middle of a pixel, or the point of it that is nearest to there.
Vector Painter::body(std::size_t t, std::size_t column, std::size_t row, bool in_shadow) const {
  const Flat& flat = flats[t];
  const auto& [a, b, c] = flat;
  const double x = static_cast<double>(FINER) * (static_cast<double>(column) + 0.5) - a.column;
  const double y = static_cast<double>(FINER) * (static_cast<double>(row) + 0.5) - a.row;
  const double size = area(flat);
  double second = std::clamp((x * (c.row - a.row) - y * (c.column - a.column)) / size, 0.0, 1.0);
  double third = std::clamp(((b.column - a.column) * y - (b.row - a.row) * x) / size, 0.0, 1.0);
  const double more = std::max(second + third, 1.0);
  second /= more, third /= more;
  const double first = 1.0 - second - third;
  const auto between = [&](double p, double q, double r) { return first * p + second * q + third * r; };
  const Vector ray = camera.ray(between(a.column, b.column, c.column) / static_cast<double>(FINER),
                                between(a.row, b.row, c.row) / static_cast<double>(FINER));
  Vector normal = first * triangles.normal(t, 0) + second * triangles.normal(t, 1) + third * triangles.normal(t, 2);
  normal = 1.0 / std::max(length(normal), 1e-12) * normal;
  // A back face, such as the inside of an open mesh, is lit like its front.
  if (dot(normal, ray) > 0.0) normal = -1.0 * normal;
  const Vector towards = studio.light[2], half = towards - 1.0 / length(ray) * ray;
  const double glance = std::max(dot(normal, half), 0.0) / std::max(length(half), 1e-12);
  const double to_fourth = glance * glance * glance * glance, to_eighth = to_fourth * to_fourth;
  const double to_sixteenth = to_eighth * to_eighth;
  double lit = std::max(dot(normal, towards), 0.0), shine = to_sixteenth * to_sixteenth * to_eighth;
  if (in_shadow) {
    const Vector point = camera.eye + 1.0 / between(a.near, b.near, c.near) * ray;
    const double reached = shadow.light_at(point + 0.004 * normal);
    lit *= reached, shine *= reached;
  }
  return (0.52 + 0.14 * normal.z + 0.48 * lit) * triangles.colour(t) + 60.0 * shine * Vector{1.0, 1.0, 1.0};
}

/// Return the colour of the background: the floor with its lines, or the sky.
Vector Painter::background(std::size_t column, std::size_t row) const {
  const Vector ray = camera.ray(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
  const double away = (studio.floor - camera.eye.z) / ray.z;
  if (!(away > 0.0 && away < FAR)) {
    const double high = std::clamp(2.5 * ray.z / length(ray), 0.0, 1.0);
    return studio.horizon + high * (studio.sky - studio.horizon);
  }
  const Vector point = camera.eye + away * ray, off = point - studio.middle;
  const auto off_line = [](double at) { return TILE * std::abs(at / TILE - std::rint(at / TILE)); };
  const double pixel = away * length(ray) / camera.scale;
  const double line = std::clamp(1.5 - std::min(off_line(point.x), off_line(point.y)) / (0.8 * pixel), 0.0, 1.0);
  const double fade = std::clamp((std::sqrt(off.x * off.x + off.y * off.y) - FADES) / (FADED - FADES), 0.0, 1.0);
  const Vector tiles = studio.ground + line * (studio.lines - studio.ground);
  return (0.72 + 0.28 * shadow.light_at(point)) * (tiles + fade * (studio.horizon - tiles));
}

/// Return the colour of a pixel: the mean of its samples, with each triangle shaded once.
Vector solid_pixel(const Painter& painter, const Window& solid, std::size_t column, std::size_t row) {
  if (!solid.holds(column, row)) return painter.background(column, row);
  std::array<std::int32_t, SAMPLES> owner{};
  const auto samples = solid.samples(column, row);
  for (std::size_t i = 0; i < SAMPLES; i++) owner[i] = solid.found.owner[samples[i]];
  std::sort(owner.begin(), owner.end());
  Vector sum{0.0, 0.0, 0.0};
  for (std::size_t i = 0, next = 0; i < SAMPLES; i = next) {
    while (next < SAMPLES && owner[next] == owner[i]) next++;
    const Vector colour = owner[i] < 0 ? painter.background(column, row)
                                       : painter.body(static_cast<std::size_t>(owner[i]), column, row, true);
    sum = sum + static_cast<double>(next - i) * colour;
  }
  return 1.0 / static_cast<double>(SAMPLES) * sum;
}

/// Return a pixel with a translucent layer over it.
Vector drawn_over(Vector below, const Painter& painter, const Layer& layer, const Window& ours, const Window& solid,
                  std::size_t column, std::size_t row) {
  double share = 0.0;
  std::int32_t owner = -1;
  const auto samples = ours.samples(column, row);
  const bool before = solid.holds(column, row);
  const std::size_t see_through = painter.triangles.see_through;
  const auto samples_behind = before ? solid.samples(column, row) : samples;
  for (std::size_t i = 0; i < SAMPLES; i++) {
    if (ours.found.owner[samples[i]] < 0) continue;
    owner = ours.found.owner[samples[i]];
    // A ghost may coincide with its body, so it is seen only if it is nearer by half a percent.
    const bool seen = !before || ours.found.near[samples[i]] >= 1.005F * solid.found.near[samples_behind[i]];
    const bool through = before && solid.found.owner[samples_behind[i]] >= static_cast<std::int32_t>(see_through);
    share += layer.opacity * (seen ? 1.0 : through ? layer.hidden : 0.0);
  }
  if (share == 0.0) return below;
  share /= static_cast<double>(SAMPLES);
  return share * painter.body(static_cast<std::size_t>(owner), column, row, false) + (1.0 - share) * below;
}

}  // namespace

std::vector<std::uint8_t> paint(const Camera& camera, const Studio& studio, const Triangles& triangles,
                                std::span<const Layer> layers) {
  const Painter painter(camera, studio, triangles, layers);
  const Window solid = painter.nearest(0, layers[0].end);
  std::vector<Vector> picture;
  picture.reserve(camera.columns * camera.rows);
  for (std::size_t row = 0; row < camera.rows; row++) {
    for (std::size_t column = 0; column < camera.columns; column++) {
      picture.push_back(solid_pixel(painter, solid, column, row));
    }
  }
  for (std::size_t i = 1; i < layers.size(); i++) {
    const Window ours = painter.nearest(layers[i - 1].end, layers[i].end);
    for (std::size_t row = ours.row; row < ours.row + ours.rows(); row++) {
      for (std::size_t column = ours.column; column < ours.column + ours.columns(); column++) {
        Vector& pixel = picture[row * camera.columns + column];
        pixel = drawn_over(pixel, painter, layers[i], ours, solid, column, row);
      }
    }
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * picture.size());
  for (const Vector& colour : picture) {
    for (const double part : {colour.x, colour.y, colour.z}) {
      // NaN becomes black.
      bytes.push_back(static_cast<std::uint8_t>(part > 0.0 ? std::min(part, 255.0) : 0.0));
    }
  }
  return bytes;
}

}  // namespace evenroad::picture
