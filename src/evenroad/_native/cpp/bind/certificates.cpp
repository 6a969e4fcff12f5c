// evenroad._native.certificates: writing a certificate.
#include <nanobind/stl/optional.h>

#include "bind/arrays.hpp"
#include "certificates/writer.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using Numbers = Array<const std::int64_t, 1>;
using namespace certificates;

std::size_t size_at(std::span<const std::int64_t> values, std::size_t at) {
  return static_cast<std::size_t>(values[at]);
}

/// The arrays of all shapes, kept as long as the nodes that look at them.
struct ShapeTables {
  ShapeTables(nb::handle points, nb::handle corners, nb::handle sizes, nb::handle numbers)
      : points(points, "points"), corners(corners, "corners"), sizes(sizes, "sizes"), numbers(numbers, "numbers") {}

  std::vector<Elements> shapes() const {
    const std::size_t count = sizes.shape(0);
    points.of_shape({points.shape(0), 3}), sizes.of_shape({count, 5}), numbers.of_shape({count, 4});
    std::vector<Elements> shapes;
    std::size_t point = 0, corner = 0;
    for (std::size_t i = 0; i < count; i++) {
      const auto row = numbers.matrix()[i];
      const auto size = sizes.matrix()[i];
      for (const std::int64_t each : row) require(each >= 0, "numbers must be >= 0");
      const std::size_t elements = size_at(row, 1), each = size_at(row, 2);
      require(elements > 0 && each > 0, "numbers must name elements with corners");
      require(size_at(row, 0) <= points.shape(0) - point && each <= (corners.size() - corner) / elements,
              "numbers must be of as many points and corners as there are");
      Elements& shape = shapes.emplace_back();
      shape.points = points.span().subspan(3 * point, 3 * size_at(row, 0));
      shape.corners = corners.span().subspan(corner, elements * each);
      require_below(shape.corners, size_at(row, 0), "corners");
      point += size_at(row, 0), corner += elements * each;
      shape.count = elements, shape.radius = size[0], shape.disc = size[1];
      shape.is_box = row[3] != 0 && elements == 1 && each == 8;
      for (int axis = 0; axis < 3; axis++) {
        shape.axis[axis] = size[2 + static_cast<std::size_t>(axis)];
      }
    }
    return shapes;
  }

  FloatRows points;
  Numbers corners;
  FloatRows sizes;
  Array<const std::int64_t, 2> numbers;
};

/// The arrays of the joints that move frames.
struct JointTables {
  JointTables(nb::handle links, nb::handle poses, nb::handle rules)
      : links(links, "links"), poses(poses, "poses"), rules(rules, "rules") {
    const std::size_t count = this->links.shape(0);
    this->links.of_shape({count, 3}), this->poses.of_shape({count, 15}), this->rules.of_shape({count, 2});
    for (std::size_t k = 0; k < count; k++) {
      const auto row = this->links.matrix()[k];
      require_below(row[0], k + 1, "parents");
      parent.push_back(row[0]), column.push_back(row[1]), slides.push_back(row[2] != 0);
      const auto pose = this->poses.matrix()[k];
      turn.insert(turn.end(), pose.begin(), pose.begin() + 9);
      shift.insert(shift.end(), pose.begin() + 9, pose.begin() + 12);
      axis.insert(axis.end(), pose.begin() + 12, pose.end());
      factor.push_back(this->rules.matrix()(k, 0)), offset.push_back(this->rules.matrix()(k, 1));
    }
  }

  Frames frames() const { return {parent, column, turn, shift, axis, factor, offset, slides}; }

  Array<const std::int64_t, 2> links;
  FloatRows poses, rules;
  std::vector<std::int64_t> parent, column;
  std::vector<double> turn, shift, axis, factor, offset;
  std::vector<std::uint8_t> slides;
};

/// The answers and directions of a certificate, or where a pair touches.
struct Answers {
  nb::object answers, directions;
  Touch touch;
};

/// Curves of three control points, (n, 3, joints), how far joints are from them, and constraints that these keep.
///
/// Of an axis `numbers` have the axis, the direction and zeros; of a point itself, zeros, the rows of the box's
/// directions, and its low and high ends.
struct Paths {
  Paths(nb::handle curves, double tolerance, nb::handle frames, nb::handle limits, nb::handle numbers)
      : curves(curves, "curves"), tolerance(tolerance) {
    this->curves.of_shape({this->curves.shape(0), 3, this->curves.shape(2)});
    require(this->curves.shape(0) < (std::size_t{1} << 20) && joints() > 0, "curves must be fewer than 2^20");
    const Array<const std::int64_t, 2> rows(frames, "frames");
    const Floats limit(limits, "limits");
    const FloatRows values(numbers, "numbers");
    rows.of_shape({limit.size(), 2}), values.of_shape({limit.size(), 21});
    for (std::size_t i = 0; i < limit.size(); i++) {
      const auto row = values.matrix()[i];
      const auto vector = [&](std::size_t at) { return Vector{row[at], row[at + 1], row[at + 2]}; };
      const KeptKind kind = rows.matrix()(i, 1) == 0 ? KeptKind::AXIS : KeptKind::POINT;
      kept.push_back({kind, rows.matrix()(i, 0), limit.span()[i], vector(0), vector(3),
                      Turn{vector(6), vector(9), vector(12)}, vector(15), vector(18)});
    }
  }

  std::size_t joints() const { return curves.shape(2); }

  Array<const double, 3> curves;
  double tolerance;
  std::vector<Kept> kept;
};

std::optional<Answers> write_answers(const ShapeTables& tables, const JointTables& moving, nb::handle nodes,
                                     nb::handle shapes, nb::handle pairs, nb::handle keeps, const Paths& paths,
                                     std::int64_t most) {
  require_below(most, std::size_t{1} << 24, "most");
  require_below(std::span(moving.column), paths.joints(), "columns");
  for (const Kept& each : paths.kept) {
    require(each.frame >= 0 && static_cast<std::size_t>(each.frame) <= moving.parent.size(), "frames must exist");
  }
  const Array<const std::int64_t, 2> rows(nodes, "nodes"), both(pairs, "pairs");
  const Numbers members(shapes, "shapes");
  const Floats keep(keeps, "keeps");
  rows.of_shape({rows.shape(0), 3}), both.of_shape({keep.size(), 2});
  require_below(members.span(), tables.sizes.shape(0), "shapes");
  require_below(both.span(), rows.shape(0), "pairs");
  Nodes all(tables.shapes());
  for (std::size_t i = 0; i < rows.shape(0); i++) {
    const auto row = rows.matrix()[i];
    require_below(row[0], moving.parent.size() + 1, "frames");
    require(row[1] >= 0 && row[2] > row[1] && size_at(row, 2) <= members.size(), "nodes must have shapes");
    all.add_whole(row[0], members.span().subspan(size_at(row, 1), size_at(row, 2) - size_at(row, 1)));
  }
  std::vector<Pair> every;
  for (std::size_t i = 0; i < keep.size(); i++)
    every.push_back({both.matrix()(i, 0), both.matrix()(i, 1), keep.span()[i]});
  Written written;
  try {
    written = without_gil([&] {
      Motions motions(moving.frames(), {paths.curves.span(), paths.joints()}, paths.tolerance);
      return write(all, motions, paths.curves.shape(0), every, paths.kept, static_cast<std::size_t>(most));
    });
  } catch (const TooLong&) {
    return std::nullopt;
  }
  return Answers{as_row(std::move(written.answers)), as_rows(std::move(written.directions), 3), written.touch};
}

}  // namespace

void add_certificates(nb::module_& module) {
  nb::module_ part = module.def_submodule("certificates", "Writing a certificate.");
  nb::class_<ShapeTables>(part, "ShapeTables")
      .def(nb::init<nb::handle, nb::handle, nb::handle, nb::handle>(), "points"_a.none(), "corners"_a.none(),
           "sizes"_a.none(), "numbers"_a.none());
  nb::class_<JointTables>(part, "JointTables")
      .def(nb::init<nb::handle, nb::handle, nb::handle>(), "links"_a.none(), "poses"_a.none(), "rules"_a.none());
  nb::class_<Paths>(part, "Paths")
      .def(nb::init<nb::handle, double, nb::handle, nb::handle, nb::handle>(), "curves"_a.none(), "tolerance"_a,
           "frames"_a.none(), "limits"_a.none(), "numbers"_a.none());
  nb::class_<Touch>(part, "Touch")
      .def_ro("motion", &Touch::motion)
      .def_ro("share", &Touch::share)
      .def_ro("pair", &Touch::pair)
      .def_ro("gap", &Touch::gap)
      .def_ro("most", &Touch::most);
  nb::class_<Answers>(part, "Answers")
      .def_ro("answers", &Answers::answers)
      .def_ro("directions", &Answers::directions)
      .def_ro("touch", &Answers::touch);
  part.def("write_answers", &write_answers, "shape_tables"_a, "joint_tables"_a, "nodes"_a.none(), "shapes"_a.none(),
           "pairs"_a.none(), "keeps"_a.none(), "paths"_a, "most"_a);
}

}  // namespace evenroad::bind
