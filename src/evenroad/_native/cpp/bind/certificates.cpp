// evenroad._native.certificates: writing a certificate.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string_view.h>

#include "bind/arrays.hpp"
#include "certificates/text.hpp"
#include "certificates/writer.hpp"
#include "trajectory/parabolas.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using namespace certificates;

/// Make elements of points, (p, 3), and the numbers of their corners, (n, c).
void make_elements(Elements* self, nb::handle points, nb::handle corners, double radius, double disc, nb::handle axis,
                   bool is_box) {
  const FloatRows rows = float_rows(points, "points", 3);
  const Array<const std::int64_t, 2> numbers(corners, "corners");
  const Floats along(axis, "axis");
  along.of_shape({3});
  require(numbers.size() > 0, "corners must be of one element or more");
  require_below(numbers.span(), rows.shape(0), "corners");
  const auto [coordinates, number, x] = std::tuple(rows.span(), numbers.span(), along.span());
  const std::size_t count = numbers.shape(0);
  new (self) Elements{{coordinates.begin(), coordinates.end()},
                      {number.begin(), number.end()},
                      count,
                      radius,
                      disc,
                      Vector{x[0], x[1], x[2]},
                      is_box && count == 1 && numbers.shape(1) == 8};
}

/// Make a node of whole shapes.
void make_node(Node* self, std::int64_t frame, nb::sequence shapes) {
  std::vector<std::shared_ptr<const Elements>> all;
  for (nb::handle each : shapes) all.push_back(value_of<std::shared_ptr<Elements>>(each, "shapes"));
  require(frame >= 0 && !all.empty(), "a node must be of a frame, and have shapes");
  new (self) Node(frame, all);
}

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

std::optional<Answers> write_answers(const JointTables& moving, nb::sequence pairs, const Paths& paths,
                                     std::int64_t most) {
  require_below(most, std::size_t{1} << 24, "most");
  require_below(std::span(moving.column), paths.joints(), "columns");
  for (const Kept& each : paths.kept) require_below(each.frame, moving.parent.size() + 1, "frames");
  std::vector<Pair> every;
  for (nb::handle each : pairs) {
    const Pair& pair = every.emplace_back(value_of<Pair>(each, "pairs"));
    for (const auto& node : {pair.first, pair.second}) require_below(node->frame, moving.parent.size() + 1, "frames");
  }
  Written written;
  try {
    written = without_gil([&] {
      Motions motions(moving.frames(), {paths.curves.span(), paths.joints()}, paths.tolerance);
      return write(motions, paths.curves.shape(0), every, paths.kept, static_cast<std::size_t>(most));
    });
  } catch (const TooLong&) {
    return std::nullopt;
  }
  return Answers{as_row(std::move(written.answers)), as_rows(std::move(written.directions), 3), written.touch};
}

/// Write the answers for all values of the joints in a box, which is halved along one of `columns` after another.
std::optional<Answers> write_box(const JointTables& moving, const Pair& pair, nb::handle low, nb::handle high,
                                 nb::handle columns, std::int64_t most) {
  require_below(most, std::size_t{1} << 24, "most");
  const Floats least(low, "low"), greatest(high, "high");
  const Array<const std::int64_t, 1> halved(columns, "columns");
  greatest.of_shape({least.size()});
  require(halved.size() <= 40, "columns must be 40 at most");
  require_below(std::span(moving.column), least.size(), "columns");
  require_below(halved.span(), least.size(), "columns");
  for (const auto& node : {pair.first, pair.second}) require_below(node->frame, moving.parent.size() + 1, "frames");
  Written written;
  try {
    written = without_gil([&] {
      Motions motions(moving.frames(), {least.span(), greatest.span(), halved.span()});
      return write(motions, 1, std::span(&pair, 1), {}, static_cast<std::size_t>(most));
    });
  } catch (const TooLong&) {
    return std::nullopt;
  }
  return Answers{as_row(std::move(written.answers)), as_rows(std::move(written.directions), 3), written.touch};
}

}  // namespace

void add_certificates(nb::module_& module) {
  nb::module_ part = module.def_submodule("certificates", "Writing a certificate.");
  nb::class_<Elements>(part, "Elements")
      .def("__init__", &make_elements, "points"_a.none(), "corners"_a.none(), "radius"_a, "disc"_a, "axis"_a.none(),
           "is_box"_a);
  nb::class_<Node>(part, "Node").def("__init__", &make_node, "frame"_a, "shapes"_a);
  nb::class_<Pair>(part, "Pair")
      .def(
          "__init__",
          [](Pair* self, std::shared_ptr<Node> first, std::shared_ptr<Node> second, double keep) {
            new (self) Pair{std::move(first), std::move(second), keep};
          },
          "first"_a, "second"_a, "keep"_a);
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
  part.def(
      "text_of_rows",
      [](nb::handle rows, std::string_view before) {
        const FloatRows values(rows, "rows");
        const std::string text = text_of_rows(values.matrix(), before);
        return nb::bytes(text.data(), text.size());
      },
      "rows"_a.none(), "before"_a);
  part.def(
      "parabolas",
      [](nb::handle states, nb::handle low, nb::handle high, double tolerance) {
        const Floats least(low, "low"), most(high, "high");
        require(least.size() > 0, "low must have a joint or more"), most.of_shape({least.size()});
        const FloatRows rows = float_rows(states, "states", least.size());
        require(rows.shape(0) > 0, "states must be one or more");
        return as_rows(
            without_gil([&] { return trajectory::parabolas(rows.span(), least.span(), most.span(), tolerance); }),
            least.size());
      },
      "states"_a.none(), "low"_a.none(), "high"_a.none(), "tolerance"_a);
  part.def("write_answers", &write_answers, "joint_tables"_a, "pairs"_a, "paths"_a, "most"_a);
  part.def("write_box", &write_box, "joint_tables"_a, "pair"_a, "low"_a.none(), "high"_a.none(), "columns"_a.none(),
           "most"_a);
}

}  // namespace evenroad::bind
