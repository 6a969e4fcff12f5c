// Leaves and nodes of trees of sixteens.
#include "robot/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace evenroad::robot {

namespace {

/// Bring the lesser ones along an axis before place `middle`, of those from `low` to `high` (C. Hoare, 1961).
void split(std::vector<Place>& places, std::vector<int>& order, int low, int high, int middle, int axis) {
  while (low < high) {
    const float a = places[low].at[axis], b = places[(low + high) / 2].at[axis], c = places[high].at[axis];
    const float pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    int i = low, k = high;
    while (i <= k) {
      while (places[i].at[axis] < pivot) i++;
      while (places[k].at[axis] > pivot) k--;
      if (i <= k) {
        std::swap(places[i], places[k]);
        std::swap(order[i++], order[k--]);
      }
    }
    if (middle <= k) {
      high = k;
    } else if (middle >= i) {
      low = i;
    } else {
      return;
    }
  }
}

BoxNode node_over(std::span<const Around> children, float wider) {
  const Floats16 nowhere = spread(NOWHERE);
  BoxNode node{{nowhere, nowhere, nowhere}, {Floats16{}, Floats16{}, Floats16{}}, Floats16{}};
  for (int lane = 0; lane < static_cast<int>(children.size()); lane++) {
    const Around& child = children[lane];
    node.centre.x[lane] = child.centre[0], node.centre.y[lane] = child.centre[1], node.centre.z[lane] = child.centre[2];
    node.half.x[lane] = child.half[0] + wider, node.half.y[lane] = child.half[1] + wider;
    node.half.z[lane] = child.half[2] + wider;
    node.radius[lane] = child.radius + wider;
  }
  return node;
}

}  // namespace

std::vector<int> order_of(std::vector<Place> places) {
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::pair<int, int>> waiting = {{0, static_cast<int>(places.size())}};
  while (!waiting.empty()) {
    const auto [first, end] = waiting.back();
    waiting.pop_back();
    if (end - first <= LANES) continue;
    int unit = LANES;
    while (unit * LANES < end - first) unit *= LANES;
    const int middle = first + ((end - first + unit - 1) / unit / 2) * unit;
    int axis = 0;
    float widest = -1;
    for (int k = 0; k < 3; k++) {
      float low = places[first].at[k], high = low;
      for (int i = first; i < end; i++) low = std::min(low, places[i].at[k]), high = std::max(high, places[i].at[k]);
      if (high - low > widest) axis = k, widest = high - low;
    }
    if (widest > 0) split(places, order, first, end - 1, middle, axis);
    waiting.emplace_back(first, middle);
    waiting.emplace_back(middle, end);
  }
  return order;
}

Around around_places(std::span<const Place> places) {
  Around made{};
  for (int axis = 0; axis < 3; axis++) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Place& place : places) low = std::min(low, place.at[axis]), high = std::max(high, place.at[axis]);
    made.centre[axis] = 0.5F * (low + high), made.half[axis] = 0.5F * (high - low);
  }
  float squared = 0;
  for (const Place& place : places) {
    float apart = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = place.at[axis] - made.centre[axis];
      apart += gap * gap;
    }
    squared = std::max(squared, apart);
  }
  made.radius = std::sqrt(squared);
  return made;
}

Around around_boxes(std::span<const Around> children, float wider) {
  Around made{};
  for (int axis = 0; axis < 3; axis++) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Around& each : children) {
      low = std::min(low, each.centre[axis] - each.half[axis]),
      high = std::max(high, each.centre[axis] + each.half[axis]);
    }
    made.centre[axis] = 0.5F * (low + high), made.half[axis] = 0.5F * (high - low) + wider;
  }
  float farthest = 0;
  for (const Around& each : children) {
    float apart = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = each.centre[axis] - made.centre[axis];
      apart += gap * gap;
    }
    farthest = std::max(farthest, std::sqrt(apart) + each.radius);
  }
  made.radius = farthest + wider;
  return made;
}

BoxTree make_box_tree(std::vector<Around> leaves, float wider) {
  BoxTree tree;
  do {
    std::vector<BoxNode> nodes;
    std::vector<Around> parents;
    for (std::size_t first = 0; first < leaves.size(); first += LANES) {
      const auto children =
          std::span<const Around>(leaves).subspan(first, std::min<std::size_t>(LANES, leaves.size() - first));
      nodes.push_back(node_over(children, wider));
      parents.push_back(around_boxes(children, wider));
    }
    tree.levels.push_back(std::move(nodes));
    leaves = std::move(parents);
  } while (leaves.size() > 1);
  return tree;
}

}  // namespace evenroad::robot
