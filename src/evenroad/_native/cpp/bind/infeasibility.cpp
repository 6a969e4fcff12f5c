// evenroad._native.infeasibility: cells of the ranges of joints, for proofs that there is no path.
#include <limits>

#include "bind/arrays.hpp"
#include "infeasibility/flood.hpp"
#include "infeasibility/split_cells.hpp"

namespace evenroad::bind {

using namespace nb::literals;
using infeasibility::Ended;
using infeasibility::SplitCells;

namespace {

/// Largest numbers of cells of a grid, and of those that may be split.
constexpr std::size_t LARGEST_GRID = std::size_t{1} << 24, LARGEST_SPLIT = std::size_t{1} << 18;

/// Return the number of cells, at least one along each axis.
std::size_t grid_cells(std::span<const std::int64_t> count, std::size_t most) {
  std::size_t all = 1;
  for (const std::int64_t each : count) {
    require(each > 0, "count must be 1 or more along each axis");
    require_below(each, most / all + 1, "count");
    all *= static_cast<std::size_t>(each);
  }
  return all;
}

void make_split_cells(SplitCells* self, nb::handle low, nb::handle size, nb::handle count, nb::handle period,
                      nb::handle whole) {
  const Floats lows(low, "low"), sizes(size, "size"), periods(period, "period", Entries::ANY);
  const Array<const std::int64_t, 1> counts(count, "count");
  const Array<const bool, 1> wholes(whole, "whole");
  const std::size_t joints = counts.size();
  require(joints > 0 && joints <= infeasibility::MOST_JOINTS, "count must have 1 to 4 entries");
  lows.of_shape({joints}), sizes.of_shape({joints}), periods.of_shape({joints}), wholes.of_shape({joints});
  require_within(sizes.span(), std::numeric_limits<double>::min(), FARTHEST, "size");
  for (const double each : periods.span()) require(each > 0, "period must be > 0");
  grid_cells(counts.span(), LARGEST_SPLIT);
  std::vector<infeasibility::Axis> axes;
  for (std::size_t k = 0; k < joints; k++) {
    axes.push_back({lows.span()[k], sizes.span()[k], counts.span()[k], periods.span()[k], wholes.span()[k]});
  }
  new (self) SplitCells(std::move(axes));
}

int split_depth(std::int64_t depth) {
  require_below(depth, infeasibility::DEEPEST + 1, "depth");
  return static_cast<int>(depth);
}

nb::list waiting_depths(const SplitCells& cells) {
  nb::list all;
  for (int depth = 0; depth <= infeasibility::DEEPEST; depth++) {
    if (!cells.waiting(depth).empty()) all.append(depth);
  }
  return all;
}

void decide_cells(SplitCells& cells, std::int64_t depth, nb::handle unblocked, nb::handle clear) {
  const Array<const bool, 1> open(unblocked, "unblocked"), free(clear, "clear");
  const std::size_t count = cells.waiting(split_depth(depth)).size();
  open.of_shape({count}), free.of_shape({count});
  cells.decide(static_cast<int>(depth), open.span(), free.span());
}

const char* search_cells(SplitCells& cells, nb::handle start, nb::handle goals, std::int64_t most) {
  const Floats from(start, "start");
  from.of_shape({cells.joints()});
  const FloatRows to = float_rows(goals, "goals", cells.joints());
  require_within(from.span(), -FARTHEST, FARTHEST, "start");
  require_within(to.span(), -FARTHEST, FARTHEST, "goals");
  require_below(most, LARGEST_GRID, "most");
  require(cells.are_decided(), "all cells must be decided before a search");
  switch (without_gil([&] { return cells.search(from.span(), to.matrix(), most); })) {
    case Ended::APART:
      return "apart";
    case Ended::JOINED:
      return "joined";
    case Ended::SPLIT:
      return "split";
    case Ended::UNDECIDED:
      break;
  }
  return "undecided";
}

nb::object reached_cells(nb::handle free, nb::handle count, nb::handle wraps, std::int64_t from) {
  const Array<const bool, 1> open(free, "free"), circles(wraps, "wraps");
  const Array<const std::int64_t, 1> counts(count, "count");
  circles.of_shape({counts.size()});
  open.of_shape({grid_cells(counts.span(), LARGEST_GRID)});
  require_below(from, open.size(), "start");
  const std::size_t first = static_cast<std::size_t>(from);
  return as_bools(without_gil([&] { return infeasibility::flood(open.span(), counts.span(), circles.span(), first); }),
                  {open.size()});
}

}  // namespace

void add_infeasibility(nb::module_& module) {
  nb::module_ part = module.def_submodule("infeasibility", "Cells of joints, for proofs that there is no path.");
  nb::class_<SplitCells>(part, "SplitCells")
      .def("__init__", &make_split_cells, "low"_a.none(), "size"_a.none(), "count"_a.none(), "period"_a.none(),
           "whole"_a.none())
      .def_prop_ro("depths", &waiting_depths)
      .def("middles",
           [](const SplitCells& cells, std::int64_t depth) { return as_rows(cells.middles(split_depth(depth))); })
      .def("decide", &decide_cells, "depth"_a, "unblocked"_a.none(), "clear"_a.none())
      .def("search", &search_cells, "start"_a.none(), "goals"_a.none(), "most"_a);
  part.def("reached_cells", &reached_cells, "free"_a.none(), "count"_a.none(), "wraps"_a.none(), "start"_a);
}

}  // namespace evenroad::bind
