// Obstacles in double precision, and their rows in single precision, which are slightly larger.
#include "robot/exact_obstacle.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

constexpr float NEVER_HIT = -1e30F;  // half extent that fills unused places of a block
constexpr double LARGEST = 1e6;      // largest length [m]; beyond it the error of single precision is decimetres

/// Return whether a rotation takes axes to axes, up to the rounding of sines of right angles.
bool is_straight(const double* rotation) {
  return std::all_of(rotation, rotation + 9, [](double entry) { return std::abs(entry - std::rint(entry)) < 1e-14; });
}

void put(Vec3x16& where, int lane, float x, float y, float z) {
  where.x[lane] = x, where.y[lane] = y, where.z[lane] = z;
}

/// Add the leaf of an obstacle in its own frame: its middle, widened by its extents and by `width`.
void add_leaf(Obstacles& all, const Exact& o, double width) {
  constexpr double UP = 1.0 + 1e-6;  // for the rounding of single precision
  if (all.hulls.points.empty()) all.hulls.points.push_back({});
  HullNode<float> leaf;
  leaf.points = {0, 1}, leaf.width = static_cast<float>(width);
  const bool round = o.form == Form::CYLINDER;
  double squared = 0;
  for (int axis = 0; axis < 3; axis++) {
    const double reach = (o.half[axis] + width) * UP;
    squared += reach * reach;
    leaf.half[axis] = static_cast<float>(reach);
    leaf.extents[axis] = round && axis < 2 ? 0.0F : static_cast<float>(o.half[axis]);
  }
  leaf.radius = static_cast<float>(std::sqrt(squared) * UP);
  if (round) leaf.disc = static_cast<float>(o.half[0]), leaf.axis[2] = 1.0F;
  all.hulls.nodes.push_back(leaf);
}

/// Add a row, and the box of these half extents around its obstacle.
void add_row(Obstacles& all, const Obstacle& obstacle, Vec3 half) {
  const int lane = static_cast<int>(all.rows.size()) % LANES;
  if (lane == 0) {
    const Floats16 never = spread(NEVER_HIT);
    all.blocks.push_back({{Floats16{}, Floats16{}, Floats16{}}, {never, never, never}});
    all.limits.emplace_back();
  }
  put(all.blocks.back().centre, lane, obstacle.centre.x, obstacle.centre.y, obstacle.centre.z);
  put(all.blocks.back().half, lane, half.x, half.y, half.z);
  all.limits.back().put(lane, obstacle.centre, half);
  const auto number = static_cast<std::size_t>(obstacle.number);
  if (number >= all.row_of.size()) all.row_of.resize(number + 1, -1);
  all.row_of[number] = static_cast<int>(all.rows.size());
  all.rows.push_back(obstacle);
}

}  // namespace

/// Cut off the parts of a box along the axes that lie far beyond the robot's `reach`.  A floor of a hundred metres
/// would otherwise cost digits, of which single precision has seven.
Exact exact(const GivenObstacle& given, double reach) {
  const auto kind = static_cast<GivenKind>(static_cast<int>(given.kind));
  Exact made{};
  double extents[3] = {0, 0, 0.5 * given.size[1]};
  if (kind == GivenKind::BOX) {
    for (int axis = 0; axis < 3; axis++) extents[axis] = 0.5 * given.size[axis];
  } else if (kind == GivenKind::CYLINDER) {
    extents[0] = extents[1] = given.size[0];
  } else {
    made.rounding = given.size[0];
  }
  made.rounding += given.clearance;
  std::copy_n(given.translation, 3, made.centre);
  std::copy_n(given.rotation, 9, made.rotation);
  std::copy_n(extents, 3, made.half);
  if (kind != GivenKind::SPHERE && (kind == GivenKind::CYLINDER || !is_straight(given.rotation))) {
    made.form = kind == GivenKind::CYLINDER ? Form::CYLINDER : Form::ROTATED;
    return made;
  }
  made.form = Form::ALIGNED;
  for (int axis = 0; axis < 3; axis++) {
    double extent = 0;
    for (int entry = 0; entry < 3; entry++)
      extent += std::abs(std::rint(given.rotation[3 * axis + entry])) * extents[entry];
    for (int entry = 0; entry < 3; entry++) made.rotation[3 * axis + entry] = axis == entry;
    made.half[axis] = kind != GivenKind::SPHERE ? extent : 0.0;
    if (kind == GivenKind::BOX) {
      const double low = std::max(given.translation[axis] - extent, -2.0 * reach);
      const double high = std::min(given.translation[axis] + extent, 2.0 * reach);
      made.centre[axis] = 0.5 * (low + high), made.half[axis] = 0.5 * (high - low);
    }
  }
  return made;
}

double squared_distance(const Exact& o, const double* point) {
  const double d[3] = {point[0] - o.centre[0], point[1] - o.centre[1], point[2] - o.centre[2]};
  double gap[3];
  for (int axis = 0; axis < 3; axis++) {
    gap[axis] = std::abs(d[0] * o.rotation[axis] + d[1] * o.rotation[3 + axis] + d[2] * o.rotation[6 + axis]);
  }
  const double w = std::max(gap[2] - o.half[2], 0.0);
  if (o.form == Form::CYLINDER) {
    const double aside = std::max(std::sqrt(gap[0] * gap[0] + gap[1] * gap[1]) - o.half[0], 0.0);
    return aside * aside + w * w;
  }
  const double u = std::max(gap[0] - o.half[0], 0.0), v = std::max(gap[1] - o.half[1], 0.0);
  return u * u + v * v + w * w;
}

void write_extents(const Exact& o, double (&extents)[3]) {
  for (int axis = 0; axis < 3; axis++) {
    const double* row = o.rotation + 3 * axis;
    if (o.form == Form::CYLINDER) {
      const double upright = std::abs(row[2]);
      extents[axis] = upright * o.half[2] + std::sqrt(std::max(1.0 - upright * upright, 0.0)) * o.half[0] + o.rounding;
      continue;
    }
    extents[axis] = 0;
    for (int entry = 0; entry < 3; entry++) extents[axis] += std::abs(row[entry]) * o.half[entry];
    extents[axis] += o.rounding;
  }
}

bool is_too_far(const GivenObstacle& given) {
  const double largest = std::max({std::abs(given.translation[0]), std::abs(given.translation[1]),
                                   std::abs(given.translation[2]), given.size[0], given.size[1], given.size[2]});
  const bool cut =
      static_cast<GivenKind>(static_cast<int>(given.kind)) == GivenKind::BOX && is_straight(given.rotation);
  return largest > LARGEST && !cut;
}

double add(Obstacles& all, const Exact& o, int number) {
  double extents[3], squared = 0;
  write_extents(o, extents);
  for (int axis = 0; axis < 3; axis++) {
    const double farthest = std::abs(o.centre[axis]) + extents[axis];
    squared += farthest * farthest;
  }
  const double padding = OBSTACLE_PADDING * std::sqrt(squared);
  const auto single = [](const double* v) {
    return Vec3{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  };
  const double rounding = o.rounding + padding;
  Obstacle obstacle{o.form, number, single(o.centre), single(o.half), {}, static_cast<float>(rounding)};
  for (int entry = 0; entry < 9; entry++) obstacle.rotation[entry] = static_cast<float>(o.rotation[entry]);
  for (double& extent : extents) extent += padding;
  add_row(all, obstacle, single(extents));
  add_leaf(all, o, rounding);
  return rounding - o.rounding;
}

void add_again(Obstacles& all, const Obstacles& others, int row) {
  const Block& block = others.blocks[row / LANES];
  const int lane = row % LANES;
  add_row(all, others.rows[row], {block.half.x[lane], block.half.y[lane], block.half.z[lane]});
  if (all.hulls.points.empty()) all.hulls.points.push_back({});
  all.hulls.nodes.push_back(others.hulls.nodes[row]);
}

}  // namespace evenroad::robot
