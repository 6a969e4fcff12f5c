// Nodes of a certificate, and their halves.
#include "certificates/nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/lanes.hpp"

namespace evenroad::certificates {

namespace {

constexpr double PER_METRE = 1048576.0;  // steps to which the middles of elements are rounded

Vector vector_at(const std::vector<double>& values, std::int64_t row) {
  const std::size_t at = 3 * static_cast<std::size_t>(row);
  return {values[at], values[at + 1], values[at + 2]};
}

/// Return the axis along which some points reach farthest, the first of several.
int widest_axis(const std::vector<Vector>& points) {
  int widest = 0;
  double most = -1.0;
  for (int axis = 0; axis < 3; axis++) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vector& each : points) low = std::min(low, each[axis]), high = std::max(high, each[axis]);
    if (high - low > most) most = high - low, widest = axis;
  }
  return widest;
}

using Eight = Lanes<double, 8>;

/// Find the different corners of the elements of a part.
void find_corners(Part& part) {
  const Elements& shape = *part.shape;
  const std::size_t each = shape.corners.size() / shape.count;
  std::vector<std::int64_t> numbers;
  numbers.reserve(part.rows.size() * each);
  for (const std::int64_t row : part.rows) {
    const auto from = shape.corners.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * each);
    numbers.insert(numbers.end(), from, from + static_cast<std::ptrdiff_t>(each));
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  part.count = numbers.size();
  part.corners.resize(24 * ((numbers.size() + 7) / 8));
  for (std::size_t i = 0; i < part.corners.size() / 3; i++) {
    const Vector at = vector_at(shape.points, numbers[std::min(i, numbers.size() - 1)]);
    for (std::size_t axis = 0; axis < 3; axis++) part.corners[i / 8 * 24 + 8 * axis + i % 8] = at[axis];
  }
}

/// Return the number of the corner that is farthest along a functional, of which the first of several.
std::size_t farthest_of(const Part& part, const Vector& along) {
  constexpr double NONE = -std::numeric_limits<double>::infinity();
  if (part.count <= 4) {
    std::size_t best = 0;
    double most = NONE;
    for (std::size_t i = 0; i < part.count; i++) {
      const double far = dot(part.corner(i), along);
      if (far > most) most = far, best = i;
    }
    return best;
  }
  Eight most = all<Eight>(NONE);
  Lanes<std::int64_t, 8> best{};
  for (std::size_t from = 0; from < part.corners.size(); from += 24) {
    const double* const at = part.corners.data() + from;
    const Eight far = load<Eight>(at) * along[0] + load<Eight>(at + 8) * along[1] + load<Eight>(at + 16) * along[2];
    const auto is_farther = far > most;
    most = is_farther ? far : most;
    best = is_farther ? all<Lanes<std::int64_t, 8>>(static_cast<std::int64_t>(from / 3)) : best;
  }
  std::size_t lane = 0;
  for (std::size_t i = 1; i < 8; i++) {
    if (most[i] > most[lane] || (most[i] == most[lane] && best[i] < best[lane])) lane = i;
  }
  return static_cast<std::size_t>(best[lane]) + lane;
}

std::vector<Part> whole(const std::vector<std::shared_ptr<const Elements>>& shapes) {
  std::vector<Part> parts;
  for (const auto& shape : shapes) {
    Part& part = parts.emplace_back();
    part.shape = shape;
    part.rows.resize(shape->count);
    std::iota(part.rows.begin(), part.rows.end(), std::int64_t{0});
  }
  return parts;
}

Vector middle(const Elements& elements, std::int64_t row) {
  const std::size_t each = elements.corners.size() / elements.count;
  Vector sum{};
  for (std::size_t i = 0; i < each; i++) {
    sum = sum + vector_at(elements.points, elements.corners[static_cast<std::size_t>(row) * each + i]);
  }
  for (double& value : sum.at) value /= static_cast<double>(each);
  return sum;
}

}  // namespace

Node::Node(std::int64_t frame, const std::vector<std::shared_ptr<const Elements>>& shapes)
    : Node(frame, whole(shapes)) {}

Node::Node(std::int64_t in_frame, std::vector<Part>&& parts) : frame(in_frame), parts_(std::move(parts)) {
  constexpr double FAR = std::numeric_limits<double>::infinity();
  Vector low{FAR, FAR, FAR}, high{-FAR, -FAR, -FAR};
  for (Part& part : parts_) {
    const Elements& shape = *part.shape;
    elements += part.rows.size();
    find_corners(part);
    corners += part.count;
    for (std::size_t i = 0; i < part.count; i++) {
      const Vector at = part.corner(i);
      reach = std::max(reach, std::sqrt(squared_length(at)) + shape.radius + shape.disc);
      for (int axis = 0; axis < 3; axis++) {
        const double aside = 1.0 - shape.axis[axis] * shape.axis[axis];
        const double wide = shape.radius + shape.disc * std::sqrt(std::max(0.0, aside));
        low[axis] = std::min(low[axis], at[axis] - wide), high[axis] = std::max(high[axis], at[axis] + wide);
      }
    }
  }
  centre = (low + high) * 0.5;
  for (int axis = 0; axis < 3; axis++) box[axis][axis] = 0.5 * (high[axis] - low[axis]);
  if (parts_.size() != 1 || !parts_[0].shape->is_box) return;
  const Elements& shape = *parts_[0].shape;
  const auto corner = [&](int number) {
    return vector_at(shape.points, shape.corners[static_cast<std::size_t>(number)]);
  };
  centre = (corner(0) + corner(7)) * 0.5;
  for (int axis = 0; axis < 3; axis++) {
    const Vector edge = (corner(4 >> axis) - corner(0)) * 0.5;
    box[axis] = edge * (1.0 + shape.radius / std::max(std::sqrt(squared_length(edge)), 1e-12));
  }
}

const Node& Node::half(int side) const {
  std::call_once(halved_, [this] { halve(); });
  return *halves_[side];
}

void Node::halve() const {
  // Rounded: programs that differ in a last bit choose one axis, and order the elements alike.  Ties are in the order
  // of the file.
  std::vector<Vector> middles;
  for (const Part& part : parts_) {
    for (const std::int64_t row : part.rows) {
      Vector& rounded = middles.emplace_back(middle(*part.shape, row));
      for (double& value : rounded.at) value = std::rint(PER_METRE * value);
    }
  }
  std::vector<double> along;
  const int axis = widest_axis(middles);
  for (const Vector& each : middles) along.push_back(each[axis]);
  std::vector<std::size_t> order(along.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return along[a] < along[b]; });
  std::vector<char> is_first(order.size());
  for (std::size_t i = 0; i < order.size() / 2; i++) is_first[order[i]] = 1;
  std::vector<Part> sides[2];
  std::size_t element = 0;
  for (const Part& part : parts_) {
    Part split[2];
    split[0].shape = split[1].shape = part.shape;
    for (const std::int64_t row : part.rows) split[is_first[element++] != 0 ? 0 : 1].rows.push_back(row);
    for (int each = 0; each < 2; each++) {
      if (!split[each].rows.empty()) sides[each].push_back(std::move(split[each]));
    }
  }
  for (int each = 0; each < 2; each++) halves_[each] = std::make_unique<const Node>(frame, std::move(sides[each]));
}

Vector Node::farthest(const Vector& along) const {
  double best = -std::numeric_limits<double>::infinity(), best_aside = 0.0, size = 0.0;
  const Part* found = nullptr;
  Vector here{}, across{};
  for (const Part& part : parts_) {
    const Elements& shape = *part.shape;
    const Vector at = part.corner(farthest_of(part, along));
    double far = dot(at, along), aside = 0.0;
    Vector beside{};
    if (shape.radius > 0.0) {
      if (size == 0.0) size = std::sqrt(squared_length(along));
      far += shape.radius * size;
    }
    if (shape.disc > 0.0) {
      beside = along - shape.axis * dot(along, shape.axis);
      aside = std::sqrt(squared_length(beside));
      far += shape.disc * aside;
    }
    if (far > best) best = far, best_aside = aside, found = &part, here = at, across = beside;
  }
  if (found == nullptr) return here;
  const Elements& shape = *found->shape;
  if (shape.radius > 0.0) here = here + along * (shape.radius / size);
  if (shape.disc > 0.0 && squared_length(across) > 1e-24 * squared_length(along)) {
    here = here + across * (shape.disc / best_aside);
  }
  return here;
}

double Node::box_reach(const Vector& along) const {
  return dot(along, centre) + std::abs(dot(along, box[0])) + std::abs(dot(along, box[1])) +
         std::abs(dot(along, box[2]));
}

}  // namespace evenroad::certificates
