// A motion is halved until hulls decide it.  Over an interval that turns by an angle, no point of a body leaves the
// segment between where it begins and where it ends by more than r (1 - cos(angle / 2)), r its distance from the
// centre: so the hull of both end polygons, grown by that, holds all that is swept.  A straight drive's hull is what it
// sweeps.  For turns about a centre, the cells that a small hull meets are tested exactly: a polygon that is free at
// first meets a square with a corner on a side, or a side on a corner, and either is an arc that crosses a segment.
#include "drive/checks.hpp"

#include <algorithm>
#include <limits>

#include "drive/convex.hpp"

namespace evenroad::drive {

namespace {

/// Largest turn of an interval that hulls are made for: beyond, they hold too much.
constexpr double LARGEST_TURN = 0.7;
/// A hull that holds this much more than what is swept, or less, is decided cell by cell [cells].
constexpr double SMALL_EXCESS = 1.0;
/// Rounding of points that turn, for distances of 1.
constexpr double ROUNDING = 1e-12;

using Square = std::array<Vec, 4>;

Square square_at(std::int64_t row, std::int64_t column) {
  const auto x = static_cast<double>(column), y = static_cast<double>(row);
  return {Vec{x, y}, Vec{x + 1.0, y}, Vec{x + 1.0, y + 1.0}, Vec{x, y + 1.0}};
}

/// Say whether a point that turns about the origin from `a` to `b`, by less than half a turn in a sense, meets the
/// segment from `p` to `q`.
bool meets_turning(Vec a, Vec b, double sense, Vec p, Vec q) {
  const Vec d = q - p;
  const double square = dot(d, d), half = dot(p, d), beyond = dot(p, p) - dot(a, a);
  const double inside = half * half - square * beyond;
  if (inside < 0.0) return false;
  const double root = std::sqrt(inside), slack = ROUNDING * (1.0 + dot(a, a));
  for (const double u : {(-half - root) / square, (-half + root) / square}) {
    if (u < -ROUNDING || u > 1.0 + ROUNDING) continue;
    const Vec x = p + u * d;
    if (sense * cross(a, x) >= -slack && sense * cross(x, b) >= -slack) return true;
  }
  return false;
}

}  // namespace

Checks::Checks(const Vehicle& vehicle, Tables tables)
    : vehicle_(vehicle),
      has_tables_(tables == Tables::USED),
      tolerance_(LINE_TOLERANCE * std::max(1.0, 1.0 / vehicle.scale())) {}

bool Checks::is_free(const Pose& pose) {
  counts.poses++;
  clock_.look();
  const Placed placed(pose);
  const Footprint& footprint = vehicle_.footprint();
  const auto state = [&](const world::Disk& disk, Vec at) {
    return disk.cell_if_known(static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.x));
  };
  for (const Vec& centre : footprint.inner.centres) {
    const Vec at = placed(centre);
    if (!vehicle_.has(at) || (has_tables_ && state(vehicle_.inner(), at) == world::BLOCKED)) return false;
  }
  const bool is_clear = has_tables_ && std::ranges::all_of(footprint.cover.centres, [&](const Vec& centre) {
                          const Vec at = placed(centre);
                          return vehicle_.has(at) && state(vehicle_.cover(), at) >= world::FREE;
                        });
  if (is_clear) return true;
  Corners corners;
  for (const std::vector<Vec>& part : footprint.parts) {
    std::ranges::transform(part, corners.begin(), placed);
    if (meets({corners.data(), part.size()}, 0.0)) return false;
    if (vehicle_.obstacles() != nullptr && vehicle_.obstacles()->hold(corners[0])) return false;
  }
  return true;
}

bool Checks::is_free(const Motion& motion) {
  return is_free(motion.at(1.0)) && is_free(motion.from) && is_free_between(motion);
}

bool Checks::is_free_between(const Motion& motion) {
  counts.motions++;
  // Beyond a full turn nothing new is swept.
  Motion once = motion;
  once.turn =
      std::clamp(motion.turn, motion.is_about ? -2.0 * PI : motion.turn, motion.is_about ? 2.0 * PI : motion.turn);
  return is_free_within(once, {0.0, once.from, 1.0, once.at(1.0)});
}

bool Checks::is_free_within(const Motion& motion, const Interval& interval) {
  const double t = 0.5 * (interval.begin + interval.end);
  const Pose middle = motion.at(t);
  if (has_tables_ && is_covered_free(motion, interval, Placed(middle))) return true;
  if (const Answer answer = sweep(motion, interval); answer != Answer::UNKNOWN) return answer == Answer::FREE;
  if (!is_free(middle)) return false;
  return is_free_within(motion, {interval.begin, interval.first, t, middle}) &&
         is_free_within(motion, {t, middle, interval.end, interval.last});
}

/// Say whether the disks that cover the footprint are free, wherever the interval moves them.
bool Checks::is_covered_free(const Motion& motion, const Interval& interval, const Placed& middle) const {
  const double share = interval.end - interval.begin, turn = std::abs(motion.turn) * share;
  const double swing = 2.0 * (turn > PI ? 1.0 : std::sin(0.25 * turn));
  const double along = 0.5 * share * norm(motion.by);
  const world::Disk& disk = vehicle_.cover();
  return std::ranges::all_of(vehicle_.footprint().cover.centres, [&](const Vec& centre) {
    const Vec at = middle(centre);
    if (!vehicle_.has(at)) return false;
    const double moved = motion.is_about ? norm(at - motion.centre) * swing : along + norm(centre) * swing;
    const std::uint8_t state = disk.cell_if_known(static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.x));
    return state >= world::FREE && static_cast<double>(state - world::FREE) >= moved * (1.0 + ROUNDING);
  });
}

/// Decide an interval by the hull of each part where it begins and ends, or say that it has to be halved.
Checks::Answer Checks::sweep(const Motion& motion, const Interval& interval) {
  const double turn = std::abs(motion.turn) * (interval.end - interval.begin);
  if (turn > LARGEST_TURN) return Answer::UNKNOWN;
  const Placed first(interval.first), last(interval.last);
  for (const std::vector<Vec>& part : vehicle_.footprint().parts) {
    const std::size_t count = part.size();
    Corners corners, sorted;
    std::array<Vec, 2 * MOST_CORNERS + 1> hull;
    double radius = 0.0;
    for (std::size_t i = 0; i < count; i++) {
      corners[i] = first(part[i]), corners[count + i] = last(part[i]);
      radius = std::max(radius, motion.is_about ? norm(corners[i] - motion.centre) : norm(part[i]));
    }
    std::copy_n(corners.begin(), 2 * count, sorted.begin());
    const double sag = turn == 0.0 ? 0.0 : radius * (1.0 - std::cos(0.5 * turn) + ROUNDING);
    const std::size_t size = convex_hull({sorted.data(), 2 * count}, hull);
    if (!meets({hull.data(), size}, sag)) continue;
    if (turn == 0.0) return Answer::BLOCKED;
    const double excess = 0.25 * turn * vehicle_.footprint().across + 2.0 * sag;
    if (excess > (motion.is_about ? SMALL_EXCESS : tolerance_)) return Answer::UNKNOWN;
    if (!motion.is_about || turns_into({corners.data(), count}, {corners.data() + count, count}, motion)) {
      return Answer::BLOCKED;
    }
  }
  return Answer::FREE;
}

bool Checks::meets(std::span<const Vec> polygon, double grow) {
  const world::Occupancy& occupancy = vehicle_.occupancy();
  if (!covered_.cover(polygon, grow, occupancy)) return true;
  const Obstacles* obstacles = vehicle_.obstacles();
  return obstacles == nullptr ? covered_.meets(occupancy) : obstacles->meet(covered_, occupancy, polygon, grow);
}

/// Say whether a part that turns about a centre, its corners from the first to the last, touches one of the covered
/// cells, or sides in them; it touches none where it begins.
bool Checks::turns_into(std::span<const Vec> first, std::span<const Vec> last, const Motion& motion) {
  const double sense = motion.turn < 0.0 ? -1.0 : 1.0;
  const Vec centre = motion.centre;
  // The turn of the interval, of the corner that is farthest from the centre.
  const auto farthest = std::ranges::max_element(first, {}, [&](Vec v) { return norm(v - centre); }) - first.begin();
  const Vec from = first[farthest] - centre, to = last[farthest] - centre;
  const double square = dot(from, from);
  const double cosine = dot(from, to) / square, sine = cross(from, to) / square;
  // Say whether the part meets a segment, the first corner of which stands for all of an outline.
  const auto meets_segment = [&](Vec from_centre, Vec next_from_centre) {
    // Seen from the part, the corner turns back.
    const Vec& corner = from_centre;
    const Vec back{cosine * corner.x + sine * corner.y, cosine * corner.y - sine * corner.x};
    for (std::size_t i = 0; i < first.size(); i++) {
      const Vec a = first[i] - centre, b = last[i] - centre, next = first[(i + 1) % first.size()] - centre;
      if (meets_turning(a, b, sense, corner, next_from_centre)) return true;
      if (meets_turning(corner, back, -sense, a, next)) return true;
    }
    return false;
  };
  if (const Obstacles* obstacles = vehicle_.obstacles(); obstacles != nullptr) {
    return obstacles->any_side(covered_, vehicle_.occupancy(), [&](const Side& side) {
      const Vec p = side.from - centre, q = side.to - centre;
      return meets_segment(p, q) || meets_segment(q, p);
    });
  }
  return covered_.any_occupied(vehicle_.occupancy(), [&](std::int64_t row, std::int64_t column) {
    const Square square = square_at(row, column);
    for (std::size_t j = 0; j < 4; j++) {
      if (meets_segment(square[j] - centre, square[(j + 1) % 4] - centre)) return true;
    }
    return false;
  });
}

double Checks::gap(const Pose& pose) {
  if (!is_free(pose)) return 0.0;
  const Placed placed(pose);
  const world::Occupancy& occupancy = vehicle_.occupancy();
  double least = std::numeric_limits<double>::max();
  Corners corners;
  for (const std::vector<Vec>& part : vehicle_.footprint().parts) {
    std::ranges::transform(part, corners.begin(), placed);
    const std::span<const Vec> polygon{corners.data(), part.size()};
    // The ring around the map bounds it.
    double bound = std::numeric_limits<double>::max();
    for (const Vec& corner : polygon) {
      bound = std::min({bound, corner.x, corner.y, static_cast<double>(vehicle_.columns()) - corner.x,
                        static_cast<double>(vehicle_.rows()) - corner.y});
    }
    least = std::min(least, bound - 1.0);
    for (double grow = 4.0; least > 0.0; grow *= 2.0) {
      const double within = std::min(grow, std::min(least, bound - 1.0));
      if (!covered_.cover(polygon, within, occupancy)) break;
      if (const Obstacles* obstacles = vehicle_.obstacles(); obstacles != nullptr) {
        obstacles->any_side(covered_, occupancy, [&](const Side& side) {
          least = std::min(least, distance_of(polygon, std::array<Vec, 2>{side.from, side.to}));
          return false;
        });
      } else {
        covered_.any_occupied(occupancy, [&](std::int64_t row, std::int64_t column) {
          least = std::min(least, distance_of(polygon, square_at(row, column)));
          return false;
        });
      }
      if (least <= within) break;
      clock_.look();
    }
  }
  return std::max(least, 0.0);
}

std::optional<Contact> Checks::contact(const Pose& pose) {
  const Placed placed(pose);
  std::optional<Contact> deepest;
  Corners corners;
  const std::vector<std::vector<Vec>>& parts = vehicle_.footprint().parts;
  for (std::size_t part = 0; part < parts.size(); part++) {
    std::ranges::transform(parts[part], corners.begin(), placed);
    const std::span<const Vec> polygon{corners.data(), parts[part].size()};
    if (!covered_.cover(polygon, 0.0, vehicle_.occupancy())) continue;
    covered_.any_occupied(vehicle_.occupancy(), [&](std::int64_t row, std::int64_t column) {
      const Square square = square_at(row, column);
      const double depth = overlap_of(polygon, square);
      if (depth >= 0.0 && (!deepest || depth > deepest->depth)) deepest = Contact{row, column, part, depth};
      return false;
    });
  }
  return deepest;
}

std::optional<SideContact> Checks::side_contact(const Pose& pose) {
  const Placed placed(pose);
  const Obstacles* obstacles = vehicle_.obstacles();
  std::optional<SideContact> deepest;
  Corners corners;
  const std::vector<std::vector<Vec>>& parts = vehicle_.footprint().parts;
  for (std::size_t part = 0; part < parts.size(); part++) {
    std::ranges::transform(parts[part], corners.begin(), placed);
    const std::span<const Vec> polygon{corners.data(), parts[part].size()};
    if (!covered_.cover(polygon, 0.0, vehicle_.occupancy())) continue;
    obstacles->any_side(covered_, vehicle_.occupancy(), [&](const Side& side) {
      const double depth = overlap_of(polygon, std::array<Vec, 2>{side.from, side.to});
      if (depth < 0.0 || (deepest && depth <= deepest->depth)) return false;
      deepest = SideContact{side.polygon, part, middle_within(polygon, side.from, side.to), depth};
      return false;
    });
    if (const std::int64_t holder = obstacles->holder(polygon[0]); !deepest && holder != OUTSIDE) {
      deepest = SideContact{holder, part, polygon[0], 0.0};
    }
  }
  return deepest;
}

}  // namespace evenroad::drive
