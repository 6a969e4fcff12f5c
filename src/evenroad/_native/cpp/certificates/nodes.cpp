// Nodes of a certificate, and their halves.
#include "certificates/nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "common/lanes.hpp"

namespace evenroad::certificates {

namespace {

constexpr double PER_METRE = 1048576.0;  // steps to which the middles of elements are rounded
constexpr double FAR = std::numeric_limits<double>::infinity();
constexpr std::size_t EIGHT = 8, GROUP = 128;  // points of a group

using Eight = Lanes<double, 8>;

struct Box {
  Vector low{FAR, FAR, FAR}, high{-FAR, -FAR, -FAR};

  void add(const Vector& point) {
    for (std::size_t axis = 0; axis < 3; axis++) {
      low[axis] = std::min(low[axis], point[axis]), high[axis] = std::max(high[axis], point[axis]);
    }
  }
};

/// Return the axis along which some points reach farthest, the first of several.
std::size_t widest_axis(std::span<const Vector> points) {
  Box box;
  for (const Vector& point : points) box.add(point);
  const Vector wide = box.high - box.low;
  return static_cast<std::size_t>(std::max_element(wide.begin(), wide.end()) - wide.begin());
}

/// Order points so that the points of each group, of two groups, of four and so on are near each other.
void order_by_position(std::span<Vector> points) {
  if (points.size() <= GROUP) return;
  const std::size_t axis = widest_axis(points);
  std::size_t left = GROUP;
  while (2 * left < points.size()) left *= 2;
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(left), points.end(),
                   [&](const Vector& a, const Vector& b) { return a[axis] < b[axis]; });
  order_by_position(points.first(left)), order_by_position(points.subspan(left));
}

/// Write a row of vectors as eight x, eight y, eight z and so on; the last one of each row is repeated.
void write_lanes(std::span<const Vector> rows, std::size_t stride, std::size_t at, std::vector<double>& lanes) {
  lanes.resize(stride * ((rows.size() + EIGHT - 1) / EIGHT), 0.0);
  for (std::size_t i = 0; i < lanes.size() / stride * EIGHT; i++) {
    const Vector& row = rows[std::min(i, rows.size() - 1)];
    for (std::size_t axis = 0; axis < 3; axis++)
      lanes[i / EIGHT * stride + (at + axis) * EIGHT + i % EIGHT] = row[axis];
  }
}

EVENROAD_INLINE Eight along_lanes(const double* at, const Vector& along) {
  return load<Eight>(at) * along[0] + load<Eight>(at + EIGHT) * along[1] + load<Eight>(at + 2 * EIGHT) * along[2];
}

Vector vector_at(const std::vector<double>& values, std::int64_t row) {
  const std::size_t at = 3 * static_cast<std::size_t>(row);
  return {values[at], values[at + 1], values[at + 2]};
}

/// Return the corners of the elements of a part, each once.
std::vector<Vector> corners_of(const Part& part) {
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
  std::vector<Vector> corners;
  corners.reserve(numbers.size());
  for (const std::int64_t number : numbers) corners.push_back(vector_at(shape.points, number));
  return corners;
}

bool are_rounded_alike(const Elements& a, const Elements& b) {
  return a.radius == b.radius && a.disc == b.disc && (a.disc == 0.0 || squared_length(a.axis - b.axis) == 0.0);
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

Corners::Corners(std::vector<Vector>&& points) {
  order_by_position(points);
  write_lanes(points, 3 * EIGHT, 0, points_);
  std::vector<Box> below((points.size() + GROUP - 1) / GROUP);
  for (std::size_t i = 0; i < points.size(); i++) below[i / GROUP].add(points[i]);
  while (below.size() > 1) {
    std::vector<Vector> middles, halves;
    std::vector<Box> boxes((below.size() + EIGHT - 1) / EIGHT);
    for (std::size_t i = 0; i < below.size(); i++) {
      middles.push_back((below[i].low + below[i].high) * 0.5), halves.push_back((below[i].high - below[i].low) * 0.5);
      boxes[i / EIGHT].add(below[i].low), boxes[i / EIGHT].add(below[i].high);
    }
    counts_.push_back(below.size());
    std::vector<double>& level = boxes_.emplace_back();
    write_lanes(middles, 6 * EIGHT, 0, level), write_lanes(halves, 6 * EIGHT, 3, level);
    below = std::move(boxes);
  }
}

void Corners::look(std::size_t group, const Vector& along, Found& found) const {
  const std::size_t first = 3 * GROUP * group, end = std::min(points_.size(), first + 3 * GROUP);
  Eight most = along_lanes(points_.data() + first, along);
  Lanes<std::int64_t, 8> best = all<Lanes<std::int64_t, 8>>(static_cast<std::int64_t>(first));
  for (std::size_t from = first + 3 * EIGHT; from < end; from += 3 * EIGHT) {
    const Eight far = along_lanes(points_.data() + from, along);
    best = far > most ? all<Lanes<std::int64_t, 8>>(static_cast<std::int64_t>(from)) : best;
    most = far > most ? far : most;
  }
  const double farthest = -least<double, 8>(-most);
  if (!(farthest > found.most)) return;
  std::size_t lane = 0;
  while (lane + 1 < EIGHT && most[lane] != farthest) lane++;
  const double* const at = points_.data() + best[lane] + lane;
  found = {farthest, {at[0], at[EIGHT], at[2 * EIGHT]}};
}

void Corners::visit(std::size_t level, std::size_t number, const Vector& along, Found& found) const {
  if (level == 0) return look(number, along, found);
  const double* const at = boxes_[level - 1].data() + 6 * EIGHT * number;
  const Vector aside{std::abs(along[0]), std::abs(along[1]), std::abs(along[2])};
  double far[EIGHT];
  store(far, along_lanes(at, along) + along_lanes(at + 3 * EIGHT, aside));
  // What reaches farthest is looked at first; the last boxes of a row may be repeated.
  const std::size_t first = EIGHT * number, count = std::min(EIGHT, counts_[level - 1] - first);
  const auto best = static_cast<std::size_t>(std::max_element(far, far + count) - far);
  if (far[best] > found.most) visit(level - 1, first + best, along, found);
  for (std::size_t i = 0; i < count; i++) {
    if (i != best && far[i] > found.most) visit(level - 1, first + i, along, found);
  }
}

Vector Corners::farthest(const Vector& along) const {
  Found found{-FAR, {}};
  visit(boxes_.size(), 0, along, found);
  return found.at;
}

Node::Node(std::int64_t frame, const std::vector<std::shared_ptr<const Elements>>& shapes)
    : Node(frame, whole(shapes)) {}

Node::Node(std::int64_t in_frame, std::vector<Part>&& parts) : frame(in_frame), parts_(std::move(parts)) {
  Vector low{FAR, FAR, FAR}, high{-FAR, -FAR, -FAR};
  std::vector<std::pair<const Elements*, std::vector<Vector>>> alike;
  for (const Part& part : parts_) {
    const Elements& shape = *part.shape;
    elements += part.rows.size();
    const std::vector<Vector> all = corners_of(part);
    corners += all.size();
    for (const Vector& at : all) {
      reach = std::max(reach, std::sqrt(squared_length(at)) + shape.radius + shape.disc);
      for (int axis = 0; axis < 3; axis++) {
        const double aside = 1.0 - shape.axis[axis] * shape.axis[axis];
        const double wide = shape.radius + shape.disc * std::sqrt(std::max(0.0, aside));
        low[axis] = std::min(low[axis], at[axis] - wide), high[axis] = std::max(high[axis], at[axis] + wide);
      }
    }
    auto same = std::find_if(alike.begin(), alike.end(),
                             [&](const auto& each) { return are_rounded_alike(*each.first, shape); });
    if (same == alike.end()) same = alike.insert(same, {&shape, {}});
    same->second.insert(same->second.end(), all.begin(), all.end());
  }
  for (auto& [shape, points] : alike) {
    rounded_.push_back({shape->radius, shape->disc, shape->axis, Corners(std::move(points))});
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
  const std::size_t axis = widest_axis(middles);
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
  if (rounded_.size() == 1 && rounded_[0].radius == 0.0 && rounded_[0].disc == 0.0) {
    return rounded_[0].corners.farthest(along);
  }
  const double size = std::sqrt(squared_length(along));
  double best = -FAR;
  Vector found{};
  for (const Rounded& each : rounded_) {
    Vector at = each.corners.farthest(along);
    if (each.radius > 0.0) at = at + along * (each.radius / size);
    if (each.disc > 0.0) {
      const Vector across = along - each.axis * dot(along, each.axis);
      const double aside = std::sqrt(squared_length(across));
      if (aside > 1e-12 * size) at = at + across * (each.disc / aside);
    }
    const double far = dot(at, along);
    if (far > best) best = far, found = at;
  }
  return found;
}

double Node::box_reach(const Vector& along) const {
  return dot(along, centre) + std::abs(dot(along, box[0])) + std::abs(dot(along, box[1])) +
         std::abs(dot(along, box[2]));
}

}  // namespace evenroad::certificates
