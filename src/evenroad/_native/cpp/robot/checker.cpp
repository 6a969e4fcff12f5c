// Sixteen configurations at once: obstacles first, then surfaces, then the robot itself.
#include "robot/checker.hpp"

namespace evenroad::robot {

namespace {

Contact find_fixed_contact(const Robot& robot, const Scene& scene) {
  const auto [capsule, obstacle] = scene.fixed_contact;
  if (capsule >= 0) return {Contact::With::OBSTACLE, capsule, obstacle};
  return scene.surfaces.empty() ? Contact{} : fixed_surface_contact(robot, scene, PlacedRobot(robot));
}

}  // namespace

Checker::Checker(std::shared_ptr<const Robot> robot, std::shared_ptr<const Scene> scene, double resolution,
                 double clearance, bool touches_itself)
    : robot_(std::move(robot)),
      scene_(std::move(scene)),
      resolution_(resolution),
      lengths_(clearance > 0 ? robot_->lengths.enlarged(static_cast<float>(clearance)) : robot_->lengths),
      fixed_contact_(find_fixed_contact(*robot_, *scene_)),
      never_free_(touches_itself || fixed_contact_.with != Contact::With::NOTHING) {}

Checker::~Checker() = default;

const Lengths& Checker::wider(float margin) const {
  const std::lock_guard lock(guard_);
  for (const auto& [known, lengths] : wider_) {
    if (known == margin) return *lengths;
  }
  wider_.emplace_back(margin, std::make_unique<Lengths>(lengths_.enlarged(margin)));
  return *wider_.back().second;
}

Borrowed Checker::borrow() const {
  {
    const std::lock_guard lock(guard_);
    if (!free_.empty()) {
      Workspace* workspace = free_.back().release();
      free_.pop_back();
      workspace->counts = {};
      workspace->judge_by(nullptr);
      return {workspace, Return{this}};
    }
  }
  return {new Workspace(*this), Return{this}};
}

void Return::operator()(Workspace* workspace) const {
  std::unique_ptr<Workspace> owned(workspace);
  const std::lock_guard lock(checker->guard_);
  checker->free_.push_back(std::move(owned));
}

Workspace::Workspace(const Checker& checker)
    : checker(checker),
      lengths(&checker.lengths()),
      states(checker.robot().dim(), Doubles16{}),
      placed(checker.robot()),
      enlarged(checker.lengths()),
      motion(checker.robot().dim()),
      waiting(MOST_WAITING),
      speeds(checker.robot()) {}

void Workspace::set(int lane, std::span<const double> q) {
  for (std::size_t k = 0; k < states.size(); k++) states[k][lane] = q[k];
}

void Workspace::set_all(std::span<const double> q) {
  for (std::size_t k = 0; k < states.size(); k++) states[k] = Doubles16{} + q[k];
}

namespace {

Mask meeting_anything(Workspace& workspace, const Lengths& lengths, Mask settled, Wanted wanted, Contact* found) {
  const Robot& robot = workspace.checker.robot();
  const Scene& scene = workspace.checker.scene();
  PlacedRobot& placed = workspace.placed;
  Mask mask = meeting_obstacles(robot, lengths, scene, placed, settled, wanted, found);
  if (is_enough(mask, wanted)) return mask;
  if (!scene.surfaces.empty()) {
    mask |= with_others(meeting_surfaces(robot, lengths, scene, placed, mask, wanted, found), wanted);
    if (is_enough(mask, wanted)) return mask;
  }
  return meeting_itself(robot, lengths, placed, mask, wanted, found);
}

Mask blocked_lanes(Workspace& workspace, const Lengths& lengths, Mask settled, Wanted wanted, Contact* found) {
  workspace.placed.move_to(workspace.checker.robot(), lengths, workspace.states);
  return meeting_anything(workspace, lengths, settled, wanted, found);
}

}  // namespace

Mask blocked_where_placed(Workspace& workspace, const Lengths& lengths, Wanted wanted) {
  workspace.begin_batch();
  return meeting_anything(workspace, lengths, 0, wanted, nullptr);
}

Mask blocked_where_placed(Workspace& workspace, Wanted wanted) {
  return blocked_where_placed(workspace, *workspace.lengths, wanted);
}

Mask blocked(Workspace& workspace, const Lengths& lengths, Wanted wanted, Mask settled) {
  workspace.begin_batch();
  return blocked_lanes(workspace, lengths, settled, wanted, nullptr);
}

Mask blocked(Workspace& workspace, Wanted wanted, Mask settled) {
  return blocked(workspace, *workspace.lengths, wanted, settled);
}

/// Write sixteen configurations, and return the mask of those that are out of bounds.
Mask take_rows(Workspace& workspace, Matrix<const double> rows, std::size_t first, std::size_t count) {
  const Joints& joints = workspace.checker.robot().joints;
  const double* row[LANES];
  // Unused lanes repeat the last row.
  for (std::size_t lane = 0; lane < LANES; lane++) row[lane] = rows[first + std::min(lane, count - 1)].data();
  Mask outside = 0;
  for (std::size_t k = 0; k < rows.columns; k++) {
    Doubles16 value{};
    for (int lane = 0; lane < LANES; lane++) value[lane] = row[lane][k];
    if (joints.wraps(k)) {
      for (int lane = 0; lane < LANES; lane++) value[lane] = wrapped(value[lane], joints, k);
    }
    // Values out of bounds may be too large for single precision.
    const double low = joints.low[k] - JOINT_SLACK, high = joints.high[k] + JOINT_SLACK;
    workspace.states[k] = ((value >= low) & (value <= high)) ? value : Doubles16{} + joints.low[k];
    outside |= below_zero(__builtin_convertvector(min(value - low, high - value), Floats16));
  }
  return outside;
}

void configurations_free(const Checker& checker, Matrix<const double> rows, std::span<bool> free) {
  if (rows.rows == 0 || checker.is_never_free()) {
    std::fill(free.begin(), free.end(), false);
    return;
  }
  const Borrowed workspace = checker.borrow();
  for (std::size_t first = 0; first < rows.rows; first += LANES) {
    const std::size_t count = std::min<std::size_t>(LANES, rows.rows - first);
    Mask taken = take_rows(*workspace, rows, first, count);
    taken |= blocked(*workspace, Wanted::ALL);
    for (std::size_t lane = 0; lane < count; lane++) free[first + lane] = (taken >> lane & 1) == 0;
  }
}

Contact find_contact(const Checker& checker, std::span<const double> q) {
  const Borrowed workspace = checker.borrow();
  workspace->set_all(q);
  Contact found;
  blocked_lanes(*workspace, checker.lengths(), 0, Wanted::FIRST, &found);
  return found;
}

}  // namespace evenroad::robot
