// evenroad._native.roadmap: neighbours, graphs and searches of roadmaps.
#include <algorithm>
#include <limits>

#include "bind/arrays.hpp"
#include "roadmap/ascending.hpp"
#include "roadmap/graph.hpp"
#include "roadmap/grow.hpp"
#include "roadmap/kdtree.hpp"
#include "roadmap/near_one.hpp"
#include "roadmap/shortest_path.hpp"

namespace evenroad::bind {

using namespace nb::literals;
using Int32s = Array<const std::int32_t, 1>;
using Int64s = Array<const std::int64_t, 1>;
using Int8s = Array<const std::int8_t, 1>;

namespace {

constexpr std::size_t MOST_NODES = std::numeric_limits<std::int32_t>::max();

/// Edges, (m, 2), between existing nodes.
class Edges {
 public:
  Edges(nb::handle given, std::size_t nodes) : array_(given, "edges") {
    array_.of_shape({array_.shape(0), 2});
    require_below(array_.span(), nodes, "nodes of edges");
  }
  Matrix<const std::int32_t> matrix() const { return array_.matrix(); }
  std::size_t count() const { return array_.shape(0); }

 private:
  Array<const std::int32_t, 2> array_;
};

/// Points, (n, d), and periods of their axes, (d,).
class PeriodicPoints {
 public:
  PeriodicPoints(nb::handle points, nb::handle period)
      : points_(points, "points"), period_(period, "period", Entries::ANY) {
    period_.of_shape({points_.shape(1)});
    require(points_.shape(1) >= 1, "points must have one coordinate or more");
    require(count() <= MOST_NODES, "points must be fewer than 2^31");
  }
  std::size_t count() const { return points_.shape(0); }
  roadmap::Periodic set() const { return {points_.matrix(), period_.span()}; }

 private:
  FloatRows points_;
  Floats period_;
};

nb::object ascending_pairs(nb::handle pairs, std::int64_t count) {
  // Memory grows with the count, too.
  require_below(count, std::size_t{1} << 28, "count");
  const auto nodes = static_cast<std::size_t>(count);
  const Edges given(pairs, nodes);
  return as_rows(without_gil([&] { return roadmap::ascending_pairs(given.matrix(), nodes); }), 2);
}

nb::object k_nearest(nb::handle points, nb::handle period, std::size_t k, bool earlier) {
  const PeriodicPoints given(points, period);
  require(k >= 1 && k < given.count(), "k must be at least 1 and less than the number of points");
  return as_rows(without_gil([&] { return roadmap::k_nearest(given.set(), k, earlier); }), k);
}

nb::object pairs_within(nb::handle points, nb::handle period, double radius) {
  const PeriodicPoints given(points, period);
  require(given.count() >= 1, "points must be one or more");
  require(radius >= 0.0, "radius must be a number >= 0");
  return as_rows(without_gil([&] { return roadmap::pairs_within(given.set(), radius); }), 2);
}

nb::object distances_from(nb::handle points, nb::handle period, nb::handle point) {
  const PeriodicPoints given(points, period);
  const Floats from(point, "point");
  from.of_shape({given.set().period.size()});
  return as_row(without_gil([&] { return roadmap::distances_from(given.set(), from.span()); }));
}

nb::object k_smallest(nb::handle distances, nb::handle usable, std::size_t k, double radius) {
  const Floats away(distances, "distances", Entries::ANY);
  const Array<const bool, 1> among(usable, "usable");
  among.of_shape({away.size()});
  const std::size_t most = std::min(k, away.size());
  return as_row(without_gil([&] { return roadmap::k_smallest(away.span(), among.span(), most, radius); }));
}

void make_graph(roadmap::Graph* self, std::size_t nodes, nb::handle edges) {
  require(nodes <= MOST_NODES, "nodes must be fewer than 2^31");
  const Edges given(edges, nodes);
  new (self) roadmap::Graph(without_gil([&] { return roadmap::Graph(nodes, given.matrix()); }));
}

roadmap::Graph with_links(const roadmap::Graph& graph, std::size_t nodes, nb::handle links,
                          std::int32_t numbered_from) {
  require(graph.nodes() <= nodes && nodes <= MOST_NODES, "nodes must be at least those of the graph, and below 2^31");
  const Edges given(links, nodes);
  require(numbered_from >= 0 && given.count() <= MOST_NODES - numbered_from, "numbers of links must be below 2^31");
  return without_gil([&] { return graph.with_links(nodes, given.matrix(), numbered_from); });
}

/// The data of a search: weights and states by edge number.
void require_all_edges(const roadmap::Graph& graph, std::size_t given, const char* name) {
  require(given >= graph.numbers(),
          std::string(name) + " must be " + std::to_string(graph.numbers()) + " or more, got " + std::to_string(given));
}

nb::tuple shortest_path(const roadmap::Graph& graph, nb::tuple costs, nb::tuple states, std::int64_t start,
                        nb::handle goals) {
  require(costs.size() == 2 && states.size() == 2, "costs must be (weights, bounds), states those of (edges, nodes)");
  const Int64s weights(costs[0], "weights"), bounds(costs[1], "bounds"), terminals(goals, "goals");
  const Int8s edges(states[0], "edge_states"), nodes(states[1], "node_states");
  require_all_edges(graph, weights.size(), "weights"), require_all_edges(graph, edges.size(), "edge_states");
  bounds.of_shape({graph.nodes()}), nodes.of_shape({graph.nodes()});
  require_below(start, graph.nodes(), "start");
  require_below(terminals.span(), graph.nodes(), "goals");
  roadmap::Path path = without_gil([&] {
    return roadmap::shortest_path(graph, {weights.span(), bounds.span()}, {edges.span(), nodes.span()},
                                  static_cast<std::int32_t>(start), terminals.span());
  });
  return nb::make_tuple(as_row(std::move(path.nodes)), as_row(std::move(path.edges)));
}

nb::tuple best_offers(const roadmap::Graph& graph, std::int64_t node, nb::handle edge_weights, nb::handle costs,
                      nb::handle stages) {
  const Int64s weights(edge_weights, "weights"), cost(costs, "cost");
  const Int8s stage(stages, "stage");
  require_all_edges(graph, weights.size(), "weights");
  cost.of_shape({graph.nodes()}), stage.of_shape({graph.nodes()});
  require_below(node, graph.nodes(), "node");
  roadmap::Offers offers = without_gil([&] {
    const auto number = static_cast<std::int32_t>(node);
    return roadmap::best_offers(graph.fixed(), number, weights.span(), cost.span(), stage.span());
  });
  return nb::make_tuple(as_row(std::move(offers.nodes)), as_row(std::move(offers.edges)));
}

void join(nb::handle labels, nb::handle edges) {
  const Array<std::int32_t, 1> label(labels, "label");
  const Edges given(edges, label.size());
  bool lowest = true;
  for (std::size_t node = 0; node < label.size(); node++) {
    lowest &= static_cast<std::uint32_t>(label.span()[node]) <= node;
  }
  require(lowest, "label must hold lowest nodes of components");
  without_gil([&] { roadmap::join(label.span(), given.matrix()); });
}

nb::tuple grow(nb::handle edges, nb::tuple states, nb::handle of_nodes, nb::handle parent_edges, nb::handle distances,
               nb::handle asked, std::size_t most) {
  require(states.size() == 2, "states must be those of (edges, nodes)");
  const Array<std::int8_t, 1> tree(of_nodes, "tree");
  const Array<std::int32_t, 1> parent_edge(parent_edges, "parent_edge");
  const FloatRows away(distances, "away");
  const std::size_t nodes = tree.size();
  parent_edge.of_shape({nodes}), away.of_shape({2, nodes});
  const Edges given(edges, nodes);
  const Int8s edge_states(states[0], "edge_states"), node_states(states[1], "node_states");
  edge_states.of_shape({given.count()}), node_states.of_shape({nodes});
  const Int32s evaluated(asked, "asked");
  require_below(evaluated.span(), given.count(), "asked");
  require_below(std::span<const std::int8_t>(tree.span()), 3, "tree");
  roadmap::Growth growth = without_gil([&] {
    return roadmap::grow(given.matrix(), {edge_states.span(), node_states.span()},
                         {tree.span(), parent_edge.span(), away.matrix()}, evaluated.span(), most);
  });
  return nb::make_tuple(growth.met, as_row(std::move(growth.edges)));
}

}  // namespace

void add_roadmap(nb::module_& module) {
  nb::module_ part = module.def_submodule("roadmap", "Neighbours, graphs and searches of roadmaps.");
  nb::class_<roadmap::Graph>(part, "Graph", "Undirected edges by node, and links of one query beside them.")
      .def("__init__", &make_graph, "nodes"_a, "edges"_a.none())
      .def_prop_ro("nodes", &roadmap::Graph::nodes)
      .def("with_links", &with_links, "nodes"_a, "links"_a.none(), "numbered_from"_a);
  part.def("shortest_path", &shortest_path, "graph"_a, "costs"_a, "states"_a, "start"_a, "goals"_a.none());
  part.def("best_offers", &best_offers, "graph"_a, "node"_a, "weights"_a.none(), "cost"_a.none(), "stage"_a.none());
  part.def("join", &join, "label"_a.none(), "edges"_a.none());
  part.def("grow", &grow, "edges"_a.none(), "states"_a, "tree"_a.none(), "parent_edge"_a.none(), "away"_a.none(),
           "asked"_a.none(), "most"_a);
  part.def("ascending_pairs", &ascending_pairs, "pairs"_a.none(), "count"_a);
  part.def("k_nearest", &k_nearest, "points"_a.none(), "period"_a.none(), "k"_a, "earlier"_a);
  part.def("pairs_within", &pairs_within, "points"_a.none(), "period"_a.none(), "radius"_a);
  part.def("distances_from", &distances_from, "points"_a.none(), "period"_a.none(), "point"_a.none());
  part.def("k_smallest", &k_smallest, "distances"_a.none(), "usable"_a.none(), "k"_a, "radius"_a);
}

}  // namespace evenroad::bind
