// A footprint: the convex parts of a body that drives, and disks that decide most checks of it.
#pragma once

#include <cstddef>
#include <vector>

#include "drive/plane.hpp"

namespace evenroad::drive {

/// Largest number of corners of a part; a pose of one lies on the stack.
constexpr std::size_t MOST_CORNERS = 48;

/// Equal disks, by their centres.
struct Disks {
  std::vector<Vec> centres;
  double radius = 0.0;
};

/// Parts are convex, their corners counter-clockwise.  They are a hair smaller than the body, so that rounding errs
/// towards contact: a footprint is open, and what touches is free.
struct Footprint {
  std::vector<std::vector<Vec>> parts;
  Disks cover;          ///< All parts lie in these.
  Disks inner;          ///< These lie in the parts.
  double reach = 0.0;   ///< Largest distance of a corner from the reference point.
  double across = 0.0;  ///< Largest distance of two corners of one part.

  Footprint(std::vector<std::vector<Vec>> parts, Disks cover, Disks inner);
};

}  // namespace evenroad::drive
