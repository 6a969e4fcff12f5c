// The workspace is laid out as `evenroad.robot.kernel.motion_checks.checks_of` does.
#include "planning/compiled_checks.hpp"

#include <cstring>
#include <utility>

// NOLINTBEGIN(performance-*,readability-*,bugprone-implicit-*): what is between programs of two languages.

namespace evenroad::planning {

namespace {

using MotionCheck = std::int64_t (*)(const double* a, const double* b, std::int64_t kind, double tolerance,
                                     std::int64_t most_batches, double resolution, std::int64_t* workspace);
using StateCheck = std::int64_t (*)(float* scratch, std::int64_t hulls, const std::int64_t* tables, const float* table,
                                    std::int64_t enough);

/// As numbered by `motion_checks.py`.
enum Kind : std::int64_t { NO_ENDPOINT, START, BOTH_ENDPOINTS, COARSE, SHORTCUT, PROOF, STATES };

/// Places in the tables' header, see `layout.py`.
enum Header { CAPSULES = 1, BLOCKS = 7, BLOCK_FLOATS = 22, INTEGERS = 23, COORDINATES = 24, PAIRS = 25, SCRATCH = 26 };

constexpr std::int64_t LANE_COUNT = LANES, WORKSPACE = 16, BLOCK_FLOAT_ROW = 6 * LANE_COUNT;
constexpr int ADDRESS_OF_TABLE = 5;

/// Memory that this thread's last checks worked in: taken anew it costs as much as a short motion.
thread_local std::vector<double> spare;

std::int64_t address(const void* pointer) { return reinterpret_cast<std::int64_t>(pointer); }

std::int64_t* workspace_of(std::vector<double>& memory) { return reinterpret_cast<std::int64_t*>(memory.data()); }

const float* table_of(const CompiledWorld& world) {
  return reinterpret_cast<const float*>(world.tables + world.tables[INTEGERS]);
}

}  // namespace

CompiledChecks::CompiledChecks(CompiledWorld world) : world_(std::move(world)), memory_(std::move(spare)) {
  const std::int64_t* header = world_.tables;
  const std::int64_t dim = header[COORDINATES], capsules = header[CAPSULES];
  const auto joints_size = static_cast<std::size_t>(dim);
  joints = {
      {world_.by_joint, joints_size}, {world_.by_joint + dim, joints_size}, {world_.by_joint + 2 * dim, joints_size}};
  resolution = world_.resolution;
  if (memory_.size() < world_.room) memory_.resize(world_.room);
  std::int64_t* workspace = workspace_of(memory_);
  // Lanes begin on a cache line.
  const std::int64_t states = (address(workspace) + 8 * WORKSPACE + 63) / 64 * 64,
                     scratch = states + 8 * LANE_COUNT * dim;
  // Behind the places the check of sixteen keeps where hulls are decided.
  const std::int64_t enlarged = scratch + 4 * header[SCRATCH] + 64;
  const std::int64_t floats = header[BLOCK_FLOATS] + BLOCK_FLOAT_ROW * header[BLOCKS];
  const float* table = table_of(world_);
  std::memcpy(reinterpret_cast<void*>(enlarged), table, static_cast<std::size_t>(4 * floats));
  const double* arms = world_.by_joint + 3 * dim;
  const std::int64_t entries[] = {world_.checks[1],
                                  address(world_.by_joint),
                                  states,
                                  address(&counts),
                                  address(world_.tables),
                                  address(table),
                                  address(arms),
                                  address(arms + dim * capsules),
                                  scratch,
                                  enlarged,
                                  enlarged + (4 * floats + 7) / 8 * 8,
                                  dim,
                                  capsules,
                                  header[PAIRS]};
  std::memcpy(workspace, entries, sizeof entries);
  states_ = {reinterpret_cast<double*>(states), static_cast<std::size_t>(LANE_COUNT * dim)};
  const auto check = reinterpret_cast<StateCheck>(world_.checks[1]);
  check(reinterpret_cast<float*>(scratch), world_.checks[2], world_.tables, table, 0);
}

CompiledChecks::~CompiledChecks() {
  if (spare.size() < memory_.size()) spare = std::move(memory_);
}

Touching CompiledChecks::touching() { return {static_cast<std::uint32_t>(ask({}, {}, STATES, {}))}; }

bool CompiledChecks::is_free(ConstConfiguration a, ConstConfiguration b, Known known) {
  return ask(a, b, static_cast<std::int64_t>(known), {}) != 0;
}

bool CompiledChecks::is_free_coarsely(ConstConfiguration a, ConstConfiguration b) { return ask(a, b, COARSE, {}) != 0; }

bool CompiledChecks::is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return ask(a, b, PROOF, limits) != 0;
}

bool CompiledChecks::is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return ask(a, b, SHORTCUT, limits) != 0;
}

void CompiledChecks::keep_away(double margin) {
  const float* table = table_of(world_);
  for (const auto& [known, wider] : world_.wider) {
    if (known == margin) table = wider;
  }
  workspace_of(memory_)[ADDRESS_OF_TABLE] = address(table);
}

std::int64_t CompiledChecks::ask(ConstConfiguration a, ConstConfiguration b, std::int64_t kind, ProofLimits limits) {
  const auto check = reinterpret_cast<MotionCheck>(world_.checks[0]);
  return check(a.data(), b.data(), kind, limits.tolerance, limits.batches, resolution, workspace_of(memory_));
}

}  // namespace evenroad::planning
// NOLINTEND(performance-*,readability-*,bugprone-implicit-*)
