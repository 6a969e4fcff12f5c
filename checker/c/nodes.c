#include "nodes.h"

#include <stdlib.h>
#include <string.h>

static const double WIDEST = 1000, FLAT = 1e-9, UNITS_OF_A_METRE = 1048576;

bool is_surface(const Solid* solid) { return solid->shape->kind == MESH && !solid->shape->convex; }

static size_t corners_of(const Solid* solid) {
  return is_surface(solid) ? 3 : solid->shape->kind == CLOUD ? 1 : solid->point_count;
}

Vector corner_at(const Solid* solid, size_t element, size_t corner) {
  if (is_surface(solid)) return solid->points[solid->shape->mesh->triangles[element].corner[corner]];
  return solid->points[solid->shape->kind == CLOUD ? element : corner];
}

/* A box, or the box below a plane, whose upper face is around the root's foot. */
static void add_box(Solid* solid, const double size[3], const Pose* pose) {
  solid->points = take(8, sizeof *solid->points);
  for (int i = 0; i < 8; ++i) {
    Vector corner = {(i & 1 ? size[0] : -size[0]) / 2, (i & 2 ? size[1] : -size[1]) / 2,
                     (i & 4 ? size[2] : -size[2]) / 2};
    solid->points[i] = placed(pose, corner);
  }
  solid->point_count = 8;
}

Solid solid_of(const Shape* shape, const Pose* pose) {
  Solid solid = {.shape = shape, .ball = shape->clearance, .elements = 1, .axis = pose->z};
  const double *size = shape->size, plane[3] = {2 * GROUND, 2 * GROUND, GROUND};
  if (shape->kind == MESH || shape->kind == CLOUD) {
    solid.point_count = shape->mesh->point_count;
    solid.points = take(solid.point_count, sizeof *solid.points);
    for (size_t i = 0; i < solid.point_count; ++i) solid.points[i] = placed(pose, shape->mesh->points[i]);
    if (shape->kind == CLOUD) solid.ball += size[0], solid.elements = solid.point_count;
    if (is_surface(&solid)) solid.elements = shape->mesh->triangle_count;
  } else if (shape->kind == BOX) {
    add_box(&solid, size, pose);
  } else if (shape->kind == PLANE) {
    Pose below = *pose;
    below.at = scaled(dot(pose->z, pose->at) - GROUND / 2, pose->z);
    add_box(&solid, plane, &below);
  } else {
    solid.points = take(2, sizeof *solid.points);
    solid.point_count = shape->kind == SPHERE ? 1 : 2;
    for (int i = 0; i < 2; ++i) {
      Vector end = {0, 0, shape->kind == SPHERE ? 0 : i ? size[1] / 2 : -size[1] / 2};
      solid.points[i] = placed(pose, end);
    }
    if (shape->kind == CYLINDER) solid.disc = size[0];
    if (shape->kind != CYLINDER) solid.ball += size[0];
  }
  for (size_t i = 0; i < solid.point_count; ++i) {
    const Vector* point = solid.points + i;
    if (!(fmax(fabs(point->x), fmax(fabs(point->y), fabs(point->z))) < WIDEST)) {
      fail(BAD_INPUT, "a shape reaches beyond %g m", WIDEST);
    }
  }
  return solid;
}

double reach_of(const Solid* solid) {
  double square = 0;
  for (size_t i = 0; i < solid->point_count; ++i) square = fmax(square, dot(solid->points[i], solid->points[i]));
  return sqrt(square) + solid->ball + solid->disc;
}

static Range nothing(void) { return (Range){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}; }

void widen(Range* range, Vector at) {
  if (at.x < range->low.x) range->low.x = at.x;
  if (at.y < range->low.y) range->low.y = at.y;
  if (at.z < range->low.z) range->low.z = at.z;
  if (at.x > range->high.x) range->high.x = at.x;
  if (at.y > range->high.y) range->high.y = at.y;
  if (at.z > range->high.z) range->high.z = at.z;
}

static double beside(double along) { return sqrt(fmax(0, 1 - along * along)); }

/* Widen the box and reach of a node by a range of corners of a solid, and by what is about them. */
static void include(Range* box, const Solid* solid, const Range* range) {
  Vector wide = {solid->ball, solid->ball, solid->ball}, axis = solid->axis;
  if (solid->disc > 0) {
    wide = sum(wide, scaled(solid->disc, (Vector){beside(axis.x), beside(axis.y), beside(axis.z)}));
  }
  widen(box, difference(range->low, wide));
  widen(box, sum(range->high, wide));
}

/* Set the box of a node: of a single box it is that one, longer by its ball. */
static void set_box(Node* node, const Range* box, const Solid* only) {
  Vector half = scaled(0.5, difference(box->high, box->low));
  node->centre = scaled(0.5, sum(box->low, box->high));
  node->half[0] = (Vector){half.x, 0, 0};
  node->half[1] = (Vector){0, half.y, 0};
  node->half[2] = (Vector){0, 0, half.z};
  if (node->count > 1 || (only->shape->kind != BOX && only->shape->kind != PLANE)) return;
  const Vector* corners = only->points;
  Vector edges[3];
  double shortest = INFINITY;
  for (int i = 0; i < 3; ++i) {
    edges[i] = scaled(0.5, difference(corners[1 << i], corners[0]));
    shortest = fmin(shortest, length(edges[i]));
  }
  if (only->ball > 0 && !(shortest > FLAT)) return;
  node->centre = scaled(0.5, sum(corners[0], corners[7]));
  for (int i = 0; i < 3; ++i) {
    node->half[i] = scaled(1 + (only->ball > 0 ? only->ball / length(edges[i]) : 0), edges[i]);
  }
}

Node* node_of(Solid** solids, size_t count, size_t frame) {
  Node* node = take(1, sizeof *node);
  Range box = nothing();
  *node = (Node){.solids = solids, .solid_count = count, .frame = frame};
  node->corners = take(count + 1, sizeof *node->corners);
  for (size_t i = 0; i < count; ++i) {
    Range range = nothing();
    for (size_t k = 0; k < solids[i]->point_count; ++k) widen(&range, solids[i]->points[k]);
    include(&box, solids[i], &range);
    node->reach = fmax(node->reach, reach_of(solids[i]));
    node->count += solids[i]->elements;
    node->corners[node->corner_count++] = (Corners){solids[i], solids[i]->points, solids[i]->point_count};
  }
  set_box(node, &box, solids[0]);
  return node;
}

static Element element_of(Solid* solid, size_t number) {
  Element element = {.solid = solid, .number = number, .range = nothing()};
  size_t count = corners_of(solid);
  double square = 0;
  Vector all = {0, 0, 0};
  for (size_t i = 0; i < count; ++i) {
    Vector corner = corner_at(solid, number, i);
    all = sum(all, corner);
    widen(&element.range, corner);
    square = fmax(square, dot(corner, corner));
  }
  element.mean =
      (Vector){rint(all.x / (double)count * UNITS_OF_A_METRE), rint(all.y / (double)count * UNITS_OF_A_METRE),
               rint(all.z / (double)count * UNITS_OF_A_METRE)};
  element.reach = sqrt(square) + solid->ball + solid->disc;
  return element;
}

/* List the elements of a whole node. */
static void find_elements(Node* node) {
  size_t count = 0;
  node->elements = take(node->count, sizeof *node->elements);
  node->members = take(node->count, sizeof *node->members);
  for (size_t i = 0; i < node->solid_count; ++i) {
    for (size_t k = 0; k < node->solids[i]->elements; ++k, ++count) {
      node->elements[count] = element_of(node->solids[i], k);
      node->members[count] = count;
    }
  }
}

/* A part of a node. */
static Node* part_of(const Node* node, size_t* members, size_t count) {
  Node* part = take(1, sizeof *part);
  Range box = nothing();
  *part = (Node){node->solids, node->solid_count, node->frame, count, node->elements, members, .reach = 0};
  for (size_t i = 0; i < count; ++i) {
    const Element* element = node->elements + members[i];
    include(&box, element->solid, &element->range);
    part->reach = fmax(part->reach, element->reach);
  }
  set_box(part, &box, node->elements[members[0]].solid);
  return part;
}

static int by_size(const void* a, const void* b) {
  const double *p = a, *q = b;
  return (*p > *q) - (*p < *q);
}

/* The number that would be at a place if all were sorted, by parts about a pivot or, where these do not shrink, sorted;
   they are moved about. */
static double selected(double* numbers, size_t count, size_t place) {
  size_t from = 0, to = count;
  for (int tries = 0; to - from > 1; ++tries) {
    if (tries > 60) {
      qsort(numbers + from, to - from, sizeof *numbers, by_size);
      break;
    }
    double pivot = numbers[from + (to - from) / 2];
    size_t low = from, high = to - 1;
    for (;; ++low, --high) {
      while (numbers[low] < pivot) ++low;
      while (pivot < numbers[high]) --high;
      if (low >= high) break;
      double swapped = numbers[low];
      numbers[low] = numbers[high];
      numbers[high] = swapped;
    }
    if (low > place) {
      to = low;
    } else {
      from = low;
    }
  }
  return numbers[place];
}

static double coordinate(Vector a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

static int longest_axis(const Node* node) {
  Range range = nothing();
  for (size_t i = 0; i < node->count; ++i) widen(&range, node->elements[node->members[i]].mean);
  Vector size = difference(range.high, range.low);
  int axis = size.y > size.x;
  return size.z > coordinate(size, axis) ? 2 : axis;
}

/* Halve a node by the means of its elements: those below the middle one, and the first ones that are equal to it. */
static void halve(Node* node) {
  if (!node->elements) find_elements(node);
  size_t middle = node->count / 2, equal = middle, counts[2] = {0, 0};
  int axis = longest_axis(node);
  double* keys = take(node->count, sizeof *keys);
  for (size_t i = 0; i < node->count; ++i) keys[i] = coordinate(node->elements[node->members[i]].mean, axis);
  double between = selected(keys, node->count, middle - 1);
  for (size_t i = 0; i < node->count; ++i) equal -= coordinate(node->elements[node->members[i]].mean, axis) < between;
  size_t* halves[2] = {take(middle, sizeof **halves), take(node->count - middle, sizeof **halves)};
  for (size_t i = 0; i < node->count; ++i) {
    double key = coordinate(node->elements[node->members[i]].mean, axis);
    bool second = key > between || (key == between && !equal);
    if (key == between && equal) --equal;
    halves[second][counts[second]++] = node->members[i];
  }
  node->first = part_of(node, halves[0], middle);
  node->second = part_of(node, halves[1], node->count - middle);
}

Node* half_of(Node* node, bool second) {
  if (node->count < 2) return NULL;
  if (!node->first) halve(node);
  return second ? node->second : node->first;
}

/* Gather the corners of a part, each of a solid once: its elements follow each other. */
static void find_corners(Node* node) {
  static size_t gathered; /* nodes, each with a number of its own */
  size_t solids = 0, all = 0;
  ++gathered;
  for (size_t i = 0; i < node->count; ++i) {
    const Solid* solid = node->elements[node->members[i]].solid;
    solids += !i || solid != node->elements[node->members[i - 1]].solid;
    all += corners_of(solid);
  }
  Vector* points = take(all, sizeof *points);
  Corners* corners = node->corners = take(solids, sizeof *corners);
  size_t count = 0;
  for (size_t i = 0; i < node->count; ++i) {
    const Element* element = node->elements + node->members[i];
    Solid* solid = element->solid;
    if (!i || solid != node->elements[node->members[i - 1]].solid) {
      corners = node->corners + node->corner_count++;
      *corners = (Corners){solid, points + count, 0};
    }
    if (!is_surface(solid)) {
      for (size_t k = 0; k < corners_of(solid); ++k) points[count++] = corner_at(solid, element->number, k);
    } else {
      if (!solid->seen) solid->seen = take(solid->point_count, sizeof *solid->seen);
      for (size_t k = 0; k < 3; ++k) {
        size_t number = solid->shape->mesh->triangles[element->number].corner[k];
        if (solid->seen[number] != gathered) points[count++] = solid->points[number];
        solid->seen[number] = gathered;
      }
    }
    corners->count = count - (size_t)(corners->points - points);
  }
}

/* How far what is about each corner of a solid reaches along a direction: the axis of a disc is of length 1. */
static double about(const Solid* solid, Vector direction) {
  double reach = solid->ball > 0 ? solid->ball * length(direction) : 0;
  if (solid->disc <= 0) return reach;
  return reach + solid->disc * length(difference(direction, scaled(dot(direction, solid->axis), solid->axis)));
}

void find_supports(Node* node, const Vector directions[2], bool by_box, double supports[2]) {
  Vector a = directions[0], b = directions[1];
  if (by_box) {
    for (int k = 0; k < 2; ++k) {
      supports[k] = dot(directions[k], node->centre);
      for (int i = 0; i < 3; ++i) supports[k] += fabs(dot(directions[k], node->half[i]));
    }
    return;
  }
  if (!node->corners) find_corners(node);
  supports[0] = supports[1] = -INFINITY;
  for (size_t i = 0; i < node->corner_count; ++i) {
    const Corners* corners = node->corners + i;
    double first = -INFINITY, second = -INFINITY;
    for (size_t k = 0; k < corners->count; ++k) {
      double along = dot(a, corners->points[k]), other = dot(b, corners->points[k]);
      if (along > first) first = along;
      if (other > second) second = other;
    }
    supports[0] = fmax(supports[0], first + about(corners->solid, a));
    supports[1] = fmax(supports[1], second + about(corners->solid, b));
  }
}
