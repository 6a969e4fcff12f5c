// Boxes along the axes in whole numbers of a millimetre.  Sixteen of them fill a register of half the width that single
// precision takes, so that boxes which are clearly apart cost a third.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/float16.hpp"

namespace evenroad::robot {

using Shorts16 = Lanes<std::int16_t, 16>;

/// Whole numbers in a metre.  Farther than 32 m from the origin all positions are one, so that boxes there overlap.
constexpr float ROUGH = 1024;

/// Sixteen boxes: their lower ends along x, y and z, then minus their upper ends, each rounded down.
struct RoughBoxes {
  Shorts16 sides[6];
};

/// Sixteen boxes that others may overlap: their upper ends, then minus their lower ends, each rounded up.
struct RoughLimits {
  RoughBoxes all;
  RoughBoxes each[LANES];  // one after the other, each in all lanes

  void put(int lane, Vec3 centre, Vec3 half) {
    const float at[3] = {centre.x, centre.y, centre.z}, wide[3] = {half.x, half.y, half.z};
    for (int axis = 0; axis < 3; axis++) {
      for (const int side : {axis, 3 + axis}) {
        const std::int16_t most = rounded_up(wide[axis] + (side < 3 ? at[axis] : -at[axis]));
        all.sides[side][lane] = most, each[lane].sides[side] = Shorts16{} + most;
      }
    }
  }

 private:
  /// One more than needed, so that rounding of the other box separates nothing.
  static std::int16_t rounded_up(float length) {
    using Short = std::numeric_limits<std::int16_t>;
    return static_cast<std::int16_t>(
        std::clamp(std::ceil(length * ROUGH) + 1, float{Short::min()}, float{Short::max()}));
  }
};

namespace detail {

/// Return numbers cut to whole ones, clipped to sixteen bits.  Numbers that are too large even for 32 bits may become
/// the lowest one: the box is then only larger.
EVENROAD_INLINE Shorts16 cut_to_shorts(Floats16 a) {
#if defined(__AVX512F__)
  return (Shorts16)_mm512_cvtsepi32_epi16(_mm512_cvttps_epi32((__m512)a));
#elif defined(__AVX2__)
  __m256 half[2];
  __builtin_memcpy(half, &a, sizeof a);
  const __m256i packed = _mm256_packs_epi32(_mm256_cvttps_epi32(half[0]), _mm256_cvttps_epi32(half[1]));
  return (Shorts16)_mm256_permute4x64_epi64(packed, 0xD8);
#else
  return __builtin_convertvector(clamp(a, spread(-32768), spread(32767)), Shorts16);
#endif
}

/// Return lanes that are 0 or -1 as bits.
EVENROAD_INLINE std::uint32_t bits_of(Shorts16 lanes) {
#if defined(__AVX512BW__) && defined(__AVX512VL__)
  return _mm256_movepi16_mask((__m256i)lanes);
#elif defined(__AVX2__)
  const __m256i all = (__m256i)lanes;
  return _mm_movemask_epi8(_mm_packs_epi16(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1)));
#else
  std::uint32_t bits = 0;
  for (int lane = 0; lane < 16; lane++) bits |= static_cast<std::uint32_t>(lanes[lane] != 0) << lane;
  return bits;
#endif
}

EVENROAD_INLINE std::int16_t least_of(Shorts16 lanes) {
#if defined(__AVX2__)
  const __m256i all = (__m256i)lanes;
  const __m128i lower = _mm_min_epi16(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
  // The instruction takes numbers without a sign.
  const __m128i sign = _mm_set1_epi16(INT16_MIN);
  return static_cast<std::int16_t>(
      _mm_cvtsi128_si32(_mm_xor_si128(_mm_minpos_epu16(_mm_xor_si128(lower, sign)), sign)));
#else
  std::int16_t least = lanes[0];
  for (int lane = 1; lane < 16; lane++) least = std::min<std::int16_t>(least, lanes[lane]);
  return least;
#endif
}

}  // namespace detail

/// Return boxes of these half extents.
EVENROAD_INLINE RoughBoxes rough_boxes(Vec3x16 centre, Vec3x16 half) {
  // What is cut may become larger by one; the rest is more than errors of single precision.
  const auto side = [](Floats16 a) { return detail::cut_to_shorts(fma(a, spread(ROUGH), spread(-2))); };
  const Vec3x16 low = centre - half, minus_high = -(centre + half);
  return {{side(low.x), side(low.y), side(low.z), side(minus_high.x), side(minus_high.y), side(minus_high.z)}};
}

/// Return the box around all sixteen, in all lanes.
EVENROAD_INLINE RoughBoxes around_all(const RoughBoxes& boxes) {
  RoughBoxes around;
  for (int side = 0; side < 6; side++) around.sides[side] = Shorts16{} + detail::least_of(boxes.sides[side]);
  return around;
}

/// Return the lanes in which boxes may overlap others, of which these are the limits.
EVENROAD_INLINE std::uint32_t within_limits(const RoughBoxes& boxes, const RoughBoxes& limits) {
  auto apart = boxes.sides[0] > limits.sides[0];
  for (int side = 1; side < 6; side++) apart |= boxes.sides[side] > limits.sides[side];
  return ALL_LANES & ~detail::bits_of((Shorts16)apart);
}

}  // namespace evenroad::robot
