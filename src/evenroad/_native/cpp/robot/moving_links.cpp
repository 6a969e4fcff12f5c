#include "robot/moving_links.hpp"

#include <algorithm>
#include <cstdint>

namespace evenroad::robot {

namespace {

/// Return a matrix times vectors.
EVENROAD_INLINE Vectors times(const std::array<double, 9>& m, const Vectors& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}
/// Return the transpose of a matrix times vectors.
EVENROAD_INLINE Vectors back(const std::array<double, 9>& m, const Vectors& v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}
/// Return vectors turned about z.
EVENROAD_INLINE Vectors about_z(const States& cosine, const States& sine, const Vectors& v) {
  return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z};
}

/// Return the origin of a frame that slides along its z axis.
EVENROAD_INLINE Vectors arm_of(const Pose& before, const States& slide) {
  const auto& [rotation, origin] = before;
  return {origin[0] + slide * rotation[2], origin[1] + slide * rotation[5], origin[2] + slide * rotation[8]};
}

/// Write sines and cosines, by the series of the remainder after the nearest quarter turn; the series end below 1e-16.
void write_sine_cosine(States angle, States& sine, States& cosine) {
  // Added to a number, it leaves the nearest whole one in the last bits.
  constexpr double WHOLE = 6755399441055744.0;
  // A quarter turn in three parts: the first two have few bits, so that their products are exact.
  constexpr double QUARTER = 0x1.921fb54p+0, LESS = 0x1.10b46118p-30, LEAST = 0x1.313198a2e0370p-61;
  constexpr double SINE[] = {-1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800};
  constexpr double LAST_SINE = -1.0 / 1307674368000;
  constexpr double COSINE[] = {-1.0 / 2,       1.0 / 24,        -1.0 / 720,        1.0 / 40320,
                               -1.0 / 3628800, 1.0 / 479001600, -1.0 / 87178291200};
  constexpr double LAST_COSINE = 1.0 / 20922789888000;
  using Bits = Lanes<std::int64_t, STATES>;
  const States marked = angle * 0.63661977236758134308 + WHOLE, quarters = marked - WHOLE;
  const States left = ((angle - quarters * QUARTER) - quarters * LESS) - quarters * LEAST, square = left * left;
  States s = all<States>(LAST_SINE), c = all<States>(LAST_COSINE);
  for (int i = 5; i >= 0; i--) s = s * square + SINE[i];
  for (int i = 6; i >= 0; i--) c = c * square + COSINE[i];
  s = left + left * (square * s), c = 1.0 + square * c;
  const Bits quarter = (Bits)marked;
  const auto swapped = (quarter & 1) != 0;
  const States first = swapped ? c : s, second = swapped ? s : c;
  sine = (quarter & 2) != 0 ? -first : first;
  cosine = ((quarter + 1) & 2) != 0 ? -second : second;
}

}  // namespace

MovingStates::MovingStates(const MovingLinks& links)
    : links_(links),
      sines_(links.links.size()),
      cosines_(links.links.size()),
      slides_(links.links.size()),
      motions_(links.links.size()),
      loads_(links.links.size()) {}

void MovingStates::move_to(std::span<const States> q) {
  for (std::size_t i = 0; i < links_.links.size(); i++) {
    const ChainJoint& joint = links_.links[i].joint;
    const States value = q[static_cast<std::size_t>(joint.coordinate)] * joint.multiplier + joint.offset;
    if (joint.slides) {
      sines_[i] = States{}, cosines_[i] = all<States>(1.0), slides_[i] = value;
    } else {
      write_sine_cosine(value, sines_[i], cosines_[i]);
      slides_[i] = States{};
    }
  }
}

void MovingStates::move(std::span<const States> velocity, std::span<const States> acceleration, const Vector& pulled) {
  const Vectors falling{all<States>(pulled[0]), all<States>(pulled[1]), all<States>(pulled[2])};
  const Motion root{{}, {}, falling};
  for (std::size_t i = 0; i < links_.links.size(); i++) {
    const auto& [joint, parent, mass, centre, inertia] = links_.links[i];
    const Motion& from = parent < 0 ? root : motions_[static_cast<std::size_t>(parent)];
    Motion& to = motions_[i];
    const auto coordinate = static_cast<std::size_t>(joint.coordinate);
    const auto& r = joint.before.rotation;
    const Vectors arm = arm_of(joint.before, slides_[i]);
    const auto into = [&](const Vectors& v) { return about_z(cosines_[i], -sines_[i], back(r, v)); };
    const States push = acceleration.empty() ? States{} : acceleration[coordinate] * joint.multiplier;
    to.turned = into(from.turned);
    if (velocity.empty()) {
      to.turn = {};
      to.pushed = into(from.pushed + cross(from.turned, arm));
    } else {
      const States rate = velocity[coordinate] * joint.multiplier;
      to.turn = into(from.turn);
      to.pushed = into(from.pushed + cross(from.turned, arm) + cross(from.turn, cross(from.turn, arm)));
      const States across = to.turn.y * rate, along = to.turn.x * rate;
      if (joint.slides) {
        to.pushed.x += 2.0 * across, to.pushed.y -= 2.0 * along;
      } else {
        to.turned.x += across, to.turned.y -= along;
        to.turn.z += rate;
      }
    }
    (joint.slides ? to.pushed : to.turned).z += push;
  }
}

Vectors MovingStates::acceleration(std::size_t link, const Vector& point) const {
  const Motion& motion = motions_[link];
  return motion.pushed + cross(motion.turned, point) + cross(motion.turn, cross(motion.turn, point));
}

void MovingStates::write_torques(std::span<States> torques) {
  std::ranges::fill(torques, States{});
  for (std::size_t i = 0; i < links_.links.size(); i++) {
    const MovingLink& link = links_.links[i];
    const Motion& motion = motions_[i];
    const Vectors force = acceleration(i, link.centre) * link.mass;
    const Vectors spin = times(link.inertia, motion.turned) + cross(motion.turn, times(link.inertia, motion.turn));
    loads_[i] = {force, spin + cross(link.centre, force)};
  }
  for (std::size_t i = links_.links.size(); i-- > 0;) {
    const ChainJoint& joint = links_.links[i].joint;
    const auto& [force, moment] = loads_[i];
    torques[static_cast<std::size_t>(joint.coordinate)] += (joint.slides ? force : moment).z * joint.multiplier;
    if (links_.links[i].parent < 0) continue;
    Load& parent = loads_[static_cast<std::size_t>(links_.links[i].parent)];
    const auto& r = joint.before.rotation;
    const Vectors carried = times(r, about_z(cosines_[i], sines_[i], force));
    const Vectors turned = times(r, about_z(cosines_[i], sines_[i], moment));
    parent.force = parent.force + carried;
    parent.moment = parent.moment + turned + cross(arm_of(joint.before, slides_[i]), carried);
  }
}

void read_rows(Matrix<const double> rows, std::size_t first, std::span<States> columns) {
  for (std::size_t lane = 0; lane < STATES; lane++) {
    const auto row = rows[std::min(first + lane, rows.rows - 1)];
    for (std::size_t k = 0; k < rows.columns; k++) columns[k][lane] = row[k];
  }
}

void write_torques(const MovingLinks& links, Matrix<const double> q, Matrix<const double> velocity,
                   Matrix<const double> acceleration, const Vector& pulled, Matrix<double> torques) {
  std::vector<States> here(links.dim), rates(links.dim), pushes(links.dim), needed(links.dim);
  MovingStates states(links);
  for (std::size_t first = 0; first < q.rows; first += STATES) {
    read_rows(q, first, here), read_rows(velocity, first, rates), read_rows(acceleration, first, pushes);
    states.move_to(here);
    states.move(rates, pushes, pulled);
    states.write_torques(needed);
    for (std::size_t lane = 0; lane < std::min(STATES, q.rows - first); lane++) {
      for (std::size_t k = 0; k < links.dim; k++) torques(first + lane, k) = needed[k][lane];
    }
  }
}

}  // namespace evenroad::robot
