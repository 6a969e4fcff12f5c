/* The connected pieces of a mesh, and which of them are closed. */
#include <string.h>

#include "inputs.h"

/* The numbers of the corners of a triangle, or of an edge, the lowest first. */
typedef struct {
  uint32_t number[3], triangle;
} Key;

static bool are_equal(const Key* a, const Key* b) {
  return a->number[0] == b->number[0] && a->number[1] == b->number[1] && a->number[2] == b->number[2];
}

/* Sort keys of so many numbers below `points`: by the last number first, each time in the order that they have. */
static Key* sorted(Key* keys, size_t count, int numbers, size_t points) {
  Key* to = take(count + 1, sizeof *to);
  size_t* begin = take(points + 1, sizeof *begin);
  for (int k = numbers; k--;) {
    memset(begin, 0, (points + 1) * sizeof *begin);
    for (size_t i = 0; i < count; ++i) ++begin[keys[i].number[k] + 1];
    for (size_t i = 0; i < points; ++i) begin[i + 1] += begin[i];
    for (size_t i = 0; i < count; ++i) to[begin[keys[i].number[k]]++] = keys[i];
    Key* swapped = keys;
    keys = to;
    to = swapped;
  }
  return keys;
}

static Key key_of(const Triangle* of, size_t triangle) {
  uint32_t a = (uint32_t)of->corner[0], b = (uint32_t)of->corner[1], c = (uint32_t)of->corner[2], swapped;
  if (a > b) swapped = a, a = b, b = swapped;
  if (b > c) swapped = b, b = c, c = swapped;
  if (a > b) swapped = a, a = b, b = swapped;
  return (Key){{a, b, c}, (uint32_t)triangle};
}

/* Tell which triangles have the corners of an earlier one: two of them would hide what is inside. */
static bool* repeated(const Mesh* mesh) {
  size_t count = mesh->triangle_count;
  Key* keys = take(count, sizeof *keys);
  bool* again = take(count, sizeof *again);
  for (size_t i = 0; i < count; ++i) keys[i] = key_of(mesh->triangles + i, i);
  keys = sorted(keys, count, 3, mesh->point_count);
  for (size_t i = 1; i < count; ++i) again[keys[i].triangle] = are_equal(keys + i - 1, keys + i);
  return again;
}

static size_t first_of(size_t* group, size_t i) {
  while (group[i] != i) i = group[i] = group[group[i]];
  return i;
}

static void join(size_t* group, size_t a, size_t b) { group[first_of(group, a)] = first_of(group, b); }

/* Note which pieces have an edge that belongs to an odd number of triangles. */
static void find_holes(Mesh* mesh, const bool* again, const size_t* piece_of) {
  Key* keys = take(3 * mesh->triangle_count, sizeof *keys);
  size_t count = 0;
  for (size_t i = 0; i < 3 * mesh->triangle_count; ++i) {
    const size_t* corner = mesh->triangles[i / 3].corner;
    uint32_t a = (uint32_t)corner[i % 3], b = (uint32_t)corner[(i + 1) % 3];
    if (a != b && !again[i / 3]) keys[count++] = (Key){{a < b ? a : b, a < b ? b : a, 0}, (uint32_t)(i / 3)};
  }
  keys = sorted(keys, count, 2, mesh->point_count);
  for (size_t i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && are_equal(keys + i, keys + next);) ++next;
    if ((next - i) % 2) mesh->pieces[piece_of[keys[i].triangle]].closed = false;
  }
}

void find_pieces(Mesh* mesh) {
  if (mesh->pieces) return;
  size_t count = mesh->triangle_count, *group = take(mesh->point_count, sizeof *group);
  size_t *number = take(mesh->point_count, sizeof *number), *piece_of = take(count, sizeof *piece_of);
  const bool* again = repeated(mesh);
  for (size_t i = 0; i < mesh->point_count; ++i) group[i] = i;
  for (size_t i = 0; i < count; ++i) {
    for (int k = 1; k < 3; ++k) join(group, mesh->triangles[i].corner[0], mesh->triangles[i].corner[k]);
  }
  mesh->pieces = take(count, sizeof *mesh->pieces);
  mesh->members = take(count, sizeof *mesh->members);
  for (size_t i = 0; i < count; ++i) {
    size_t* own = number + first_of(group, mesh->triangles[i].corner[0]);
    if (!*own) {
      *own = ++mesh->piece_count;
      mesh->pieces[*own - 1].closed = true;
    }
    piece_of[i] = *own - 1;
    mesh->pieces[*own - 1].count += !again[i];
  }
  for (size_t i = 1; i < mesh->piece_count; ++i) {
    mesh->pieces[i].begin = mesh->pieces[i - 1].begin + mesh->pieces[i - 1].count;
  }
  size_t* filled = take(mesh->piece_count, sizeof *filled);
  for (size_t i = 0; i < count; ++i) {
    size_t own = piece_of[i];
    if (!again[i]) mesh->members[mesh->pieces[own].begin + filled[own]++] = i;
  }
  find_holes(mesh, again, piece_of);
}
