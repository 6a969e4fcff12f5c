// Forward kinematics of sixteen configurations.  Angles are reduced in double precision; the rest is single.
#include "robot/placed_robot.hpp"

#include <cmath>
#include <numbers>

namespace evenroad::robot {

namespace {

constexpr float PI = static_cast<float>(std::numbers::pi), HALF_PI = static_cast<float>(0.5 * std::numbers::pi);

/// x + S3 x^3 + ... nearest to sin x on [-pi/2, pi/2] in the largest error (by Lawson's reweighted least squares,
/// 1961): 1.7e-8.  Taylor's series errs by 1e-4 there.
constexpr float S3 = -0.16666657096F, S5 = 0.0083330172914F, S7 = -0.00019806615190F, S9 = 2.6000547418e-06F;

EVENROAD_INLINE Floats16 sine_within_a_quarter(Floats16 angle) {
  const Floats16 square = angle * angle;
  const Floats16 series = fma(square, fma(square, fma(square, spread(S9), spread(S7)), spread(S5)), spread(S3));
  return fma(angle * square, series, angle);
}

struct SineAndCosine {
  Floats16 sine, cosine;
};

/// Return sine and cosine of angles from -pi to pi, to 2e-7.
EVENROAD_INLINE SineAndCosine sine_and_cosine(Floats16 angle) {
  const Floats16 size = abs(angle);
  // sin x = sin(pi - x); cos x = sin(pi/2 - |x|).
  return {with_sign_of(sine_within_a_quarter(min(PI - size, size)), angle), sine_within_a_quarter(HALF_PI - size)};
}

EVENROAD_INLINE Doubles16 rounded(Doubles16 a) {
#if defined(__AVX512F__)
  __m512d half[2];
  __builtin_memcpy(half, &a, sizeof a);
  for (__m512d& each : half) each = _mm512_roundscale_pd(each, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  __builtin_memcpy(&a, half, sizeof a);
#else
  for (int lane = 0; lane < LANES; lane++) a[lane] = __builtin_rint(a[lane]);
#endif
  return a;
}

/// Return values of a frame.  Single precision has no digits for a large angle, so whole turns are subtracted before.
EVENROAD_INLINE Floats16 values_of(const Frame& frame, const Doubles16& coordinate) {
  Doubles16 value = coordinate * frame.multiplier + frame.offset;
  if (!frame.slides) value = value - (2.0 * std::numbers::pi) * rounded(value * (0.5 / std::numbers::pi));
  return __builtin_convertvector(value, Floats16);
}

void write_frames(const Robot& robot, std::span<const Doubles16> states, std::vector<PlacedFrame>& frames) {
  for (std::size_t i = 0; i < robot.frames.size(); i++) {
    const Frame& frame = robot.frames[i];
    const PlacedFrame& below = frames[frame.parent];
    PlacedFrame& here = frames[i + 1];
    const Floats16 value = values_of(frame, states[frame.coordinate]);
    const SineAndCosine angle = sine_and_cosine(value);
    const float* r = frame.rotation;
    here.origin = below.origin + below.turned(spread(frame.translation));
    for (int row = 0; row < 3; row++) {
      const Vec3x16 from = below.rows[row];
      const Floats16 x = dot(from, spread(Vec3{r[0], r[3], r[6]})), y = dot(from, spread(Vec3{r[1], r[4], r[7]}));
      const Floats16 z = dot(from, spread(Vec3{r[2], r[5], r[8]}));
      if (frame.slides) {
        here.rows[row] = {x, y, z};
        Floats16& along = row == 0 ? here.origin.x : row == 1 ? here.origin.y : here.origin.z;
        along = fma(z, value, along);
      } else {
        here.rows[row] = {fma(x, angle.cosine, y * angle.sine), fma(y, angle.cosine, -(x * angle.sine)), z};
      }
    }
  }
}

/// Return half the extents of the box around a turned one.
EVENROAD_INLINE Vec3x16 box_around(const PlacedFrame& frame, Vec3 extents) {
  const Vec3x16 half = spread(extents);
  return {dot(abs(frame.rows[0]), half), dot(abs(frame.rows[1]), half), dot(abs(frame.rows[2]), half)};
}

void write_bodies(const Robot& robot, const Lengths& lengths, Range bodies, PlacedRobot& placed) {
  for (int b = bodies.first; b < bodies.end; b++) {
    const Body& body = robot.bodies[b];
    const PlacedFrame frame = placed.frames[body.frame];
    PlacedBody& here = placed.bodies[b];
    here.centre = frame.origin + frame.turned(spread(body.centre));
    if (body.capsules.size() > FEW) here.half = box_around(frame, lengths.bodies[b].half);
    for (int i = body.capsules.first; i < body.capsules.end; i++) {
      const Capsule& capsule = robot.capsules[i];
      placed.capsules[i].centre = frame.origin + frame.turned(spread(capsule.centre));
      if (!capsule.is_ball) placed.capsules[i].half = frame.turned(spread(capsule.half));
    }
  }
}

}  // namespace

PlacedRobot::PlacedRobot(const Robot& robot)
    : frames(robot.frames.size() + 1), bodies(robot.bodies.size()), capsules(robot.capsules.size()) {
  const Floats16 one = spread(1.0F), zero{};
  frames[0] = {{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}, {zero, zero, zero}};
  write_bodies(robot, robot.lengths, {0, robot.fixed_bodies}, *this);
}

void PlacedRobot::move_to(const Robot& robot, const Lengths& lengths, std::span<const Doubles16> states) {
  write_frames(robot, states, frames);
  write_bodies(robot, lengths, {robot.fixed_bodies, static_cast<int>(robot.bodies.size())}, *this);
}

void PlacedRobot::write_boxes(const Robot& robot, const Lengths& lengths) {
  for (std::size_t b = robot.fixed_bodies; b < robot.bodies.size(); b++) {
    const Body& body = robot.bodies[b];
    if (body.capsules.size() > FEW) bodies[b].half = box_around(frames[body.frame], lengths.bodies[b].half);
  }
}

}  // namespace evenroad::robot
