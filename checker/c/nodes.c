#include "nodes.h"

#include <stdlib.h>
#include <string.h>

static const double WIDEST = 1000, FLAT = 1e-9;

/* The corners of a mesh, of one element if it is convex, or the points of a cloud. */
static void add_mesh(Solid* solid, const Shape* shape, const Pose* pose) {
  size_t all = shape->mesh->distinct ? shape->mesh->distinct : 3 * shape->mesh->triangles;
  Vector* corners = take(all, sizeof *corners);
  for (size_t i = 0; i < all; ++i) corners[i] = placed(pose, shape->mesh->corners[i]);
  solid->corners = shape->kind == CLOUD ? 1 : shape->convex ? all : 3;
  solid->elements = all / solid->corners;
  solid->all = corners;
}

/* A box, or the box below a plane, whose upper face is around the root's foot. */
static void add_box(Solid* solid, const double size[3], const Pose* pose) {
  Vector* corners = take(8, sizeof *corners);
  for (int i = 0; i < 8; ++i) {
    Vector corner = {(i & 1 ? size[0] : -size[0]) / 2, (i & 2 ? size[1] : -size[1]) / 2,
                     (i & 4 ? size[2] : -size[2]) / 2};
    corners[i] = placed(pose, corner);
  }
  solid->corners = 8;
  solid->all = corners;
}

Solid solid_of(const Shape* shape, const Pose* pose) {
  Solid solid = {.shape = shape, .ball = shape->clearance, .elements = 1, .axis = pose->z};
  const double *size = shape->size, plane[3] = {2 * GROUND, 2 * GROUND, GROUND};
  if (shape->kind == MESH || shape->kind == CLOUD) {
    add_mesh(&solid, shape, pose);
    if (shape->kind == CLOUD) solid.ball += size[0];
  } else if (shape->kind == BOX) {
    add_box(&solid, size, pose);
  } else if (shape->kind == PLANE) {
    Pose below = *pose;
    below.at = scaled(dot(pose->z, pose->at) - GROUND / 2, pose->z);
    add_box(&solid, plane, &below);
  } else {
    Vector* corners = take(2, sizeof *corners);
    solid.corners = shape->kind == SPHERE ? 1 : 2;
    corners[0].z = shape->kind == SPHERE ? 0 : -size[1] / 2;
    corners[1].z = size[1] / 2;
    for (int i = 0; i < 2; ++i) corners[i] = placed(pose, corners[i]);
    solid.all = corners;
    if (shape->kind == CYLINDER) solid.disc = size[0];
    if (shape->kind != CYLINDER) solid.ball += size[0];
  }
  for (size_t i = 0; i < solid.corners * solid.elements; ++i) {
    const Vector* corner = solid.all + i;
    if (!(fmax(fabs(corner->x), fmax(fabs(corner->y), fabs(corner->z))) < WIDEST)) {
      fail(BAD_INPUT, "a shape reaches beyond %g m", WIDEST);
    }
  }
  return solid;
}

double reach_of(const Solid* solid) {
  double farthest = 0;
  for (size_t i = 0; i < solid->corners * solid->elements; ++i) farthest = fmax(farthest, length(solid->all[i]));
  return farthest + solid->ball + solid->disc;
}

/* How far a disc reaches along a direction: its axis is of length 1. */
static double disc_reach(const Solid* solid, Vector direction) {
  if (solid->disc <= 0) return 0;
  Vector across = difference(direction, scaled(dot(direction, solid->axis), solid->axis));
  return solid->disc * length(across);
}

static double element_support(const Element* element, Vector direction, double size) {
  double most = -INFINITY;
  for (size_t i = 0; i < element->solid->corners; ++i) {
    double there = dot(direction, element->corners[i]);
    if (there > most) most = there;
  }
  return most + element->solid->ball * size + disc_reach(element->solid, direction);
}

double support(const Node* node, Vector direction, bool by_box) {
  double size = length(direction), most = -INFINITY;
  if (by_box) {
    double box = dot(direction, node->centre);
    for (int i = 0; i < 3; ++i) box += fabs(dot(direction, node->half[i]));
    return box;
  }
  for (size_t i = 0; i < node->count; ++i) most = fmax(most, element_support(node->elements + i, direction, size));
  return most;
}

/* Widen a range by a corner, and by what is about it. */
static void widen(Vector* low, Vector* high, Vector at, Vector wide) {
  if (at.x - wide.x < low->x) low->x = at.x - wide.x;
  if (at.y - wide.y < low->y) low->y = at.y - wide.y;
  if (at.z - wide.z < low->z) low->z = at.z - wide.z;
  if (at.x + wide.x > high->x) high->x = at.x + wide.x;
  if (at.y + wide.y > high->y) high->y = at.y + wide.y;
  if (at.z + wide.z > high->z) high->z = at.z + wide.z;
}

static double beside(double along) { return sqrt(fmax(0, 1 - along * along)); }

/* Find the box of a node, and its reach. */
static void bound(Node* node) {
  Vector low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < node->count; ++i) {
    const Solid* solid = node->elements[i].solid;
    Vector wide = {solid->ball, solid->ball, solid->ball}, axis = solid->axis;
    if (solid->disc > 0)
      wide = sum(wide, scaled(solid->disc, (Vector){beside(axis.x), beside(axis.y), beside(axis.z)}));
    double farthest = 0;
    for (size_t k = 0; k < solid->corners; ++k) {
      Vector corner = node->elements[i].corners[k];
      double square = dot(corner, corner);
      if (square > farthest) farthest = square;
      widen(&low, &high, corner, wide);
    }
    node->reach = fmax(node->reach, sqrt(farthest) + solid->ball + solid->disc);
  }
  node->centre = scaled(0.5, sum(low, high));
  Vector half = scaled(0.5, difference(high, low));
  node->half[0] = (Vector){half.x, 0, 0};
  node->half[1] = (Vector){0, half.y, 0};
  node->half[2] = (Vector){0, 0, half.z};
  const Element* only = node->elements;
  if (node->count == 1 && (only->solid->shape->kind == BOX || only->solid->shape->kind == PLANE)) {
    const Vector* corners = only->corners;
    Vector edges[3];
    double ball = only->solid->ball, shortest = INFINITY;
    for (int i = 0; i < 3; ++i) {
      edges[i] = scaled(0.5, difference(corners[1 << i], corners[0]));
      shortest = fmin(shortest, length(edges[i]));
    }
    if (ball > 0 && !(shortest > FLAT)) return;
    node->centre = scaled(0.5, sum(corners[0], corners[7]));
    for (int i = 0; i < 3; ++i) node->half[i] = scaled(1 + (ball > 0 ? ball / length(edges[i]) : 0), edges[i]);
  }
}

Node* node_of(Solid** solids, size_t count, size_t frame) {
  Node* node = take(1, sizeof *node);
  for (size_t i = 0; i < count; ++i) node->count += solids[i]->elements;
  node->elements = take(node->count + 1, sizeof *node->elements);
  node->frame = frame;
  node->solids = solids;
  node->solid_count = count;
  size_t order = 0;
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = 0; k < solids[i]->elements; ++k, ++order) {
      node->elements[order] = (Element){solids[i]->all + k * solids[i]->corners, solids[i], order};
    }
  }
  if (node->count) bound(node);
  return node;
}

typedef struct {
  double key;
  Element element;
} Keyed;

static bool is_before(const Keyed* a, const Keyed* b) {
  return a->key != b->key ? a->key < b->key : a->element.order < b->element.order;
}

static int by_key(const void* a, const void* b) { return is_before(b, a) - is_before(a, b); }

/* Bring the first `middle` elements to the front: by parts about a pivot or, where these do not shrink, by sorting. */
static void select_first(Keyed* keyed, size_t count, size_t middle) {
  size_t from = 0, to = count;
  for (int tries = 0; to - from > 16; ++tries) {
    if (tries > 60) {
      qsort(keyed + from, to - from, sizeof *keyed, by_key);
      return;
    }
    Keyed pivot = keyed[from + (to - from) / 2], swapped;
    size_t low = from, high = to - 1;
    for (;; ++low, --high) {
      while (is_before(keyed + low, &pivot)) ++low;
      while (is_before(&pivot, keyed + high)) --high;
      if (low >= high) break;
      swapped = keyed[low];
      keyed[low] = keyed[high];
      keyed[high] = swapped;
    }
    if (low > middle) {
      to = low;
    } else {
      from = low;
    }
  }
  qsort(keyed + from, to - from, sizeof *keyed, by_key);
}

static Vector mean(const Element* element) {
  Vector all = {0, 0, 0};
  for (size_t i = 0; i < element->solid->corners; ++i) all = sum(all, element->corners[i]);
  double count = (double)element->solid->corners;
  return (Vector){all.x / count, all.y / count, all.z / count};
}

static double coordinate(Vector a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

static double rounded(double metres) { return rint(metres * 1048576); }

static int longest_axis(const Vector* means, size_t count) {
  double longest = -1;
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < count; ++k) {
      low = fmin(low, coordinate(means[k], i));
      high = fmax(high, coordinate(means[k], i));
    }
    if (high - low > longest) longest = high - low, axis = i;
  }
  return axis;
}

Node* half_of(Node* node, bool second) {
  if (node->count < 2) return NULL;
  if (!node->first) {
    Vector* means = malloc(node->count * sizeof *means);
    Keyed* keyed = malloc(node->count * sizeof *keyed);
    if (!means || !keyed) fail(BAD_INPUT, "out of memory");
    for (size_t i = 0; i < node->count; ++i) {
      Vector middle = mean(node->elements + i);
      means[i] = (Vector){rounded(middle.x), rounded(middle.y), rounded(middle.z)};
    }
    int axis = longest_axis(means, node->count);
    for (size_t i = 0; i < node->count; ++i) {
      keyed[i] = (Keyed){coordinate(means[i], axis), node->elements[i]};
    }
    select_first(keyed, node->count, node->count / 2);
    for (size_t i = 0; i < node->count; ++i) node->elements[i] = keyed[i].element;
    free(means);
    free(keyed);
    size_t middle = node->count / 2;
    node->first = take(1, sizeof *node);
    node->second = take(1, sizeof *node);
    *node->first = (Node){.elements = node->elements, .count = middle, .frame = node->frame};
    *node->second = (Node){.elements = node->elements + middle, .count = node->count - middle, .frame = node->frame};
    bound(node->first);
    bound(node->second);
  }
  return second ? node->second : node->first;
}
