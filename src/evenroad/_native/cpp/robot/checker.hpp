// A robot in a scene, and the memory in which one thread checks its configurations and motions.
//
// `planning/motion_checks.hpp` is the interface of planners (trees, smoothing, roadmaps) to it.  The checks of one
// thread are these:
//
//   const Borrowed workspace = checker.borrow();    memory, given back at the end of the scope
//   workspace->set(lane, q), ->set_all(q)           write configurations, within bounds, into the sixteen lanes
//   blocked(*workspace, Wanted::ALL)                which of the sixteen touch something, as bits
//   motion_free, motion_proved, is_shortcut         one motion, see motion_check.hpp
//   enter, bring_inside, write_direction            limits and the short way, see joints.hpp
//   workspace->counts                               how many motions, configurations and batches were checked
//   workspace->judge_by(&checker.wider(margin))     larger bodies until judge_by(nullptr)
//
// Results depend only on the arguments, not on earlier uses of the workspace.  After a workspace is made, nothing here
// allocates memory, and nothing throws except when the time is over.
#pragma once

#include <memory>
#include <mutex>

#include "common/time_limit.hpp"
#include "robot/motion.hpp"
#include "robot/self_contact.hpp"
#include "robot/speeds.hpp"
#include "robot/surface_contact.hpp"

namespace evenroad::robot {

/// Numbers of checks: motions, configurations, and batches of sixteen.
struct Counts {
  std::int64_t motions = 0, configurations = 0, batches = 0;
};

/// Number of batches between two looks at the clock.  A look takes a hundredth of the time of a batch.
inline constexpr int BATCHES_A_LOOK = 4;

struct Workspace;
class Checker;

/// Gives a workspace back to its checker.
struct Return {
  const Checker* checker;
  void operator()(Workspace* workspace) const;
};
using Borrowed = std::unique_ptr<Workspace, Return>;

class Checker {
 public:
  /// Bodies are larger by `clearance` for obstacles.  Nothing is free if `touches_itself` (bodies that no joint moves
  /// relative to each other touch), or if a fixed body touches the scene.
  Checker(std::shared_ptr<const Robot> robot, std::shared_ptr<const Scene> scene, double resolution, double clearance,
          bool touches_itself);
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;
  ~Checker();

  const Robot& robot() const { return *robot_; }
  std::size_t dim() const { return static_cast<std::size_t>(robot_->dim()); }
  const Scene& scene() const { return *scene_; }
  const Lengths& lengths() const { return lengths_; }
  double resolution() const { return resolution_; }  // largest distance between neighbouring states of a motion
  const Contact& fixed_contact() const { return fixed_contact_; }  // of fixed bodies with the scene
  bool is_never_free() const { return never_free_; }

  /// Return lengths larger by a margin, for obstacles only; they live as long as the checker.
  const Lengths& wider(float margin) const;

  /// Return the memory of one thread: one that was returned before, or a new one.
  Borrowed borrow() const;

 private:
  friend struct Return;
  std::shared_ptr<const Robot> robot_;
  std::shared_ptr<const Scene> scene_;
  double resolution_;
  Lengths lengths_;
  Contact fixed_contact_;
  bool never_free_;
  mutable std::mutex guard_;
  mutable std::vector<std::unique_ptr<Workspace>> free_;
  mutable std::vector<std::pair<float, std::unique_ptr<Lengths>>> wider_;
};

/// The memory of one thread's checks of a checker.
struct Workspace {
  explicit Workspace(const Checker& checker);

  /// Write a configuration, within bounds, into one of the sixteen lanes, or into all.
  void set(int lane, std::span<const double> q);
  void set_all(std::span<const double> q);

  /// Check states with these lengths, which must outlive the checks; null means those of the checker.
  void judge_by(const Lengths* other) { lengths = other != nullptr ? other : &checker.lengths(); }

  const Checker& checker;
  const Lengths* lengths;         // that decide states
  std::vector<Doubles16> states;  // sixteen configurations: sixteen numbers a coordinate
  PlacedRobot placed;
  Lengths enlarged;  // that decide stretches of a motion in a proof
  Motion motion;
  std::vector<Interval> waiting;
  Speeds speeds;
  Counts counts;
  ClockWatch clock{BATCHES_A_LOOK};

  /// Count a batch of sixteen; throw if the time is over.
  void begin_batch() {
    counts.batches++;
    clock.look();
  }
};

/// Write rows, (n, dim), from number `first` on into the lanes.  Return the mask of those out of bounds, which are
/// brought within.
Mask take_rows(Workspace& workspace, Matrix<const double> rows, std::size_t first, std::size_t count);

/// Return the mask of the sixteen states that touch something or are settled, with those wanted together with them.
/// With Wanted::FIRST, only some of them are found.
Mask blocked(Workspace& workspace, Wanted wanted, Mask settled = 0);
Mask blocked(Workspace& workspace, const Lengths& lengths, Wanted wanted, Mask settled = 0);

/// The same if the workspace's placed robot already has these states.
Mask blocked_where_placed(Workspace& workspace, Wanted wanted);
Mask blocked_where_placed(Workspace& workspace, const Lengths& lengths, Wanted wanted);

/// Write which rows, (n, dim), are within bounds and free.
void configurations_free(const Checker& checker, Matrix<const double> rows, std::span<bool> free);

/// Return the first contact at a configuration within bounds.
Contact find_contact(const Checker& checker, std::span<const double> q);

}  // namespace evenroad::robot
