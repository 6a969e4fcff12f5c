// A robot's tables from named arrays: bodies, pairs of capsules, and lengths enlarged by the error of single precision.
#include "robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace evenroad::robot {

namespace {

constexpr double LEAST_SQUARED_LENGTH = 1e-30;  // lower bound of a squared length that is a divisor [m^2]

/// A number of something, within 0 and `count`.
int index(std::int64_t value, std::size_t count, const char* name) {
  if (value < 0 || value >= static_cast<std::int64_t>(count)) {
    throw std::invalid_argument(std::string(name) + " must be below " + std::to_string(count) + ", got " +
                                std::to_string(value));
  }
  return static_cast<int>(value);
}

/// Return which rows belong to a number.
Range range(std::span<const std::int64_t> first, std::size_t number, std::size_t count, const char* name) {
  if (first[number] < 0 || first[number] > first[number + 1] || first[number + 1] > static_cast<std::int64_t>(count)) {
    throw std::invalid_argument(std::string(name) + " must rise, up to " + std::to_string(count));
  }
  return {static_cast<int>(first[number]), static_cast<int>(first[number + 1])};
}

void require(bool holds, const char* text) {
  if (!holds) throw std::invalid_argument(text);
}

Vec3 single(const double* v) { return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}; }

double length_of_three(const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

std::vector<Frame> make_frames(const GivenRobot& given, std::size_t dim) {
  const auto& from = given.frames;
  const std::size_t count = from.parent.size();
  require(from.coordinate.size() == count && from.slides.size() == count && from.multiplier.size() == count &&
              from.offset.size() == count && from.rotation.size() == 9 * count && from.translation.size() == 3 * count,
          "arrays of frames must be equally long");
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < count; i++) {
    Frame frame{index(from.parent[i], i + 1, "frames.parent"),
                index(from.coordinate[i], dim, "frames.coordinate"),
                from.slides[i],
                from.multiplier[i],
                from.offset[i],
                {},
                single(from.translation.data() + 3 * i)};
    for (int entry = 0; entry < 9; entry++) frame.rotation[entry] = static_cast<float>(from.rotation[9 * i + entry]);
    frames.push_back(frame);
  }
  return frames;
}

/// The capsules of a robot in double precision.
struct Shapes {
  const GivenRobot& given;

  const double* centre(int i) const { return given.capsules.centre.data() + 3 * i; }
  const double* half(int i) const { return given.capsules.half.data() + 3 * i; }
  double radius(int i) const { return given.capsules.radius[i]; }
  double covering(int i) const { return given.capsules.covering[i] + given.capsules.padding[i]; }
  Range samples(int i) const {
    const auto& first = given.capsules.first_sample;
    return {static_cast<int>(first[i]), static_cast<int>(first[i + 1])};
  }
};

struct Ball {
  double centre[3], radius;
};

/// Return a ball that holds capsules: around the middle of their box.
Ball ball_around(const Shapes& shapes, Range capsules) {
  Ball ball{};
  for (int axis = 0; axis < 3; axis++) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int i = capsules.first; i < capsules.end; i++) {
      for (double end :
           {shapes.centre(i)[axis] - shapes.half(i)[axis], shapes.centre(i)[axis] + shapes.half(i)[axis]}) {
        low = std::min(low, end - shapes.radius(i)), high = std::max(high, end + shapes.radius(i));
      }
    }
    ball.centre[axis] = 0.5 * (low + high);
  }
  for (int i = capsules.first; i < capsules.end; i++) {
    for (double side : {-1.0, 1.0}) {
      double offset[3];
      for (int axis = 0; axis < 3; axis++) {
        offset[axis] = shapes.centre(i)[axis] + side * shapes.half(i)[axis] - ball.centre[axis];
      }
      ball.radius = std::max(ball.radius, length_of_three(offset) + shapes.radius(i));
    }
  }
  return ball;
}

/// Return half extents of a box about a centre that holds the spheres that cover capsules, wider by `more`.
Vec3 half_extents(const Shapes& shapes, Range capsules, const double* centre, double more) {
  double half[3] = {0, 0, 0};
  for (int i = capsules.first; i < capsules.end; i++) {
    const Range samples = shapes.samples(i);
    for (int sample = samples.first; sample < samples.end; sample++) {
      const double share = shapes.given.capsules.samples[sample];
      for (int axis = 0; axis < 3; axis++) {
        const double away = std::abs(shapes.centre(i)[axis] + share * shapes.half(i)[axis] - centre[axis]);
        half[axis] = std::max(half[axis], away + shapes.covering(i));
      }
    }
  }
  for (double& each : half) each += more;
  return single(half);
}

void add_capsules(Robot& robot, const GivenRobot& given) {
  const auto& from = given.capsules;
  const std::size_t count = from.body.size();
  require(from.first_sample.size() == count + 1 && from.centre.size() == 3 * count && from.half.size() == 3 * count &&
              from.radius.size() == count && from.covering.size() == count && from.padding.size() == count,
          "arrays of capsules must be equally long");
  for (double share : from.samples) robot.samples.push_back(static_cast<float>(share));
  robot.samples.resize(robot.samples.size() + LANES);
  for (std::size_t i = 0; i < count; i++) {
    require(from.first_sample[i] >= 0 && from.first_sample[i] < from.first_sample[i + 1] &&
                from.first_sample[i + 1] <= static_cast<std::int64_t>(from.samples.size()),
            "capsules.first_sample must rise, within capsules.samples");
    const Vec3 half = single(from.half.data() + 3 * i);
    const double length = length_of_three(from.half.data() + 3 * i);
    robot.capsules.push_back({static_cast<int>(from.body[i]), single(from.centre.data() + 3 * i), half,
                              half.x == 0 && half.y == 0 && half.z == 0, Shapes{given}.samples(static_cast<int>(i)),
                              static_cast<float>(length),
                              static_cast<float>(1.0 / std::max(length * length, LEAST_SQUARED_LENGTH)),
                              static_cast<float>(from.covering[i] - from.radius[i])});
    robot.lengths.capsules.push_back(static_cast<float>(Shapes{given}.covering(static_cast<int>(i)) + given.padding));
  }
}

void add_fixed_spheres(Robot& robot, const GivenRobot& given) {
  const Shapes shapes{given};
  for (int i = 0; i < robot.fixed_capsules(); i++) {
    for (int sample = robot.capsules[i].samples.first; sample < robot.capsules[i].samples.end; sample++) {
      FixedSphere sphere{i, {}, shapes.covering(i)};
      for (int axis = 0; axis < 3; axis++) {
        sphere.centre[axis] = shapes.centre(i)[axis] + given.capsules.samples[sample] * shapes.half(i)[axis];
      }
      robot.fixed_spheres.push_back(sphere);
    }
  }
}

std::vector<Ball> add_bodies(Robot& robot, const GivenRobot& given) {
  const std::size_t count = given.bodies.frame.size();
  const std::vector<int> roots = add_trees(robot.hulls, given.hulls);
  require(given.bodies.hulls.size() == count, "bodies.hulls must be as long as bodies.frame");
  std::vector<Ball> balls;
  int capsule = 0;
  for (std::size_t b = 0; b < count; b++) {
    Body body;
    body.frame = index(given.bodies.frame[b], robot.frames.size() + 1, "bodies.frame");
    body.capsules.first = capsule;
    if (given.bodies.hulls[b] >= 0) body.hulls = roots[index(given.bodies.hulls[b], roots.size(), "bodies.hulls")];
    const auto& owner = given.capsules.body;
    while (capsule < static_cast<int>(owner.size()) && owner[capsule] == static_cast<std::int64_t>(b)) capsule++;
    body.capsules.end = capsule;
    require(body.capsules.size() > 0, "capsules.body must rise by one from 0 and name every body");
    const bool fixed = body.frame == 0;
    require(!fixed || robot.fixed_bodies == static_cast<int>(b), "bodies that do not move must come first");
    robot.fixed_bodies += fixed;
    const Ball ball = ball_around({given}, body.capsules);
    body.centre = single(ball.centre);
    // Boxes are wider by twice the padding, so that they do not miss contacts of the spheres, which are wider by one.
    robot.lengths.bodies.push_back({static_cast<float>(ball.radius + given.padding),
                                    half_extents({given}, body.capsules, ball.centre, 2.0 * given.padding)});
    robot.bodies.push_back(body);
    balls.push_back(ball);
  }
  require(capsule == static_cast<int>(given.capsules.body.size()), "capsules.body must name bodies");
  return balls;
}

void add_shapes(Robot& robot, const GivenRobot& given) {
  const auto& [owner, parts, around, inside] = given.shapes;
  require(owner.size() == parts.widths.size() && owner.size() == parts.enclosing.size(),
          "shapes.body must be as long as shapes.widths and shapes.enclosing");
  for (int first = 0, end = 0; first < static_cast<int>(owner.size()); first = end) {
    Body& body = robot.bodies[index(owner[first], robot.bodies.size(), "shapes.body")];
    while (end < static_cast<int>(owner.size()) && owner[end] == owner[first]) {
      body.encloses |= parts.enclosing[end];
      end++;
    }
    require(body.shape < 0, "shapes.body must rise");
    body.shape = add_parts(robot.shapes, parts, {first, end});
    body.points = points_of_parts(robot.shapes, body.shape);
  }
  const std::size_t bodies = robot.bodies.size();
  require(inside.rows.size() % 4 == 0, "shapes.inside must have four columns");
  require(
      around.first_point.size() == bodies + 1 && around.widths.size() == bodies && inside.first.size() == bodies + 1,
      "what is around and inside of shapes must be given for each body");
  for (std::size_t b = 0; b < bodies; b++) {
    Body& body = robot.bodies[b];
    const Range points = range(around.first_point, b, around.points.size() / 3, "shapes.around_first");
    body.inside = range(inside.first, b, inside.rows.size() / 4, "shapes.inside_first");
    if (body.shape >= 0 && points.size() > 0)
      add_around(robot.shapes, body.shape, around.points, points, around.widths[b]);
  }
  for (std::size_t i = 0; 4 * i < inside.rows.size(); i++) {
    robot.inside.push_back({single(inside.rows.data() + 4 * i), static_cast<float>(inside.rows[4 * i + 3])});
  }
  for (const Body& body : robot.bodies) {
    const double padding = given.capsules.padding[body.capsules.first];
    robot.lengths.shapes.push_back(static_cast<float>(padding + given.padding));
  }
}

void add_pairs(Robot& robot, const GivenRobot& given, const std::vector<Ball>& balls) {
  const Shapes shapes{given};
  require(given.pairs.bodies.size() % 2 == 0, "pairs.bodies must have two columns");
  for (std::size_t p = 0; 2 * p < given.pairs.bodies.size(); p++) {
    const int a = index(given.pairs.bodies[2 * p], balls.size(), "pairs.bodies");
    const int b = index(given.pairs.bodies[2 * p + 1], balls.size(), "pairs.bodies");
    const Range first = robot.bodies[a].capsules, second = robot.bodies[b].capsules;
    const int begin = static_cast<int>(robot.pairs.size());
    for (int i = first.first; i < first.end; i++) {
      for (int k = second.first; k < second.end; k++) {
        const double e = length_of_three(shapes.half(i)), f = length_of_three(shapes.half(k));
        const double reach = shapes.radius(i) + shapes.radius(k) + 2.0 * given.padding;
        const auto one_by = [](double square) { return static_cast<float>(square > 0.0 ? 1.0 / square : 0.0); };
        robot.pairs.push_back({i, k, one_by(e * e), one_by(f * f)});
        robot.lengths.pairs.push_back({static_cast<float>(reach + e + f), static_cast<float>(reach)});
      }
    }
    robot.body_pairs.push_back({a, b, {begin, static_cast<int>(robot.pairs.size())}});
    robot.lengths.body_pairs.push_back(static_cast<float>(balls[a].radius + balls[b].radius + 2.0 * given.padding));
  }
  require(0 <= given.pairs.by_hulls && given.pairs.by_hulls <= static_cast<std::int64_t>(robot.body_pairs.size()),
          "pairs.by_hulls must be a number of pairs");
  robot.hull_pairs = static_cast<int>(given.pairs.by_hulls);
  robot.lengths.hull_margins.assign(robot.hull_pairs, static_cast<float>(2.0 * given.padding));
  for (std::size_t p = robot.first_hull_pair(); p < robot.body_pairs.size(); p++) {
    const BodyPair& pair = robot.body_pairs[p];
    require(robot.bodies[pair.first].hulls >= 0 && robot.bodies[pair.second].hulls >= 0,
            "bodies of pairs that hulls decide must have hulls");
  }
}

OwnMatrix<double> matrix(std::span<const double> from, std::size_t rows, std::size_t columns, const char* text) {
  require(from.size() == rows * columns, text);
  OwnMatrix<double> made(rows, columns);
  std::copy(from.begin(), from.end(), made.values.begin());
  return made;
}

}  // namespace

Lengths Lengths::enlarged(float margin) const {
  Lengths more = *this;
  for (float& radius : more.capsules) radius += margin;
  for (float& near : more.shapes) near += margin;
  for (BodyLengths& body : more.bodies) {
    for (float* length : {&body.radius, &body.half.x, &body.half.y, &body.half.z}) *length += margin;
  }
  return more;
}

Robot make_robot(const GivenRobot& given) {
  Robot robot;
  const std::size_t dim = given.bounds.size() / 3;
  require(dim > 0 && given.bounds.size() == 3 * dim, "bounds must have three rows: low, high and period");
  const auto row = [&](int i) {
    const auto part = given.bounds.subspan(i * dim, dim);
    return std::vector<double>(part.begin(), part.end());
  };
  robot.joints = {row(0), row(1), row(2)};
  robot.padding = given.padding, robot.reach = given.reach;
  robot.frames = make_frames(given, dim);
  add_capsules(robot, given);
  add_pairs(robot, given, add_bodies(robot, given));
  add_shapes(robot, given);
  add_fixed_spheres(robot, given);
  const std::size_t pairs = robot.pairs.size() + robot.hull_pairs;
  robot.arms = matrix(given.arms.capsules, dim, robot.capsules.size(), "arms.capsules must be (dim, capsules)");
  robot.shape_arms = matrix(given.arms.shapes, dim, robot.bodies.size(), "arms.shapes must be (dim, bodies)");
  robot.pair_arms = matrix(given.arms.pairs, dim, pairs, "arms.pairs must be (dim, pairs of capsules and by hulls)");
  return robot;
}

}  // namespace evenroad::robot
