// Sixteen floats, and sixteen vectors of three: functions beyond the operators of the compiler's vector types.
#pragma once

#include "common/lanes.hpp"

namespace evenroad {

constexpr std::uint32_t ALL_LANES = (1U << LANES) - 1;
/// Lower bound of a squared length that is a divisor.
constexpr float LEAST_SQUARE = 1e-30F;

EVENROAD_INLINE Floats16 spread(float number) { return all<Floats16>(number); }

EVENROAD_INLINE Floats16 sqrt(Floats16 a) {
#if defined(__AVX512F__)
  return (Floats16)_mm512_sqrt_ps((__m512)a);
#else
  for (int lane = 0; lane < LANES; lane++) a[lane] = __builtin_sqrtf(a[lane]);
  return a;
#endif
}

/// Return the largest of all lanes.
EVENROAD_INLINE float largest(Floats16 a) {
  a = max(a, __builtin_shufflevector(a, a, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7));
  a = max(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  a = max(a, __builtin_shufflevector(a, a, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  a = max(a, __builtin_shufflevector(a, a, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
  return a[0];
}

/// Return `value` clipped to the range from `least` to `most`.
EVENROAD_INLINE Floats16 clamp(Floats16 value, Floats16 least, Floats16 most) { return max(min(value, most), least); }

/// Return numbers `size` >= 0 with the signs of `sign`.
EVENROAD_INLINE Floats16 with_sign_of(Floats16 size, Floats16 sign) {
  const Ints16 bit = Ints16{} + INT32_MIN;
  return (Floats16)((Ints16)size | ((Ints16)sign & bit));
}

/// Three coordinates of one point or direction.
struct Vec3 {
  float x = 0, y = 0, z = 0;
};

/// Three coordinates of sixteen.
struct Vec3x16 {
  Floats16 x, y, z;
};

EVENROAD_INLINE Vec3 lane_of(const Vec3x16& v, int lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }
EVENROAD_INLINE Vec3x16 spread(Vec3 v) { return {spread(v.x), spread(v.y), spread(v.z)}; }
EVENROAD_INLINE Vec3x16 spread3(const float* v) { return spread(Vec3{v[0], v[1], v[2]}); }
EVENROAD_INLINE Vec3x16 operator+(Vec3x16 a, Vec3x16 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
EVENROAD_INLINE Vec3x16 operator-(Vec3x16 a, Vec3x16 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
EVENROAD_INLINE Vec3x16 operator-(Vec3x16 a) { return {-a.x, -a.y, -a.z}; }
EVENROAD_INLINE Vec3x16 operator*(Vec3x16 a, Floats16 s) { return {a.x * s, a.y * s, a.z * s}; }
EVENROAD_INLINE Vec3x16 operator/(Vec3x16 a, Floats16 s) { return {a.x / s, a.y / s, a.z / s}; }
EVENROAD_INLINE Vec3x16 abs(Vec3x16 a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
EVENROAD_INLINE Floats16 largest(Vec3x16 a) { return max(max(a.x, a.y), a.z); }

EVENROAD_INLINE Floats16 dot(Vec3x16 a, Vec3x16 b) { return fma(a.z, b.z, fma(a.x, b.x, a.y * b.y)); }

/// Return a + b s and a - b s.
EVENROAD_INLINE Vec3x16 plus(Vec3x16 a, Vec3x16 b, Floats16 s) {
  return {fma(b.x, s, a.x), fma(b.y, s, a.y), fma(b.z, s, a.z)};
}
EVENROAD_INLINE Vec3x16 minus(Vec3x16 a, Vec3x16 b, Floats16 s) { return plus(a, b, -s); }

/// Return a x + b y + c z.
EVENROAD_INLINE Vec3x16 combine(Vec3x16 a, Floats16 x, Vec3x16 b, Floats16 y, Vec3x16 c, Floats16 z) {
  return plus(plus(b * y, a, x), c, z);
}

EVENROAD_INLINE Vec3x16 cross(Vec3x16 a, Vec3x16 b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

/// Return `first` where a < b, else `second`.
EVENROAD_INLINE Vec3x16 where_less(Floats16 a, Floats16 b, Vec3x16 first, Vec3x16 second) {
  const auto less = a < b;
  return {less ? first.x : second.x, less ? first.y : second.y, less ? first.z : second.z};
}

/// A box along the axes.
struct Box16 {
  Vec3x16 centre, half;
};

namespace detail {

template <int Width>
EVENROAD_INLINE Floats16 halve(Floats16 a, Floats16 b) {
  Floats16 even{}, odd{};
  if constexpr (Width == 8) {
    even = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23);
    odd = __builtin_shufflevector(a, b, 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31);
  } else if constexpr (Width == 4) {
    even = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27);
    odd = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31);
  } else if constexpr (Width == 2) {
    even = __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21, 24, 25, 28, 29);
    odd = __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15, 18, 19, 22, 23, 26, 27, 30, 31);
  } else {
    even = __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    odd = __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  }
  return min(even, odd);
}

}  // namespace detail

/// Return, in all lanes, the box around the sixteen boxes of the lanes.
EVENROAD_INLINE Box16 around_all(Vec3x16 centre, Vec3x16 half) {
  const Vec3x16 low = centre - half, minus_high = -(centre + half);
  // Pairs of values share a vector, then four, then all six: a quarter of the steps of six minima over lanes.
  const Floats16 a = detail::halve<8>(low.x, low.y), b = detail::halve<8>(low.z, minus_high.x);
  const Floats16 c = detail::halve<8>(minus_high.y, minus_high.z), d = detail::halve<8>(low.x, low.y);
  const Floats16 e = detail::halve<2>(detail::halve<4>(a, b), detail::halve<4>(c, d));
  const Floats16 least = detail::halve<1>(e, e);
  const Floats16 opposite = __builtin_shufflevector(least, least, 3, 4, 5, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const Floats16 middle = 0.5F * (least - opposite), wide = 0.5F * -(least + opposite);
  return {{spread(middle[0]), spread(middle[1]), spread(middle[2])},
          {spread(wide[0]), spread(wide[1]), spread(wide[2])}};
}

}  // namespace evenroad
