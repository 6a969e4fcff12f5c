// The search for the nearest node tests sixteen nodes at once.  Apart from checks, trees spend most of their time on
// it.
#include "planning/tree.hpp"

#include <algorithm>
#include <utility>

#include "common/lanes.hpp"

namespace evenroad::planning {

namespace {

constexpr int WIDTH = 16;

/// First capacity, which suffices for most queries, and later ones.  They are not powers of two, because columns would
/// then evict each other from the cache.
constexpr std::size_t FIRST_CAPACITY = 2 * WIDTH, NEXT_CAPACITY = 1040;

constexpr float FAR = 1e15F;
/// Replacement for a squared distance: larger than that of any node.
constexpr float NOT_ADMITTED = 3e38F;
constexpr double NO_PERIOD = 1e30;

}  // namespace

Tree::Tree(const robot::Joints& joints) : dim_(joints.size()), periods_(joints.size()) {
  for (std::size_t k = 0; k < dim_; k++) periods_[k] = static_cast<float>(std::min(joints.period[k], NO_PERIOD));
}

Node Tree::add(ConstConfiguration q, Node parent, double distance) {
  const Node node = size();
  nodes_.insert(nodes_.end(), q.begin(), q.end());
  costs_.push_back(parent == NO_NODE ? 0.0 : cost(parent) + distance);
  parents_.push_back(parent);
  tried_.push_back(0);
  proved_.push_back(0);
  if (parents_.size() > capacity_) enlarge();
  write_columns(node);
  return node;
}

Node Tree::nearest(ConstConfiguration q) const {
  return nearest_of(q, [](std::size_t, Floats16 squared) { return squared; });
}

Node Tree::nearest_within(ConstConfiguration q, double longest) const {
  const auto most = static_cast<float>(longest);
  return nearest_of(q, [&](std::size_t first, Floats16 squared) {
    const Floats16 left = max(most - load<Floats16>(cost_column_.data() + first), Floats16{});
    return squared <= left * left ? squared : all<Floats16>(NOT_ADMITTED);
  });
}

/// Return the node with the least squared distance after those that are not admitted were set to `NOT_ADMITTED`.
template <class Admitted>
Node Tree::nearest_of(ConstConfiguration q, Admitted admitted) const {
  float best = NOT_ADMITTED;
  std::size_t number = 0;
  bool is_any = false;
  for (std::size_t first = 0; first < parents_.size(); first += WIDTH) {
    Floats16 squared{};
    const float* column = columns_.data() + first;
    for (std::size_t k = 0; k < dim_; k++, column += capacity_) {
      Floats16 gap = abs(load<Floats16>(column) - static_cast<float>(q[k]));
      gap = min(gap, periods_[k] - gap);
      squared = fma(gap, gap, squared);
    }
    squared = admitted(first, squared);
    if (below_zero(squared - best) == 0) continue;
    is_any = true;
    best = least<float, WIDTH>(squared);
    std::size_t lane = 0;
    while (squared[lane] > best) lane++;
    number = first + lane;
  }
  return is_any ? static_cast<Node>(number) : NO_NODE;
}

Node Tree::least_tried() const {
  // Two loops, so that the compiler can vectorise the first.
  std::int64_t least = tried_[0];
  for (const std::int64_t each : tried_) least = std::min(least, each);
  return std::ranges::find(tried_, least) - tried_.begin();
}

void Tree::remove_branch(Node node) {
  std::vector<Node> moved(parents_.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parents_.size(); i++) {
    const Node parent = parents_[i];
    // Parents come before their children.
    if (std::cmp_equal(i, node) || (parent >= 0 && moved[static_cast<std::size_t>(parent)] == NO_NODE)) {
      moved[i] = NO_NODE;
      continue;
    }
    moved[i] = static_cast<Node>(kept);
    parents_[kept] = parent >= 0 ? moved[static_cast<std::size_t>(parent)] : NO_NODE;
    tried_[kept] = tried_[i], proved_[kept] = proved_[i], costs_[kept] = costs_[i];
    std::copy_n(&nodes_[i * dim_], dim_, &nodes_[kept * dim_]);
    kept++;
  }
  parents_.resize(kept), tried_.resize(kept), proved_.resize(kept), costs_.resize(kept), nodes_.resize(kept * dim_);
  std::ranges::fill(columns_, FAR), std::ranges::fill(cost_column_, FAR);
  for (std::size_t i = 0; i < kept; i++) write_columns(static_cast<Node>(i));
}

void Tree::write_columns(Node node) {
  const auto number = static_cast<std::size_t>(node);
  for (std::size_t k = 0; k < dim_; k++) columns_[k * capacity_ + number] = static_cast<float>((*this)[node][k]);
  cost_column_[number] = static_cast<float>(costs_[number]);
}

void Tree::enlarge() {
  capacity_ = capacity_ == 0 ? FIRST_CAPACITY : std::max(NEXT_CAPACITY, 2 * capacity_);
  columns_.assign(dim_ * capacity_, FAR), cost_column_.assign(capacity_, FAR);
  for (Node node = 0; node < size(); node++) write_columns(node);
}

}  // namespace evenroad::planning
