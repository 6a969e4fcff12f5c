// evenroad._native.space: distances in spaces.
#include "bind/arrays.hpp"
#include "space/all_distances.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

nb::object flat_distances(nb::handle first, nb::handle second, nb::handle scales, nb::handle periods) {
  const FloatRows a(first, "a"), b(second, "b");
  const Floats scale(scales, "scale"), period(periods, "period", Entries::ANY);
  const std::size_t dim = scale.size();
  a.of_shape({a.shape(0), dim}), b.of_shape({b.shape(0), dim}), period.of_shape({dim});
  return as_rows(
      without_gil([&] { return space::flat_distances(a.matrix(), b.matrix(), scale.span(), period.span()); }));
}

nb::object row_distances(nb::handle first, nb::handle second, nb::handle scales, nb::handle periods) {
  const FloatRows a(first, "a"), b(second, "b");
  const Floats scale(scales, "scale"), period(periods, "period", Entries::ANY);
  const std::size_t dim = scale.size();
  a.of_shape({a.shape(0), dim}), b.of_shape({a.shape(0), dim}), period.of_shape({dim});
  return as_numpy(space::row_distances(a.matrix(), b.matrix(), scale.span(), period.span()), {a.shape(0)});
}

nb::object quaternion_angles(nb::handle first, nb::handle second) {
  const FloatRows a(first, "a"), b(second, "b");
  a.of_shape({a.shape(0), 4}), b.of_shape({b.shape(0), 4});
  return as_rows(without_gil([&] { return space::quaternion_angles(a.matrix(), b.matrix()); }));
}

}  // namespace

void add_space(nb::module_& module) {
  nb::module_ part = module.def_submodule("space", "Distances in spaces.");
  part.def("flat_distances", &flat_distances, "a"_a.none(), "b"_a.none(), "scale"_a.none(), "period"_a.none());
  part.def("row_distances", &row_distances, "a"_a.none(), "b"_a.none(), "scale"_a.none(), "period"_a.none());
  part.def("quaternion_angles", &quaternion_angles, "a"_a.none(), "b"_a.none());
}

}  // namespace evenroad::bind
