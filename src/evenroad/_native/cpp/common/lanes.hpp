// Several numbers that are computed at once: the vector types of GCC and clang, with the functions they lack.
//
// A type may be wider than the processor's registers; the compiler then splits it.  Sums over lanes have the same order
// on every processor, so every build of the kernel gives the same bits in code without `fma`.
#pragma once

#include <cstdint>

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace evenroad {

/// Number of configurations, points or nodes that are treated together.
constexpr int LANES = 16;

template <class T, int N>
struct LanesOf {
  typedef T type __attribute__((vector_size(N * sizeof(T))));
};

/// N numbers of type T; `+ - * /`, comparisons and `mask ? a : b` work lane by lane.
template <class T, int N>
using Lanes = typename LanesOf<T, N>::type;

using Floats16 = Lanes<float, 16>;
using Ints16 = Lanes<std::int32_t, 16>;

#define EVENROAD_INLINE inline __attribute__((always_inline))

/// Read lanes from memory of any alignment.
template <class V, class T>
EVENROAD_INLINE V load(const T* from) {
  V lanes;
  __builtin_memcpy(&lanes, from, sizeof(V));
  return lanes;
}

template <class V, class T>
EVENROAD_INLINE void store(T* to, V lanes) {
  __builtin_memcpy(to, &lanes, sizeof(V));
}

/// The same number in all lanes.  Adding minus zero changes no number, not even -0, so that it costs no instruction.
template <class V, class T>
EVENROAD_INLINE V all(T number) {
  return number - V{};
}

template <class V>
EVENROAD_INLINE V min(V a, V b) {
  return a < b ? a : b;
}

template <class V>
EVENROAD_INLINE V max(V a, V b) {
  return a > b ? a : b;
}

/// Absolute values: a comparison's lanes are integers of the same size, and all bits except the sign stay.
template <class V>
EVENROAD_INLINE V abs(V a) {
  using Bits = decltype(a < a);
  constexpr int SIGN = sizeof(a[0]) * 8 - 1;
  return (V)((Bits)a & ~((Bits{} + 1) << SIGN));
}

template <class V>
EVENROAD_INLINE V sqrt(V a) {
#if defined(__clang__)
  return __builtin_elementwise_sqrt(a);
#else
  for (unsigned lane = 0; lane < sizeof(V) / sizeof(a[0]); lane++) a[lane] = __builtin_sqrt(a[lane]);
  return a;
#endif
}

/// Return `a * b + c`, rounded once where the processor has such an instruction, else twice.
EVENROAD_INLINE Floats16 fma(Floats16 a, Floats16 b, Floats16 c) {
#if defined(__AVX512F__)
  return (Floats16)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
#elif defined(__FMA__)
  __m256 x[2], y[2], z[2];
  __builtin_memcpy(x, &a, sizeof a);
  __builtin_memcpy(y, &b, sizeof b);
  __builtin_memcpy(z, &c, sizeof c);
  for (int half = 0; half < 2; half++) z[half] = _mm256_fmadd_ps(x[half], y[half], z[half]);
  __builtin_memcpy(&c, z, sizeof c);
  return c;
#elif defined(__aarch64__)
  for (int lane = 0; lane < 16; lane++) c[lane] = __builtin_fmaf(a[lane], b[lane], c[lane]);
  return c;
#else
  return a * b + c;
#endif
}

/// Return the least of all lanes.
template <class T, int N>
EVENROAD_INLINE T least(const Lanes<T, N>& lanes) {
  T part[N];
  __builtin_memcpy(part, &lanes, sizeof part);
  for (int half = N / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; i++) part[i] = part[i + half] < part[i] ? part[i + half] : part[i];
  }
  return part[0];
}

/// Return the sum of all lanes, in the same order on every processor: halves are added to each other.
template <class T, int N>
EVENROAD_INLINE T sum(const Lanes<T, N>& lanes) {
  T part[N];
  __builtin_memcpy(part, &lanes, sizeof part);
  for (int half = N / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; i++) part[i] += part[i + half];
  }
  return part[0];
}

/// Return the lanes below zero, as bits.
EVENROAD_INLINE std::uint32_t below_zero(Floats16 a) {
#if defined(__AVX512F__)
  return _mm512_cmp_ps_mask((__m512)a, _mm512_setzero_ps(), _CMP_LT_OQ);
#elif defined(__AVX__)
  __m256 half[2];
  __builtin_memcpy(half, &a, sizeof a);
  const __m256 zero = _mm256_setzero_ps();
  const std::uint32_t low = _mm256_movemask_ps(_mm256_cmp_ps(half[0], zero, _CMP_LT_OQ));
  const std::uint32_t high = _mm256_movemask_ps(_mm256_cmp_ps(half[1], zero, _CMP_LT_OQ));
  return low | high << 8;
#else
  std::uint32_t bits = 0;
  for (int lane = 0; lane < 16; lane++) bits |= static_cast<std::uint32_t>(a[lane] < 0) << lane;
  return bits;
#endif
}

}  // namespace evenroad
