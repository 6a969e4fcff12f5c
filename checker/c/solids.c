#include "solids.h"

#include "never.h"

enum { PASSES, CROSSES, UNCLEAR };

static const double NEAR = 1e-9;

/* Rays from a point: the next is tried where one comes too near to an edge. */
static const Vector WAYS[] = {{0.61, 0.53, 0.59},   {-0.47, 0.79, 0.39}, {0.31, -0.67, 0.67},
                              {-0.43, -0.37, 0.82}, {0.83, 0.29, -0.48}, {-0.71, 0.23, -0.66}};

/* How a ray from the origin meets a triangle. */
static int meets(Vector a, Vector b, Vector c, Vector way) {
  double near = NEAR * fmax(dot(a, a), fmax(dot(b, b), dot(c, c)));
  double sides[3] = {dot(cross(a, b), way), dot(cross(b, c), way), dot(cross(c, a), way)};
  double low = fmin(sides[0], fmin(sides[1], sides[2])), high = fmax(sides[0], fmax(sides[1], sides[2]));
  if (low < -near && high > near) return PASSES;
  if (!(low > near || high < -near)) return UNCLEAR;
  Vector normal = cross(difference(b, a), difference(c, a));
  return dot(normal, a) * dot(normal, way) > 0 ? CROSSES : PASSES;
}

bool is_inside(Vector point, const Solid* solid, const Piece* piece) {
  const size_t* members = solid->shape->mesh->members + piece->begin;
  for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; ++i) {
    Vector way = scaled(1 / length(WAYS[i]), WAYS[i]), c[3];
    bool odd = false, clear = true;
    for (size_t k = 0; k < piece->count && clear; ++k) {
      for (size_t n = 0; n < 3; ++n) c[n] = difference(corner_at(solid, members[k], n), point);
      int how = meets(c[0], c[1], c[2], way);
      clear = how != UNCLEAR;
      odd ^= how == CROSSES;
    }
    if (clear) return odd;
  }
  fail(REFUSED, "no ray shows whether a body is inside of another one");
}

static bool holds(const Range* range, Vector a) {
  return range->low.x <= a.x && a.x <= range->high.x && range->low.y <= a.y && a.y <= range->high.y &&
         range->low.z <= a.z && a.z <= range->high.z;
}

/* Where each piece of a node begins, or each element that is no triangle, as the frame of another one sees it. */
static Vector* beginnings(const Node* inner, const Pose* from, const Pose* to, size_t* count) {
  Vector* points = take(inner->count, sizeof *points);
  *count = 0;
  for (size_t i = 0; i < inner->solid_count; ++i) {
    const Solid* solid = inner->solids[i];
    const Mesh* mesh = solid->shape->mesh;
    bool surface = is_surface(solid);
    for (size_t k = 0; k < (surface ? mesh->piece_count : solid->elements); ++k) {
      size_t element = surface ? mesh->members[mesh->pieces[k].begin] : k;
      points[(*count)++] = turned_in(to, difference(placed(from, corner_at(solid, element, 0)), to->at));
    }
  }
  return points;
}

/* Find the ranges of the pieces of a mesh. */
static void find_ranges(Solid* solid) {
  const Mesh* mesh = solid->shape->mesh;
  if (solid->ranges) return;
  solid->ranges = take(mesh->piece_count, sizeof *solid->ranges);
  solid->met = take(mesh->piece_count, sizeof *solid->met);
  for (size_t i = 0; i < mesh->piece_count; ++i) {
    const size_t* members = mesh->members + mesh->pieces[i].begin;
    solid->ranges[i].low = solid->ranges[i].high = corner_at(solid, members[0], 0);
    for (size_t k = 0; k < 3 * mesh->pieces[i].count; ++k) {
      widen(solid->ranges + i, corner_at(solid, members[k / 3], k % 3));
    }
  }
}

/* Refuse points inside of closed pieces of a solid; count the open ones around whose inside nothing is claimed. */
static size_t require_outside_of(Solid* outer, const Vector* points, size_t count) {
  const Mesh* mesh = outer->shape->mesh;
  size_t opened = 0;
  find_ranges(outer);
  for (size_t i = 0; i < mesh->piece_count; ++i) {
    Piece* piece = mesh->pieces + i;
    for (size_t k = 0; k < count && !outer->met[i]; ++k) {
      if (!holds(outer->ranges + i, points[k])) continue;
      if (!is_closed(mesh, piece)) {
        opened += outer->met[i] = true;
      } else if (is_inside(points[k], outer, piece)) {
        fail(REFUSED, "a body is inside of another one");
      }
    }
  }
  return opened;
}

/* Tell whether the box of a node meets that of another one, along the axes of the other's frame. */
static bool boxes_meet(Node* inner, const Pose* from, Node* outer, const Pose* to) {
  const Vector axes[3] = {to->x, to->y, to->z}, own[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    Vector ways[2] = {turned_in(from, axes[i]), turned_in(from, scaled(-1, axes[i]))};
    Vector backs[2] = {scaled(-1, own[i]), own[i]};
    double far[2], back[2], apart = dot(axes[i], difference(from->at, to->at));
    find_supports(inner, ways, true, far);
    find_supports(outer, backs, true, back);
    if (far[0] + apart + back[0] < 0 || far[1] - apart + back[1] < 0) return false;
  }
  return true;
}

static void find_all_pieces(const Node* node) {
  for (size_t i = 0; i < node->solid_count; ++i) {
    if (is_surface(node->solids[i])) find_pieces(node->solids[i]->shape->mesh);
  }
}

static bool has_surface(const Node* node) {
  for (size_t i = 0; i < node->solid_count; ++i) {
    if (is_surface(node->solids[i])) return true;
  }
  return false;
}

size_t require_outside(const Model* model) {
  Moved* moved = take(model->frame_count, sizeof *moved);
  Stretch start = {.number = 1};
  if (model->certificate->of_pairs) start.cell = lowest_cell(model);
  moved[0].pose = identity();
  for (size_t i = 1; i < model->frame_count; ++i) place_chain(model, i, &start, moved);
  size_t opened = 0;
  for (size_t i = 0; i < model->pair_count; ++i) {
    const Pair* pair = model->pairs + i;
    Node* nodes[2] = {pair->first, pair->second};
    for (int k = 0; k < 2 && !pair->apart; ++k) {
      Node *inner = nodes[k], *outer = nodes[1 - k];
      const Pose *from = &moved[inner->frame].pose, *to = &moved[outer->frame].pose;
      if (!has_surface(outer) || !boxes_meet(inner, from, outer, to)) continue;
      find_all_pieces(inner);
      find_all_pieces(outer);
      size_t count = 0;
      const Vector* points = beginnings(inner, from, to, &count);
      for (size_t s = 0; s < outer->solid_count; ++s) {
        if (is_surface(outer->solids[s])) opened += require_outside_of(outer->solids[s], points, count);
      }
    }
  }
  return opened;
}
