// One state of a law: its position along the path, and the bend of the path there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "trajectory/time_law.hpp"

namespace evenroad::trajectory {

/// One state: cosine and sine of the angle since the beginning of an arc, and the length along a line; on a line the
/// cosine is 1 and the sine 0.
struct Turn {
  std::size_t piece;
  double cosine = 1.0, sine = 0.0, radius = 0.0, reached, bend;

  Turn(const RoundedPath& path, std::size_t piece, double s) : piece(piece), bend(path.bend[piece]) {
    reached = s - path.starts[piece];
    if (bend <= 0.0) return;
    cosine = std::cos(reached * bend), sine = std::sin(reached * bend);
    radius = 1.0 / bend;
    reached = radius * sine;
  }

  double position(const RoundedPath& path, std::size_t k) const {
    return path.origin(piece, k) + radius * cosine * path.out(piece, k) + reached * path.along(piece, k);
  }
  double direction(const RoundedPath& path, std::size_t k) const {
    return cosine * path.along(piece, k) - sine * path.out(piece, k);
  }
  double curve(const RoundedPath& path, std::size_t k) const {
    return -bend * (cosine * path.out(piece, k) + sine * path.along(piece, k));
  }
};

/// Return the piece of each interval.
inline std::vector<std::size_t> pieces_of(const RoundedPath& path, const TimeLaw& law) {
  std::vector<std::size_t> pieces(law.intervals());
  for (std::size_t i = 0; i < pieces.size(); i++) {
    const double middle = 0.5 * (law.lengths[i] + law.lengths[i + 1]);
    const auto after = std::ranges::upper_bound(path.starts.begin() + 1, path.starts.end() - 1, middle);
    pieces[i] = static_cast<std::size_t>(after - path.starts.begin()) - 1;
  }
  return pieces;
}

/// The position in an interval, some time after its beginning.
struct Progress {
  double length, speed;

  Progress(const TimeLaw& law, std::size_t i, double after) {
    const double push = law.accelerations[i];
    const double s = law.lengths[i] + after * (law.speeds[i] + 0.5 * push * after);
    length = std::min(std::max(s, law.lengths[i]), law.lengths[i + 1]);
    speed = std::max(law.speeds[i] + push * after, 0.0);
  }
};

}  // namespace evenroad::trajectory
