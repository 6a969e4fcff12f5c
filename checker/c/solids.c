#include "solids.h"

#include "proof.h"

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

/* Tell whether a point is inside of the closed piece of a mesh that begins with the triangle `piece`. */
bool is_inside(Vector point, const Solid* solid, size_t piece) {
  const Mesh* mesh = solid->shape->mesh;
  for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; ++i) {
    Vector way = scaled(1 / length(WAYS[i]), WAYS[i]);
    bool odd = false, clear = true;
    for (size_t k = piece; k < mesh->triangles && clear; ++k) {
      if (mesh->piece[k] != piece) continue;
      const Vector* c = solid->all + 3 * k;
      int how = meets(difference(c[0], point), difference(c[1], point), difference(c[2], point), way);
      clear = how != UNCLEAR;
      odd ^= how == CROSSES;
    }
    if (clear) return odd;
  }
  fail(REFUSED, "no ray shows whether a body is inside of another one");
}

bool is_surface(const Solid* solid) { return solid->shape->kind == MESH && !solid->shape->convex; }

typedef struct {
  Vector low, high;
} Range;

static void widen(Range* range, Vector a) {
  range->low = (Vector){fmin(range->low.x, a.x), fmin(range->low.y, a.y), fmin(range->low.z, a.z)};
  range->high = (Vector){fmax(range->high.x, a.x), fmax(range->high.y, a.y), fmax(range->high.z, a.z)};
}

static bool holds(const Range* range, Vector a) {
  return range->low.x <= a.x && a.x <= range->high.x && range->low.y <= a.y && a.y <= range->high.y &&
         range->low.z <= a.z && a.z <= range->high.z;
}

static void find_all_pieces(const Node* node) {
  for (size_t i = 0; i < node->solid_count; ++i) {
    if (is_surface(node->solids[i])) find_pieces(node->solids[i]->shape->mesh);
  }
}

/* Where each piece of `inner` begins, as the frame of another node sees it. */
static Vector* beginnings(const Node* inner, const Pose* from, const Pose* to, size_t* count) {
  Vector* points = take(inner->count + 1, sizeof *points);
  *count = 0;
  for (size_t i = 0; i < inner->solid_count; ++i) {
    const Solid* solid = inner->solids[i];
    for (size_t k = 0; k < solid->elements; ++k) {
      if (is_surface(solid) && solid->shape->mesh->piece[k] != k) continue;
      Vector point = placed(from, solid->all[k * solid->corners]);
      points[(*count)++] = turned_in(to, difference(point, to->at));
    }
  }
  return points;
}

/* Refuse points inside of closed pieces of a solid; count the open ones around whose inside nothing is claimed. */
static size_t require_outside_of(Solid* outer, const Vector* points, size_t count) {
  const Mesh* mesh = outer->shape->mesh;
  size_t opened = 0;
  Range* ranges = take(mesh->triangles, sizeof *ranges);
  if (!outer->met) outer->met = take(mesh->triangles, sizeof *outer->met);
  for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
    size_t piece = mesh->piece[i / 3];
    if (piece == NONE) continue;
    if (i == 3 * piece) ranges[piece] = (Range){outer->all[i], outer->all[i]};
    widen(ranges + piece, outer->all[i]);
  }
  for (size_t piece = 0; piece < mesh->triangles; ++piece) {
    if (mesh->piece[piece] != piece || outer->met[piece]) continue;
    for (size_t i = 0; i < count; ++i) {
      if (!holds(ranges + piece, points[i])) continue;
      if (mesh->closed[piece] && is_inside(points[i], outer, piece)) fail(REFUSED, "a body is inside of another one");
      if (!mesh->closed[piece] && !outer->met[piece]) opened += outer->met[piece] = true;
    }
  }
  return opened;
}

/* Tell whether the box of a node meets that of another one, along the axes of the other's frame. */
static bool boxes_meet(const Node* inner, const Pose* from, const Node* outer, const Pose* to) {
  const Vector axes[3] = {to->x, to->y, to->z}, own[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {
    for (int sign = -1; sign <= 1; sign += 2) {
      Vector way = scaled(sign, axes[i]), back = scaled(-sign, own[i]);
      double far = support(inner, turned_in(from, way), true) + dot(way, difference(from->at, to->at));
      if (far + support(outer, back, true) < 0) return false;
    }
  }
  return true;
}

size_t require_outside(const Model* model) {
  Moved* moved = take(model->frame_count, sizeof *moved);
  place_frames(model, 0, 0, 0, moved);
  size_t opened = 0;
  for (size_t i = 0; i < model->pair_count; ++i) {
    const Pair* pair = model->pairs + i;
    const Node* nodes[2] = {pair->first, pair->second};
    for (int k = 0; k < 2 && !pair->apart; ++k) {
      const Node *inner = nodes[k], *outer = nodes[1 - k];
      const Pose *from = &moved[inner->frame].pose, *to = &moved[outer->frame].pose;
      if (!boxes_meet(inner, from, outer, to)) continue;
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
