// evenroad._native.points: measures of point sets.
#include <algorithm>

#include "bind/arrays.hpp"
#include "points/dispersion.hpp"
#include "points/pair_sums.hpp"
#include "points/riesz_rows.hpp"
#include "points/star_discrepancy.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using points::Dispersion;
using points::PairSums;
using points::RieszRows;

PairSums maximum_pair_sums(nb::handle columns, nb::handle ceiling, nb::handle slope, bool want_gradient) {
  const FloatRows at(columns, "columns");
  const Floats top(ceiling, "ceiling"), fall(slope, "slope");
  top.of_shape({at.shape(0)}), fall.of_shape({at.shape(0)});
  const points::MaximumPairs of{top.span(), fall.span()};
  return without_gil([&] { return points::pair_sums(at.matrix(), of, want_gradient); });
}

PairSums distance_pair_sums(nb::handle columns, nb::handle levels, nb::handle slopes, nb::handle curvatures,
                            nb::handle own_terms, nb::handle own_slopes, bool want_gradient) {
  const FloatRows at(columns, "columns"), own(own_terms, "own"), own_slope(own_slopes, "own_slope");
  const Floats level(levels, "level"), slope(slopes, "slope"), curvature(curvatures, "curvature");
  const std::size_t d = at.shape(0), n = at.shape(1);
  level.of_shape({d}), slope.of_shape({d}), curvature.of_shape({d});
  own.of_shape({d, n}), own_slope.of_shape({d, n});
  const points::DistancePairs of{level.span(), slope.span(), curvature.span(), own.matrix(), own_slope.matrix()};
  return without_gil([&] { return points::pair_sums(at.matrix(), of, want_gradient); });
}

RieszRows riesz_rows(nb::handle columns, unsigned s, bool periodic, bool want_gradient) {
  const FloatRows at(columns, "columns");
  return without_gil([&] { return points::riesz_rows(at.matrix(), s, periodic, want_gradient); });
}

double star_discrepancy(nb::handle columns) {
  const FloatRows at(columns, "columns");
  require(at.size() > 0, "columns must hold at least one point and one coordinate");
  const std::span<const double> last = at.matrix()[at.shape(0) - 1];
  require(std::is_sorted(last.begin(), last.end()), "columns must come in the order of their last row");
  return without_gil([&] { return points::star_discrepancy(at.matrix()); });
}

/// A number of coordinates that would take more than a year to examine.
constexpr double MOST_WORK = 1e15;

Dispersion bound_dispersion(nb::handle coordinates, nb::handle periods, nb::handle lengths, double lower, double share,
                            double most) {
  const FloatRows at(coordinates, "points");
  const Floats period(periods, "period", Entries::ANY), sides(lengths, "sides");
  period.of_shape({at.shape(1)}), sides.of_shape({at.shape(1)});
  require(at.size() > 0, "points must hold at least one point and one coordinate");
  require(share >= 0.0 && most <= MOST_WORK, "share must be 0 or more, and most 1e15 or less");
  return without_gil(
      [&] { return points::bound_dispersion(at.matrix(), period.span(), sides.span(), lower, share, most); });
}

}  // namespace

void add_points(nb::module_& module) {
  nb::module_ part = module.def_submodule("points", "Measures of point sets.");
  nb::class_<PairSums>(part, "PairSums")
      .def_prop_ro("sums", &array_of<&PairSums::sums>)
      .def_prop_ro("gradient", &array_of<&PairSums::gradient>);
  nb::class_<RieszRows>(part, "RieszRows")
      .def_prop_ro("nearest", &array_of<&RieszRows::nearest>)
      .def_prop_ro("sums", &array_of<&RieszRows::sums>)
      .def_prop_ro("pushes", &array_of<&RieszRows::pushes>);
  nb::class_<Dispersion>(part, "Dispersion")
      .def_ro("lower", &Dispersion::lower)
      .def_ro("upper", &Dispersion::upper)
      .def_ro("work", &Dispersion::work);
  // None is a wrong argument like others, which the functions name; nanobind would refuse it in words of its own.
  part.def("maximum_pair_sums", &maximum_pair_sums, "columns"_a.none(), "ceiling"_a.none(), "slope"_a.none(),
           "want_gradient"_a);
  part.def("riesz_rows", &riesz_rows, "columns"_a.none(), "s"_a, "periodic"_a, "want_gradient"_a);
  part.def("star_discrepancy", &star_discrepancy, "columns"_a.none());
  part.def("bound_dispersion", &bound_dispersion, "points"_a.none(), "period"_a.none(), "sides"_a.none(), "lower"_a,
           "share"_a, "most"_a);
  part.def("distance_pair_sums", &distance_pair_sums, "columns"_a.none(), "level"_a.none(), "slope"_a.none(),
           "curvature"_a.none(), "own"_a.none(), "own_slope"_a.none(), "want_gradient"_a);
}

}  // namespace evenroad::bind
