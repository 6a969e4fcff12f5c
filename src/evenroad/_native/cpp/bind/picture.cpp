// evenroad._native.picture: drawing triangles in three dimensions.
#include "bind/arrays.hpp"
#include "picture/nearest.hpp"
#include "picture/painter.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Largest number of pixels of a side.
constexpr std::size_t LARGEST = 8192;

std::size_t side_of(std::int64_t pixels, const char* name) {
  require_below(pixels, LARGEST, name);
  return static_cast<std::size_t>(pixels);
}

Matrix<const double> rows_of(const Array<const double, 3>& array) { return {array.data(), array.shape(0), 9}; }

picture::Vector vector_of(Matrix<const double> rows, std::size_t row) {
  return {rows(row, 0), rows(row, 1), rows(row, 2)};
}

nb::object nearest(nb::handle given, std::int64_t columns, std::int64_t rows) {
  const Array<const double, 3> flat(given, "flat");
  flat.of_shape({flat.shape(0), 3, 3});
  require_below(static_cast<std::int64_t>(flat.shape(0)), std::size_t{1} << 31, "the number of triangles");
  const Matrix<const double> corners = rows_of(flat);
  picture::Nearest found(side_of(columns, "columns"), side_of(rows, "rows"), 0.0F);
  without_gil([&] {
    for (std::size_t t = 0; t < corners.rows; t++) {
      const std::span<const double> row = corners[t];
      found.add({{{row[0], row[1], row[2]}, {row[3], row[4], row[5]}, {row[6], row[7], row[8]}}},
                static_cast<std::int32_t>(t));
    }
  });
  const std::size_t height = found.rows, width = found.columns;
  return nb::make_tuple(as_numpy(std::move(found.near), {height, width}),
                        as_numpy(std::move(found.owner), {height, width}));
}

nb::object paint(nb::handle cameras, double scale, std::int64_t columns, std::int64_t rows, nb::handle studios,
                 nb::handle corner, nb::handle normal, nb::handle colour, nb::handle closeds, std::int64_t see_through,
                 nb::handle layer) {
  const FloatRows view(cameras, "camera"), studio(studios, "studio"), colours(colour, "colours"),
      given_layers(layer, "layers");
  const Array<const double, 3> corners(corner, "corners"), normals(normal, "normals");
  const Array<const bool, 1> closed(closeds, "closed");
  const std::size_t count = closed.size(), shown = given_layers.shape(0);
  view.of_shape({4, 3}), studio.of_shape({9, 3}), colours.of_shape({count, 3}), given_layers.of_shape({shown, 3});
  corners.of_shape({count, 3, 3}), normals.of_shape({count, 3, 3});
  require_below(static_cast<std::int64_t>(count), std::size_t{1} << 31, "the number of triangles");
  require_within(std::span<const double>(&scale, 1), 1e-6, 1e9, "scale");
  require_within(corners.span(), -1e6, 1e6, "corners");
  require_below(see_through, count + 1, "see_through");
  require(shown > 0, "layers must have one or more rows");
  std::vector<picture::Layer> layers;
  std::size_t before = 0;
  for (std::size_t i = 0; i < shown; i++) {
    const std::span<const double> row = given_layers.matrix()[i];
    require(row[0] >= static_cast<double>(before) && row[0] <= static_cast<double>(count),
            "layers must end in order, at most at the number of triangles");
    before = static_cast<std::size_t>(row[0]);
    layers.push_back({before, row[1], row[2]});
  }
  const Matrix<const double> at = view.matrix(), of = studio.matrix();
  const picture::Camera camera{
      vector_of(at, 0),     vector_of(at, 1), vector_of(at, 2), vector_of(at, 3), scale, side_of(columns, "columns"),
      side_of(rows, "rows")};
  const picture::Studio lights{of(0, 0),
                               vector_of(of, 1),
                               vector_of(of, 2),
                               vector_of(of, 3),
                               vector_of(of, 4),
                               vector_of(of, 5),
                               {vector_of(of, 6), vector_of(of, 7), vector_of(of, 8)}};
  const picture::Triangles triangles{rows_of(corners), rows_of(normals), colours.matrix(), closed.span(),
                                     static_cast<std::size_t>(see_through)};
  return as_numpy(without_gil([&] { return picture::paint(camera, lights, triangles, layers); }),
                  {camera.rows, camera.columns, std::size_t{3}});
}

}  // namespace

void add_picture(nb::module_& module) {
  nb::module_ part = module.def_submodule("picture", "Drawing triangles in three dimensions.");
  part.def("nearest", &nearest, "flat"_a.none(), "columns"_a, "rows"_a);
  part.def("paint", &paint, "camera"_a.none(), "scale"_a, "columns"_a, "rows"_a, "studio"_a.none(), "corners"_a.none(),
           "normals"_a.none(), "colours"_a.none(), "closed"_a.none(), "see_through"_a, "layers"_a.none());
}

}  // namespace evenroad::bind
