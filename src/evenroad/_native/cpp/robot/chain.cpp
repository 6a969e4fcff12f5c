#include "robot/chain.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

/// Move a pose to the frame at `next` in it, after a turn about z and a shift along z.
void go_on(Pose& pose, const Pose& next, double sine, double cosine, double slide) {
  const auto& r = next.rotation;
  for (int axis = 0; axis < 3; axis++) {
    double* row = &pose.rotation[3 * axis];
    const double x = row[0] * r[0] + row[1] * r[3] + row[2] * r[6];
    const double y = row[0] * r[1] + row[1] * r[4] + row[2] * r[7];
    const double z = row[0] * r[2] + row[1] * r[5] + row[2] * r[8];
    const double moved = row[0] * next.origin[0] + row[1] * next.origin[1] + row[2] * next.origin[2];
    row[0] = x * cosine + y * sine;
    row[1] = y * cosine - x * sine;
    row[2] = z;
    pose.origin[axis] += moved + z * slide;
  }
}

}  // namespace

Pose Chain::tip_pose(std::span<const double> q, std::span<Axis> axes) const {
  Pose pose;
  for (std::size_t i = 0; i < joints.size(); i++) {
    const ChainJoint& joint = joints[i];
    const double value = joint.multiplier * q[joint.coordinate] + joint.offset;
    if (joint.slides) {
      go_on(pose, joint.before, 0.0, 1.0, value);
    } else {
      go_on(pose, joint.before, std::sin(value), std::cos(value), 0.0);
    }
    axes[i] = {{pose.rotation[2], pose.rotation[5], pose.rotation[8]}, pose.origin};
  }
  go_on(pose, tip, 0.0, 1.0, 0.0);
  return pose;
}

void Chain::write_derivative(const Pose& tip, std::span<const Axis> axes, std::span<double> derivative) const {
  const auto columns = static_cast<std::size_t>(dim);
  std::fill(derivative.begin(), derivative.end(), 0.0);
  for (std::size_t i = 0; i < joints.size(); i++) {
    const ChainJoint& joint = joints[i];
    const Vector &axis = axes[i].direction, &at = axes[i].origin;
    const Vector arm = tip.origin - at;
    double* column = &derivative[static_cast<std::size_t>(joint.coordinate)];
    for (std::size_t k = 0; k < 3; k++) {
      const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
      column[k * columns] += joint.multiplier * (joint.slides ? axis[k] : axis[l] * arm[m] - axis[m] * arm[l]);
      if (!joint.slides) column[(3 + k) * columns] += joint.multiplier * axis[k];
    }
  }
}

}  // namespace evenroad::robot
