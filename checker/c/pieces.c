/* The connected pieces of a mesh, and which of them are closed. */
#include <stdlib.h>

#include "inputs.h"

/* The numbers of the corners of a triangle, or of an edge and 0, the lowest first; and which triangle it is. */
typedef struct {
  size_t number[3], triangle;
} Key;

static int by_numbers(const void* a, const void* b) {
  const Key *p = a, *q = b;
  for (int i = 0; i < 3; ++i) {
    if (p->number[i] != q->number[i]) return p->number[i] < q->number[i] ? -1 : 1;
  }
  return 0;
}

static int by_numbers_and_triangle(const void* a, const void* b) {
  int order = by_numbers(a, b);
  return order ? order : by_number(&((const Key*)a)->triangle, &((const Key*)b)->triangle);
}

static Key key_of(const Triangle* of, size_t triangle) {
  Key key = {{of->corner[0], of->corner[1], of->corner[2]}, triangle};
  qsort(key.number, 3, sizeof *key.number, by_number);
  return key;
}

/* Leave out triangles of a piece that have the corners of an earlier one: two of them would hide what is inside. */
static void leave_out_repeated(const Mesh* mesh, Piece* piece) {
  size_t *members = mesh->members + piece->begin, count = 0;
  Key* keys = take(piece->count, sizeof *keys);
  for (size_t i = 0; i < piece->count; ++i) keys[i] = key_of(mesh->triangles + members[i], members[i]);
  qsort(keys, piece->count, sizeof *keys, by_numbers_and_triangle);
  for (size_t i = 0; i < piece->count; ++i) {
    if (!i || by_numbers(keys + i - 1, keys + i)) members[count++] = keys[i].triangle;
  }
  piece->count = count;
  qsort(members, count, sizeof *members, by_number);
}

/* Tell whether each edge of a piece belongs to an even number of triangles. */
static bool has_no_holes(const Mesh* mesh, const Piece* piece) {
  Key* keys = take(3 * piece->count, sizeof *keys);
  size_t count = 0;
  for (size_t i = 0; i < 3 * piece->count; ++i) {
    const size_t* corner = mesh->triangles[mesh->members[piece->begin + i / 3]].corner;
    size_t a = corner[i % 3], b = corner[(i + 1) % 3];
    if (a != b) keys[count++] = (Key){{a < b ? a : b, a < b ? b : a, 0}, 0};
  }
  qsort(keys, count, sizeof *keys, by_numbers);
  for (size_t i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && !by_numbers(keys + i, keys + next);) ++next;
    if ((next - i) % 2) return false;
  }
  return true;
}

bool is_closed(const Mesh* mesh, Piece* piece) {
  if (!piece->looked_at) {
    leave_out_repeated(mesh, piece);
    piece->closed = has_no_holes(mesh, piece);
    piece->looked_at = true;
  }
  return piece->closed;
}

void find_pieces(Mesh* mesh) {
  if (mesh->pieces) return;
  size_t count = mesh->triangle_count, *group = take(mesh->point_count, sizeof *group);
  size_t *number = take(mesh->point_count, sizeof *number), *piece_of = take(count, sizeof *piece_of);
  for (size_t i = 0; i < mesh->point_count; ++i) group[i] = i;
  for (size_t i = 0; i < 2 * count; ++i) {
    const size_t* corner = mesh->triangles[i / 2].corner + i % 2;
    group[first_of(group, corner[0])] = first_of(group, corner[1]);
  }
  mesh->pieces = take(count, sizeof *mesh->pieces);
  mesh->members = take(count, sizeof *mesh->members);
  for (size_t i = 0; i < count; ++i) {
    size_t* own = number + first_of(group, mesh->triangles[i].corner[0]);
    if (!*own) *own = ++mesh->piece_count;
    piece_of[i] = *own - 1;
    ++mesh->pieces[piece_of[i]].count;
  }
  size_t* filled = take(mesh->piece_count, sizeof *filled);
  for (size_t i = 1; i < mesh->piece_count; ++i) {
    mesh->pieces[i].begin = mesh->pieces[i - 1].begin + mesh->pieces[i - 1].count;
  }
  for (size_t i = 0; i < count; ++i) mesh->members[mesh->pieces[piece_of[i]].begin + filled[piece_of[i]]++] = i;
}
