// What checks say of milestones and motions, and how both are numbered.
#pragma once

#include <cstdint>

namespace evenroad::robot_roadmap {

/// The number of a milestone, an edge, a state or a way.
using Number = std::int32_t;
inline constexpr Number NONE = -1;

/// What is known of a milestone or a motion.  A motion is FREE at its states and PROVED throughout.
enum class Verdict : std::uint8_t { UNKNOWN, BLOCKED, FREE, PROVED };

inline bool is_free(Verdict verdict) { return verdict >= Verdict::FREE; }

}  // namespace evenroad::robot_roadmap
