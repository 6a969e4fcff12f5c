#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "inputs.h"

void add_triangle(Mesh* mesh, Vector a, Vector b, Vector c) {
  if (mesh->triangles == mesh->room) {
    mesh->room = 2 * mesh->room + 16;
    Vector* corners = take(mesh->room, 3 * sizeof *corners);
    size_t* parts = take(mesh->room, sizeof *parts);
    if (mesh->triangles) {
      memcpy(corners, mesh->corners, mesh->triangles * 3 * sizeof *corners);
      memcpy(parts, mesh->parts, mesh->triangles * sizeof *parts);
    }
    mesh->corners = corners;
    mesh->parts = parts;
  }
  mesh->parts[mesh->triangles] = mesh->part;
  Vector* to = mesh->corners + 3 * mesh->triangles++;
  to[0] = a;
  to[1] = b;
  to[2] = c;
}

static Vector vector_of(const char* text, const char* path) {
  double numbers[3];
  read_numbers(text, numbers, 3, path);
  return (Vector){numbers[0], numbers[1], numbers[2]};
}

static void read_binary_stl(Mesh* mesh, File file) {
  for (size_t i = 0; i < (file.size - 84) / 50; ++i) {
    float numbers[9];
    for (int k = 0; k < 9; ++k) {
      uint32_t bits = (uint32_t)little_endian(file.data + 84 + 50 * i + 12 + 4 * k, 4);
      memcpy(numbers + k, &bits, sizeof bits);
    }
    const float* n = numbers;
    add_triangle(mesh, (Vector){n[0], n[1], n[2]}, (Vector){n[3], n[4], n[5]}, (Vector){n[6], n[7], n[8]});
  }
}

/* Cut a line off a text; the text goes to its end at last. */
static char* next_line(char** text) {
  char* line = *text;
  *text += strcspn(line, "\r\n");
  if (**text) *(*text)++ = 0;
  return line + strspn(line, " \t");
}

/* What follows a word at the beginning of a line, or NULL. */
static char* after(char* line, const char* word) {
  size_t size = strlen(word);
  return !strncmp(line, word, size) && strchr(" \t", line[size]) ? line + size : NULL;
}

static void read_ascii_stl(Mesh* mesh, char* text, const char* path) {
  Vector corners[3] = {{0, 0, 0}};
  size_t count = 0;
  while (*text) {
    char *line = next_line(&text), *numbers = after(line, "vertex");
    if (!numbers) {
      bool name = after(line, "solid") || after(line, "endsolid");
      if (!name && strstr(line, " vertex")) fail(BAD_INPUT, "%s: more than a corner in one line", path);
      continue;
    }
    corners[count++ % 3] = vector_of(numbers, path);
    if (count % 3 == 0) add_triangle(mesh, corners[0], corners[1], corners[2]);
  }
  if (count % 3) fail(BAD_INPUT, "%s: a triangle without three corners", path);
}

/* The corner that a face names: counted from 1, or from the last one backwards. */
static Vector corner_of(const char* text, char** end, const Mesh* vertices, const char* path) {
  long index = strtol(text, end, 10), count = (long)vertices->triangles;
  if (*end == text || index == 0 || index > count || index < -count)
    fail(BAD_INPUT, "%s: no corner: %.20s", path, text);
  *end += strcspn(*end, " \t");
  return vertices->corners[3 * (index > 0 ? index - 1 : count + index)];
}

static void read_obj(Mesh* mesh, char* text, const char* path) {
  Mesh vertices = {0}; /* each as a triangle, thrice */
  while (*text) {
    char *line = next_line(&text), *numbers = after(line, "v"), *face = after(line, "f");
    if (numbers) {
      char* end = numbers;
      for (int i = 0; i < 3; ++i) end += strspn(end, " \t"), end += strcspn(end, " \t");
      *end = 0; /* colours may follow */
      Vector vertex = vector_of(numbers, path);
      add_triangle(&vertices, vertex, vertex, vertex);
    }
    if (!face) continue;
    Vector first = corner_of(face, &face, &vertices, path), previous = corner_of(face, &face, &vertices, path);
    int corners = 2;
    for (face += strspn(face, " \t"); *face; face += strspn(face, " \t"), ++corners) {
      Vector corner = corner_of(face, &face, &vertices, path);
      add_triangle(mesh, first, previous, corner);
      previous = corner;
    }
    if (corners < 3) fail(BAD_INPUT, "%s: a face of two corners", path);
  }
}

static bool ends_with(const char* path, const char* suffix) {
  size_t size = strlen(path), width = strlen(suffix);
  if (size < width) return false;
  for (size_t i = 0; i < width; ++i) {
    if (tolower((unsigned char)path[size - width + i]) != suffix[i]) return false;
  }
  return true;
}

Mesh* read_mesh(File file, const char* path, const double scale[3]) {
  Mesh* mesh = take(1, sizeof *mesh);
  char* text = (char*)file.data;
  bool stl = ends_with(path, ".stl"), is_text = strlen(text) == file.size;
  if (stl && file.size > 84 && (file.size - 84) / 50 == little_endian(file.data + 80, 4) &&
      (file.size - 84) % 50 == 0) {
    read_binary_stl(mesh, file);
  } else if (stl && is_text) {
    read_ascii_stl(mesh, copied(text, file.size), path);
  } else if (ends_with(path, ".obj") && is_text) {
    read_obj(mesh, copied(text, file.size), path);
  } else if (ends_with(path, ".dae")) {
    read_collada(mesh, file, path);
  } else {
    fail(BAD_INPUT, "%s: no STL, OBJ or COLLADA file", path);
  }
  if (!mesh->triangles) fail(BAD_INPUT, "%s: no triangles", path);
  for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
    Vector* corner = mesh->corners + i;
    *corner = (Vector){scale[0] * corner->x, scale[1] * corner->y, scale[2] * corner->z};
    if (!(length(*corner) < 1e9)) fail(BAD_INPUT, "%s: a corner that is no number", path);
  }
  return mesh;
}

/* A corner of a triangle, or an edge between two numbered corners. */
typedef struct {
  Vector at;
  size_t triangle, corner, part, ends[2];
} Part;

static int by_place(const void* a, const void* b) {
  const Vector *p = a, *q = b; /* or parts, which begin with their places */
  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  if (p->y != q->y) return p->y < q->y ? -1 : 1;
  return (p->z > q->z) - (p->z < q->z);
}

void keep_distinct(Mesh* mesh) {
  qsort(mesh->corners, 3 * mesh->triangles, sizeof *mesh->corners, by_place);
  for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
    bool same = i && !by_place(mesh->corners + mesh->distinct - 1, mesh->corners + i);
    if (!same) mesh->corners[mesh->distinct++] = mesh->corners[i];
  }
}

static int by_part(const void* a, const void* b) {
  const Part *p = a, *q = b;
  return p->part != q->part ? (p->part < q->part ? -1 : 1) : by_place(a, b);
}

static int by_ends(const void* a, const void* b) {
  const size_t *p = ((const Part*)a)->ends, *q = ((const Part*)b)->ends;
  if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
  return (p[1] > q[1]) - (p[1] < q[1]);
}

static int by_corners(const void* a, const void* b) {
  const Part *p = a, *q = b;
  int order = by_ends(p, q);
  if (!order) order = (p->corner > q->corner) - (p->corner < q->corner);
  return order ? order : (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/* Leave triangles with the corners of an earlier one out of the pieces: two of them would hide what is inside. */
static void leave_out_equal(Mesh* mesh, const size_t* number) {
  Part* parts = take(mesh->triangles, sizeof *parts);
  for (size_t i = 0; i < mesh->triangles; ++i) {
    size_t a = number[3 * i], b = number[3 * i + 1], c = number[3 * i + 2];
    size_t low = a < b ? a : b, high = a < b ? b : a;
    if (c < low) low = c;
    if (c > high) high = c;
    parts[i] = (Part){.triangle = i, .corner = high, .ends = {low, a + b + c - low - high}};
  }
  qsort(parts, mesh->triangles, sizeof *parts, by_corners);
  for (size_t i = 1; i < mesh->triangles; ++i) {
    bool same = !by_ends(parts + i - 1, parts + i) && parts[i - 1].corner == parts[i].corner;
    if (same) mesh->piece[parts[i].triangle] = NONE;
  }
}

static size_t first_of(size_t* piece, size_t i) {
  while (piece[i] != i) i = piece[i] = piece[piece[i]];
  return i;
}

void find_pieces(Mesh* mesh) {
  if (mesh->piece) return;
  size_t count = 3 * mesh->triangles, edges = 0;
  Part* parts = take(count, sizeof *parts);
  size_t* number = take(count, sizeof *number);
  mesh->piece = take(mesh->triangles, sizeof *mesh->piece);
  mesh->closed = take(mesh->triangles, sizeof *mesh->closed);
  for (size_t i = 0; i < mesh->triangles; ++i) mesh->piece[i] = i;
  for (size_t i = 0; i < count; ++i) parts[i] = (Part){mesh->corners[i], i / 3, i, mesh->parts[i / 3], {0, 0}};
  qsort(parts, count, sizeof *parts, by_part);
  for (size_t i = 0; i < count; ++i) {
    bool same = i && !by_part(parts + i - 1, parts + i);
    number[parts[i].corner] = same ? number[parts[i - 1].corner] : i;
    if (!same) continue;
    size_t a = first_of(mesh->piece, parts[i - 1].triangle), b = first_of(mesh->piece, parts[i].triangle);
    mesh->piece[a < b ? b : a] = a < b ? a : b;
  }
  for (size_t i = 0; i < mesh->triangles; ++i) {
    mesh->piece[i] = first_of(mesh->piece, i);
    mesh->closed[i] = true;
  }
  leave_out_equal(mesh, number);
  for (size_t i = 0; i < count; ++i) {
    size_t a = number[i], b = number[i % 3 == 2 ? i - 2 : i + 1];
    if (mesh->piece[i / 3] == NONE) continue;
    parts[edges++] = (Part){.triangle = i / 3, .ends = {a < b ? a : b, a < b ? b : a}};
  }
  qsort(parts, edges, sizeof *parts, by_ends);
  for (size_t i = 0, next; i < edges; i = next) {
    for (next = i + 1; next < edges && !by_ends(parts + i, parts + next);) ++next;
    bool edge = parts[i].ends[0] != parts[i].ends[1];
    if (edge && (next - i) % 2) mesh->closed[mesh->piece[parts[i].triangle]] = false;
  }
}
