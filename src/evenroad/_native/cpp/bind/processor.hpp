// The instruction sets that the kernel is built for, and how many of them this processor runs.
//
// With clang of the wheel `ziglang`, __builtin_cpu_supports returns "no" on every processor, so cpuid is read here.
// The registers that the system saves (xgetbv) decide, too.
#pragma once

#include <array>
#include <cstdint>

#if defined(__x86_64__) || defined(_M_X64)
#include <cpuid.h>

namespace evenroad::bind {

struct Registers {
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
};

inline Registers registers_of(std::uint32_t leaf) {
  Registers answer;
  if (__get_cpuid_count(leaf, 0, &answer.a, &answer.b, &answer.c, &answer.d) == 0) {
    return {};
  }
  return answer;
}

inline bool has_all(std::uint32_t flags, std::uint32_t wanted) { return (flags & wanted) == wanted; }

inline std::uint32_t saved_registers() {
  std::uint32_t low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

/// Return how many of x86-64, x86-64-v3 and x86-64-v4 there are.
inline int count_runnable() {
  constexpr std::uint32_t XSAVED = 1u << 27, YMM = 0x6, ZMM = 0xe6;
  // FMA, CMPXCHG16B, SSE4.1, SSE4.2, MOVBE, POPCNT, AVX and F16C; SSE3 and SSSE3 come before these.
  constexpr std::uint32_t FIRST_V3 =
      1u << 12 | 1u << 13 | 1u << 19 | 1u << 20 | 1u << 22 | 1u << 23 | 1u << 28 | 1u << 29;
  constexpr std::uint32_t SEVENTH_V3 = 1u << 3 | 1u << 5 | 1u << 8;                           // BMI1, AVX2, BMI2
  constexpr std::uint32_t SEVENTH_V4 = 1u << 16 | 1u << 17 | 1u << 28 | 1u << 30 | 1u << 31;  // F, DQ, CD, BW, VL
  constexpr std::uint32_t LZCNT = 1u << 5;
  const Registers first = registers_of(1), seventh = registers_of(7), extended = registers_of(0x80000001);
  if (!has_all(first.c, FIRST_V3 | XSAVED) || !has_all(seventh.b, SEVENTH_V3) || !has_all(extended.c, LZCNT)) {
    return 1;
  }
  const std::uint32_t saved = saved_registers();
  if (!has_all(saved, YMM)) {
    return 1;
  }
  return has_all(seventh.b, SEVENTH_V4) && has_all(saved, ZMM) ? 3 : 2;
}

constexpr std::array<const char*, 3> VARIANTS = {"x86-64", "x86-64-v3", "x86-64-v4"};

}  // namespace evenroad::bind
#else
namespace evenroad::bind {

inline int count_runnable() { return 1; }
#if defined(__aarch64__) || defined(_M_ARM64)
constexpr std::array<const char*, 1> VARIANTS = {"aarch64"};
#else
constexpr std::array<const char*, 1> VARIANTS = {"generic"};
#endif

}  // namespace evenroad::bind
#endif
