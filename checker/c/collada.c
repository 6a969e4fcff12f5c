#include <stdlib.h>
#include <string.h>

#include "inputs.h"

enum { DEEPEST = 50, MOST_READINGS = 20 };

/* A file whose parts may be named several times; `left` bounds by its size what is read of it in all. */
typedef struct {
  const Entry* root;
  const char* path;
  Faces* faces;
  size_t* left;
} Reader;

static void spend(const Reader* in, size_t work) {
  if (work > *in->left) fail(BAD_INPUT, "%s: parts that are named too often", in->path);
  *in->left -= work;
}

/* The element of this id in all libraries of a kind: `instance` names it as "#id". */
static const Entry* found(const Reader* in, const char* library, const char* tag, const char* id) {
  if (id && id[0] == '#') {
    for (const Entry* each = in->root->child; each; each = each->next) {
      if (strcmp(each->key, library) != 0) continue;
      for (const Entry* one = each->child; one; one = one->next) {
        if (!strcmp(one->key, tag) && !strcmp(text_of(one, "@id", ""), id + 1)) return one;
      }
    }
  }
  fail(BAD_INPUT, "%s: there is no %s %s", in->path, tag, id ? id : "");
}

static size_t whole_number(const char* text, size_t most, const Reader* in) {
  char* end = NULL;
  unsigned long number = strtoul(text, &end, 10);
  if (end == text || *text == '-' || number > most || *(end += strspn(end, " \t\r\n"))) {
    fail(BAD_INPUT, "%s: no number up to %zu: %.20s", in->path, most, text);
  }
  return number;
}

/* Whole numbers of a text, at most one for each second letter. */
static size_t* whole_numbers(const char* text, size_t* count, const Reader* in) {
  spend(in, strlen(text));
  size_t* numbers = take(strlen(text) / 2 + 1, sizeof *numbers);
  char* end = NULL;
  for (*count = 0;; text = end) {
    unsigned long number = strtoul(text, &end, 10);
    if (end == text) return numbers;
    numbers[(*count)++] = number;
  }
}

static double* decimals(const char* text, size_t* count, const Reader* in) {
  spend(in, strlen(text));
  double* numbers = take(strlen(text) / 2 + 1, sizeof *numbers);
  char* end = NULL;
  for (*count = 0;; text = end) {
    double number = strtod(text, &end);
    if (end == text) break;
    if (!isfinite(number)) fail(BAD_INPUT, "%s: a number that is not finite", in->path);
    numbers[(*count)++] = number;
  }
  if (text[strspn(text, " \t\r\n")]) fail(BAD_INPUT, "%s: no number: %.20s", in->path, text);
  return numbers;
}

static const Entry* input_of(const Entry* owner, const char* semantic) {
  for (const Entry* each = owner->child; each; each = each->next) {
    if (!strcmp(each->key, "input") && !strcmp(text_of(each, "@semantic", ""), semantic)) return each;
  }
  return NULL;
}

static const Entry* with_id(const Entry* mesh, const char* tag, const char* id, const Reader* in) {
  for (const Entry* each = mesh->child; each && id && id[0] == '#'; each = each->next) {
    if (!strcmp(each->key, tag) && !strcmp(text_of(each, "@id", ""), id + 1)) return each;
  }
  fail(BAD_INPUT, "%s: there is no %s %s", in->path, tag, id ? id : "");
}

/* Corners of a polygon that `numbers` name, each `stride` numbers apart. */
typedef struct {
  const double* places;
  size_t count, stride;
  const Pose* pose;
} Corners;

static Vector corner(const Reader* in, const Corners* of, size_t number) {
  if (number >= of->count / 3) fail(BAD_INPUT, "%s: there is no corner %zu", in->path, number);
  const double* place = of->places + 3 * number;
  return placed(of->pose, (Vector){place[0], place[1], place[2]});
}

static void add_polygon(const Reader* in, const Corners* of, const size_t* numbers, size_t corners) {
  for (size_t i = 2; i < corners; ++i) {
    add_triangle(in->faces, corner(in, of, numbers[0]), corner(in, of, numbers[(i - 1) * of->stride]),
                 corner(in, of, numbers[i * of->stride]));
  }
}

/* Triangles, a list of polygons with their counts, or polygons of their own. */
static void add_primitive(const Reader* in, const Entry* mesh, const Entry* primitive, const Pose* pose) {
  const Entry* input = input_of(primitive, "VERTEX");
  if (!input) fail(BAD_INPUT, "%s: <%s> without corners", in->path, primitive->key);
  const Entry* vertices = with_id(mesh, "vertices", text_of(input, "@source", NULL), in);
  const Entry* positions = input_of(vertices, "POSITION");
  if (!positions) fail(BAD_INPUT, "%s: vertices without positions", in->path);
  const Entry* source = with_id(mesh, "source", text_of(positions, "@source", NULL), in);
  const Entry* accessor = child_of(child_of(source, "technique_common"), "accessor");
  if (accessor && strcmp(text_of(accessor, "@stride", "3"), "3") != 0) fail(BAD_INPUT, "%s: a stride", in->path);
  Corners of = {.stride = 1, .pose = pose};
  of.places = decimals(text_of(source, "float_array", ""), &of.count, in);
  for (const Entry* each = primitive->child; each; each = each->next) {
    if (strcmp(each->key, "input") != 0) continue;
    size_t offset = whole_number(text_of(each, "@offset", "0"), 100, in);
    if (offset >= of.stride) of.stride = offset + 1;
  }
  size_t first = whole_number(text_of(input, "@offset", "0"), 100, in);
  bool polylist = !strcmp(primitive->key, "polylist"), polygons = !strcmp(primitive->key, "polygons");
  size_t lengths = 0, *length = polylist ? whole_numbers(text_of(primitive, "vcount", ""), &lengths, in) : NULL;
  for (const Entry* each = primitive->child; each; each = each->next) {
    if (!strcmp(each->key, "ph")) fail(BAD_INPUT, "%s: polygons with holes", in->path);
    if (strcmp(each->key, "p") != 0) continue;
    size_t count = 0, *numbers = whole_numbers(each->text, &count, in), at = 0, left = count / of.stride;
    for (size_t i = 0; left; ++i) {
      size_t corners = polygons ? left : !polylist ? 3 : i < lengths ? length[i] : 0;
      if (corners == 0 || corners > left) fail(BAD_INPUT, "%s: <%s> of other counts", in->path, primitive->key);
      add_polygon(in, &of, numbers + at * of.stride + first, corners);
      at += corners;
      left -= corners;
    }
  }
}

static void add_geometry(const Reader* in, const Entry* geometry, const Pose* pose) {
  const Entry* mesh = child_of(geometry, "mesh");
  if (!mesh) fail(BAD_INPUT, "%s: a geometry that is no mesh", in->path);
  ++in->faces->part; /* a closed surface may be of several primitives, one for each material */
  for (const Entry* each = mesh->child; each; each = each->next) {
    if (!strcmp(each->key, "triangles") || !strcmp(each->key, "polylist") || !strcmp(each->key, "polygons")) {
      add_primitive(in, mesh, each, pose);
    } else if (!strcmp(each->key, "tristrips") || !strcmp(each->key, "trifans")) {
      fail(BAD_INPUT, "%s: <%s> is not read", in->path, each->key);
    }
  }
}

/* The step that a child of a node makes: a matrix need not keep lengths. */
static Pose step_of(const Reader* in, const Entry* child) {
  double n[16];
  Pose step = identity();
  if (!strcmp(child->key, "matrix")) {
    read_numbers(child->text, n, 16, in->path);
    step = (Pose){{n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]}, {n[3], n[7], n[11]}};
  } else if (!strcmp(child->key, "translate")) {
    read_numbers(child->text, n, 3, in->path);
    step.at = (Vector){n[0], n[1], n[2]};
  } else if (!strcmp(child->key, "scale")) {
    read_numbers(child->text, n, 3, in->path);
    step = (Pose){{n[0], 0, 0}, {0, n[1], 0}, {0, 0, n[2]}, {0, 0, 0}};
  } else if (!strcmp(child->key, "rotate")) {
    read_numbers(child->text, n, 4, in->path);
    Vector axis = {n[0], n[1], n[2]};
    if (!(length(axis) > 0)) fail(BAD_INPUT, "%s: a turn about nothing", in->path);
    step = pose_of_turn(scaled(1 / length(axis), axis), n[3] * PI / 180);
  } else if (!strcmp(child->key, "lookat") || !strcmp(child->key, "skew")) {
    fail(BAD_INPUT, "%s: <%s> is not read", in->path, child->key);
  }
  return step;
}

static void add_node(const Reader* in, const Entry* node, const Pose* outer, int depth) {
  if (depth > DEEPEST) fail(BAD_INPUT, "%s: nodes too deep", in->path);
  spend(in, 8);
  Pose pose = *outer;
  for (const Entry* each = node->child; each; each = each->next) {
    Pose step = step_of(in, each);
    pose = composed(&pose, &step);
  }
  for (const Entry* each = node->child; each; each = each->next) {
    const char* url = text_of(each, "@url", NULL);
    if (!strcmp(each->key, "node")) {
      add_node(in, each, &pose, depth + 1);
    } else if (!strcmp(each->key, "instance_node")) {
      add_node(in, found(in, "library_nodes", "node", url), &pose, depth + 1);
    } else if (!strcmp(each->key, "instance_geometry")) {
      add_geometry(in, found(in, "library_geometries", "geometry", url), &pose);
    } else if (!strcmp(each->key, "instance_controller")) {
      fail(BAD_INPUT, "%s: a skin is not read", in->path);
    }
  }
}

void read_collada(Faces* faces, File file, const char* path) {
  size_t left = MOST_READINGS * file.size;
  Reader in = {parse_xml((const char*)file.data, file.size, path), path, faces, &left};
  double metre = 1;
  const char* unit = text_of(child_of(child_of(in.root, "asset"), "unit"), "@meter", "1");
  read_numbers(unit, &metre, 1, path);
  if (!(metre > 0)) fail(BAD_INPUT, "%s: a unit of %s m", path, unit);
  const char* url = text_of(child_of(child_of(in.root, "scene"), "instance_visual_scene"), "@url", NULL);
  const Entry* scene = found(&in, "library_visual_scenes", "visual_scene", url);
  Pose scale = {{metre, 0, 0}, {0, metre, 0}, {0, 0, metre}, {0, 0, 0}};
  add_node(&in, scene, &scale, 0);
}
