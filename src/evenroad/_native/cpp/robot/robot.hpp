// A robot in the form of checks: frames that joints move, bodies of capsules on them, pairs that may touch, and hulls.
//
// Frame 0 is the root link's, which does not move.  Every other frame turns about, or slides along, its z axis.  A body
// is a link with capsules.  Bodies of frame 0 come first, and the capsules of a body are consecutive.  If a capsule
// touches an obstacle, the true shape of its body decides, if it is known.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/float16.hpp"
#include "common/matrix.hpp"
#include "robot/hull_tree.hpp"
#include "robot/joints.hpp"

namespace evenroad::robot {

struct Frame {
  int parent, coordinate;
  bool slides;
  double multiplier, offset;  // its value is multiplier * coordinate + offset
  float rotation[9];          // row by row, to the parent frame
  Vec3 translation;
};

struct Capsule {
  int body;
  Vec3 centre, half;  // middle of its segment, and the vector from there to an endpoint
  bool is_ball;
  Range samples;                      // of the spheres that cover it, in Robot::samples
  float half_length, one_by_squared;  // of the segment: half its length, one over the square of that
  float slack;                        // excess of the spheres over the capsule
};

struct Body {
  int frame;
  Range capsules;
  Vec3 centre;               // of a ball and of a box around its capsules
  int hulls = -1;            // root of its tree of hulls, or -1
  int shape = -1;            // root of the parts of its true shape, or -1 if that is its capsules
  bool encloses = false;     // whether surfaces of the shape have an inside
  std::vector<Vec3> points;  // one point of each connected part of the shape
  Range inside;              // of the balls inside its true shape
};

/// A ball in the frame of a body.
struct Ball {
  Vec3 centre;
  float radius;
};

struct CapsulePair {
  int first, second;
  float one_by_ee, one_by_ff;  // one over the squared half lengths, 0 for balls
};

struct BodyPair {
  int first, second;
  Range pairs;  // of capsules: those of one capsule of the first body with all of the second follow each other
};

struct BodyLengths {
  float radius;  // of a ball around the capsules
  Vec3 half;     // of a box around the spheres that cover them, in the frame
};

struct PairLengths {
  float near;   // centres farther apart than this cannot touch
  float reach;  // sum of radii
};

/// All lengths that a check uses.  For larger bodies, only these change.
struct Lengths {
  std::vector<float> capsules;  // radii of covering spheres
  std::vector<BodyLengths> bodies;
  std::vector<PairLengths> pairs;
  std::vector<float> body_pairs;    // centres of balls around bodies farther apart than this: none of them touch
  std::vector<float> hull_margins;  // hulls nearer than this count as touching
  std::vector<float> shapes;        // of bodies: true shapes nearer than this to an obstacle touch it
  bool shapes_decide = true;        // if they are known; else capsules alone decide

  /// Bodies larger by a margin for obstacles; distances between bodies do not change.
  Lengths enlarged(float margin) const;
};

/// A sphere over a capsule that does not move, in double precision.
struct FixedSphere {
  int capsule;
  double centre[3], radius;
};

struct Robot {
  Joints joints;
  std::vector<Frame> frames;  // parents first; without the root's
  std::vector<Capsule> capsules;
  std::vector<float> samples;  // along segments, from -1 to 1; behind them sixteen more can be read
  std::vector<Body> bodies;
  std::vector<BodyPair> body_pairs;  // the last ones are decided by hulls
  std::vector<CapsulePair> pairs;
  HullTree<float> hulls, shapes;
  std::vector<Ball> inside;  // of true shapes
  Lengths lengths;
  OwnMatrix<double> arms{0, 0};        // (dim, capsules): largest speed of a capsule by a coordinate [m/rad]
  OwnMatrix<double> pair_arms{0, 0};   // (dim, pairs, then pairs by hulls): the two against each other
  OwnMatrix<double> shape_arms{0, 0};  // (dim, bodies): the farthest corner of a true shape
  std::vector<FixedSphere> fixed_spheres;
  int fixed_bodies = 0;
  int hull_pairs = 0;
  double padding = 0;  // enlargement of radii, so that rounding frees no contact
  double reach = 0;    // no point is ever farther from the root's origin

  int dim() const { return static_cast<int>(joints.size()); }
  int fixed_capsules() const { return fixed_bodies == 0 ? 0 : bodies[fixed_bodies - 1].capsules.end; }
  int first_hull_pair() const { return static_cast<int>(body_pairs.size()) - hull_pairs; }
};

/// The arrays of a robot, with the names of Python; sizes in metres, without padding.
struct GivenRobot {
  struct {
    std::span<const std::int64_t> parent, coordinate;
    std::span<const bool> slides;
    std::span<const double> multiplier, offset, rotation, translation;
  } frames;
  struct {
    std::span<const std::int64_t> frame, hulls;
  } bodies;
  struct {
    std::span<const std::int64_t> body, first_sample;
    std::span<const double> centre, half, radius, covering, samples;
    std::span<const double> padding;  // enlargement of each for obstacles
  } capsules;
  struct {
    std::span<const std::int64_t> bodies;
    std::int64_t by_hulls;
  } pairs;
  GivenHulls hulls;
  struct {
    std::span<const std::int64_t> body;  // of each part, ascending
    GivenParts parts;
    struct {
      std::span<const std::int64_t> first_point;  // of each body, then the number of points
      std::span<const double> points, widths;
    } around;  // by bodies: all parts lie within a width of the hull of some points, if there are any
    struct {
      std::span<const std::int64_t> first;
      std::span<const double> rows;  // (balls, 4): centre, radius
    } inside;                        // by bodies: balls that lie within the shape
  } shapes;
  struct {
    std::span<const double> capsules, pairs, shapes;
  } arms;
  std::span<const double> bounds;  // low, high, period
  double padding = 0, reach = 0;
};

/// Return a robot; std::invalid_argument if an index is out of range or sizes do not fit.
Robot make_robot(const GivenRobot& given);

}  // namespace evenroad::robot
