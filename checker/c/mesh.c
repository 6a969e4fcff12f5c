#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "inputs.h"

void add_triangle(Faces* faces, Vector a, Vector b, Vector c) {
  if (faces->count == faces->room) {
    Faces old = *faces;
    faces->room = 2 * old.room + 16;
    faces->corners = take(faces->room, 3 * sizeof *faces->corners);
    faces->parts = take(faces->room, sizeof *faces->parts);
    if (old.count) memcpy(faces->corners, old.corners, old.count * 3 * sizeof *old.corners);
    if (old.count) memcpy(faces->parts, old.parts, old.count * sizeof *old.parts);
  }
  faces->parts[faces->count] = faces->part;
  Vector* to = faces->corners + 3 * faces->count++;
  to[0] = a;
  to[1] = b;
  to[2] = c;
}

static Vector vector_of(const char* text, const char* path) {
  double numbers[3];
  read_numbers(text, numbers, 3, path);
  return (Vector){numbers[0], numbers[1], numbers[2]};
}

static void read_binary_stl(Faces* faces, File file) {
  for (size_t i = 0; i < (file.size - 84) / 50; ++i) {
    float numbers[9];
    for (int k = 0; k < 9; ++k) {
      uint32_t bits = (uint32_t)little_endian(file.data + 84 + 50 * i + 12 + 4 * k, 4);
      memcpy(numbers + k, &bits, sizeof bits);
    }
    const float* n = numbers;
    add_triangle(faces, (Vector){n[0], n[1], n[2]}, (Vector){n[3], n[4], n[5]}, (Vector){n[6], n[7], n[8]});
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

static void read_ascii_stl(Faces* faces, char* text, const char* path) {
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
    if (count % 3 == 0) add_triangle(faces, corners[0], corners[1], corners[2]);
  }
  if (count % 3) fail(BAD_INPUT, "%s: a triangle without three corners", path);
}

/* The corner that a face names: counted from 1, or from the last one backwards. */
static Vector corner_of(const char* text, char** end, const Faces* vertices, const char* path) {
  long index = strtol(text, end, 10), count = (long)vertices->count;
  if (*end == text || index == 0 || index > count || index < -count)
    fail(BAD_INPUT, "%s: no corner: %.20s", path, text);
  *end += strcspn(*end, " \t");
  return vertices->corners[3 * (index > 0 ? index - 1 : count + index)];
}

static void read_obj(Faces* faces, char* text, const char* path) {
  Faces vertices = {0}; /* each as a triangle, thrice */
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
      add_triangle(faces, first, previous, corner);
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

/* A corner of a triangle, by its first coordinate; the others are looked up where these are equal. */
typedef struct {
  double x;
  size_t corner;
} Place;

static const Faces* sorted_faces; /* what `by_place` looks up: qsort passes nothing else */

static int by_place(const void* a, const void* b) {
  const Place *p = a, *q = b;
  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  const Vector *v = sorted_faces->corners + p->corner, *w = sorted_faces->corners + q->corner;
  if (v->y != w->y) return v->y < w->y ? -1 : 1;
  if (v->z != w->z) return v->z < w->z ? -1 : 1;
  size_t part = sorted_faces->parts[p->corner / 3], other = sorted_faces->parts[q->corner / 3];
  return (part > other) - (part < other);
}

/* A number below `count`, a power of 2, that equal places have in common. */
static size_t bucket_of(Vector at, size_t count) {
  double numbers[3] = {at.x + 0.0, at.y + 0.0, at.z + 0.0}; /* of two zeros the one above */
  uint64_t mixed = 0;
  for (int i = 0; i < 3; ++i) {
    uint64_t bits = 0;
    memcpy(&bits, numbers + i, sizeof bits);
    mixed = (mixed ^ bits) * 0x9e3779b97f4a7c15;
    mixed ^= mixed >> 32;
  }
  return (size_t)mixed & (count - 1);
}

/* The corners in an order in which equal ones follow each other: those of a bucket are sorted, which is quick unless
   nearly all are in one. */
static Place* gathered(const Faces* faces) {
  size_t count = 3 * faces->count, buckets = 1;
  while (buckets < count) buckets *= 2;
  Place* places = take(count, sizeof *places);
  size_t *begin = take(buckets + 2, sizeof *begin), *bucket = take(count, sizeof *bucket);
  for (size_t i = 0; i < count; ++i) {
    bucket[i] = bucket_of(faces->corners[i], buckets);
    ++begin[bucket[i] + 2];
  }
  for (size_t i = 2; i <= buckets; ++i) begin[i] += begin[i - 1];
  for (size_t i = 0; i < count; ++i) places[begin[bucket[i] + 1]++] = (Place){faces->corners[i].x, i};
  sorted_faces = faces;
  for (size_t i = 0; i < buckets; ++i) {
    if (begin[i + 1] - begin[i] > 1) qsort(places + begin[i], begin[i + 1] - begin[i], sizeof *places, by_place);
  }
  return places;
}

/* Number the corners as they come: equal ones of a part are one point. */
static Mesh* numbered(const Faces* faces) {
  Mesh* mesh = take(1, sizeof *mesh);
  size_t count = 3 * faces->count;
  const Place* places = gathered(faces);
  size_t *equal = take(count, sizeof *equal), *number = take(count, sizeof *number);
  mesh->triangle_count = faces->count;
  mesh->triangles = take(faces->count, sizeof *mesh->triangles);
  mesh->points = take(count, sizeof *mesh->points);
  for (size_t i = 0; i < count; ++i) {
    bool same = i && !by_place(places + i - 1, places + i);
    equal[places[i].corner] = same ? equal[places[i - 1].corner] : places[i].corner;
  }
  for (size_t i = 0; i < count; ++i) {
    size_t* own = number + equal[i];
    if (!*own) {
      mesh->points[mesh->point_count] = faces->corners[i];
      *own = ++mesh->point_count;
    }
    mesh->triangles[i / 3].corner[i % 3] = *own - 1;
  }
  return mesh;
}

Mesh* read_mesh(File file, const char* path, const double scale[3], bool convex) {
  Faces faces = {0};
  char* text = (char*)file.data;
  bool stl = ends_with(path, ".stl"), is_text = strlen(text) == file.size;
  if (stl && file.size > 84 && (file.size - 84) / 50 == little_endian(file.data + 80, 4) &&
      (file.size - 84) % 50 == 0) {
    read_binary_stl(&faces, file);
  } else if (stl && is_text) {
    read_ascii_stl(&faces, copied(text, file.size), path);
  } else if (ends_with(path, ".obj") && is_text) {
    read_obj(&faces, copied(text, file.size), path);
  } else if (ends_with(path, ".dae")) {
    read_collada(&faces, file, path);
  } else {
    fail(BAD_INPUT, "%s: no STL, OBJ or COLLADA file", path);
  }
  if (!faces.count) fail(BAD_INPUT, "%s: no triangles", path);
  for (size_t i = 0; i < 3 * faces.count; ++i) {
    Vector* corner = faces.corners + i;
    *corner = (Vector){scale[0] * corner->x, scale[1] * corner->y, scale[2] * corner->z};
    if (!(length(*corner) < 1e9)) fail(BAD_INPUT, "%s: a corner that is no number", path);
    if (convex) faces.parts[i / 3] = 0;
  }
  return numbered(&faces);
}
