#include "drive/footprint.hpp"

#include <utility>

namespace evenroad::drive {

Footprint::Footprint(std::vector<std::vector<Vec>> of, Disks covering, Disks inside)
    : parts(std::move(of)), cover(std::move(covering)), inner(std::move(inside)) {
  for (const std::vector<Vec>& part : parts) {
    for (const Vec& corner : part) {
      reach = std::max(reach, norm(corner));
      for (const Vec& other : part) across = std::max(across, norm(corner - other));
    }
  }
}

}  // namespace evenroad::drive
